"""The clairvoyant optimum: its slopes beside differences of whole runs, its simulation beside the
bench, what a search keeps to, and the command."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.compare.clairvoyant import clairvoyant, replayed
from quiesce.compare.figures import figures_of
from quiesce.compare.goal import read_goal
from quiesce.compare.laws import ComparedLaw, constant, read_law
from quiesce.compare.records import Record
from quiesce.compare.roads import road
from quiesce.compare.run import Case, Cell, Comparison, Shaking, beside
from quiesce.compare.smooth import SMOOTH, slopes_of
from quiesce.engine.bench import Bench
from quiesce.optimum.waveform import Effort, best_waveform
from quiesce.plant.open_loop import BaseMotion, Motion, OpenLoop

DATA = ROOT / "sim_hil/data"
SHORT = Effort(hold_ticks=10, tried=1, first_runs=3, stages=((16.0, 4),))
# Structures with hysteresis, a contact and a lever, two dampers.
RIGS = ("three_storeys_1996", "quarter_car", "two_storeys")


def quake(lasts_s: float = 1.5, peak_m_s2: float = 3.0) -> Record:
    t = np.arange(0, lasts_s, 0.005)
    accel = peak_m_s2 * np.sin(2 * np.pi * 5.0 * t) * np.cos(2 * np.pi * 2.3 * t) * np.exp(-t)
    return Record("quake", 200.0, accel)


def short_road() -> Record:
    whole = road("C", 72.0)
    return replace(whole, accel_m_s2=whole.accel_m_s2[:3000])


def comparison(rig: str) -> Comparison:
    return Comparison(Bench(), DATA / f"plants/{rig}.toml", DATA / f"boards/{rig}.toml", Shaking())


def waveform(loop: OpenLoop, seed: int = 1) -> np.ndarray:
    """Apart from 0 and the most, in steps of 7 ticks."""
    parts = np.random.default_rng(seed).uniform(0.1, 0.9, (loop.ticks // 7 + 1, len(loop.dampers)))
    return loop.max_current_A * np.repeat(parts, 7, axis=0)[: loop.ticks]


@pytest.mark.usefixtures("build")
@pytest.mark.parametrize("rig", RIGS)
def test_slopes_are_those_of_whole_runs(rig: str) -> None:
    stage = comparison(rig).stage(quake(0.6))
    loop = stage.loop()
    layout, rng = stage.layout(loop), np.random.default_rng(2)
    command_A = waveform(loop)
    way = rng.standard_normal(command_A.shape)
    step_A = 1e-5 * loop.max_current_A
    above, below = (loop.run(command_A + sign * step_A * way) for sign in (1.0, -1.0))
    motion = loop.run(command_A)
    checked = 0
    for name in SMOOTH:
        if name == "tyre_share" and not stage.contacts:
            continue
        slopes = Motion.zeros(*motion.disp_m.shape, len(loop.dampers))
        slopes_of(name, motion, layout, 12.0, 1.0, slopes)
        ours = float((loop.pull(slopes) * way).sum())
        spare = Motion.zeros(*motion.disp_m.shape, len(loop.dampers))
        high, low = (slopes_of(name, one, layout, 12.0, 1.0, spare) for one in (above, below))
        assert ours == pytest.approx((high - low) / (2 * step_A), rel=2e-3), name
        checked += 1
    assert checked >= 13


@pytest.mark.usefixtures("build")
def test_smooth_figures_sharpen_to_the_true_ones() -> None:
    stage = comparison("quarter_car").stage(short_road())
    loop = stage.loop()
    command_A = waveform(loop)
    motion = loop.run(command_A)
    true, layout = stage.figures(loop, motion, command_A), stage.layout(loop)
    spare = Motion.zeros(*motion.disp_m.shape, 1)
    for name in SMOOTH:
        sharp, soft = (slopes_of(name, motion, layout, p, 1.0, spare) for p in (1000.0, 8.0))
        assert sharp == pytest.approx(true[name], rel=0.01), name
        assert soft >= 0.999 * true[name], name


@pytest.mark.usefixtures("build")
@pytest.mark.parametrize(("rig", "law"), [
    ("three_storeys_1996", constant(0, "off")),
    ("three_storeys_1996", constant(2250, "on")),
    ("quarter_car", constant(0, "off")),
    ("quarter_car", constant(1880, "on")),
    ("two_storeys", read_law("fuzzy")),
])  # fmt: skip
def test_the_simulation_is_the_bench_s(rig: str, law: ComparedLaw) -> None:
    on = comparison(rig)
    record = quake()
    trace = on.trace(Case(law, record, 1))
    stage = on.stage(record)
    bench = figures_of(trace, on.rig.board.bodies, on.rig.board.dampers, stage.contacts)
    ours = replayed(stage, stage.commands_of(trace)).figures
    assert bench["disp_peak_mm"] > 0.1
    for name in set(bench) - {"chatter_A_s"}:  # a command counts there when it is given
        assert ours[name] == pytest.approx(bench[name], rel=1e-6, abs=1e-9), name


@pytest.mark.usefixtures("build")
def test_longer_steps_change_little_and_the_slopes_stay_theirs() -> None:
    stage = comparison("three_storeys_1996").stage(quake(0.6))
    command_A = waveform(stage.loop())
    exact, quick = (stage.loop(factor).run(command_A) for factor in (1.0, 8.0))
    assert np.abs(quick.disp_m - exact.disp_m).max() < 1e-3 * np.abs(exact.disp_m).max()
    assert np.abs(quick.disp_m - exact.disp_m).max() > 0.0


class Acceleration:
    """RMS of the first place."""

    def value(self, motion: Motion, command_A: np.ndarray) -> float:
        return float(np.sqrt(np.mean(motion.accel_m_s2[:, 0] ** 2)))

    def smooth(self, motion: Motion, sharpness: float) -> tuple[float, Motion]:
        slopes = Motion.zeros(*motion.disp_m.shape, motion.coil_A.shape[1])
        value, first = self.value(motion, motion.coil_A), motion.accel_m_s2[:, 0]
        slopes.accel_m_s2[:, 0] = first / (len(first) * value)
        return value, slopes


@pytest.mark.usefixtures("build")
def test_a_search_keeps_to_the_ceiling_and_gains() -> None:
    stage = comparison("quarter_car").stage(short_road())
    loop, judge, ceiling_A = stage.loop(), Acceleration(), 1.2
    starts = [stage.constant_A(loop, one) for one in (0.0, 0.6, 5.0)]
    before = min(judge.value(loop.run(np.minimum(one, ceiling_A)), one) for one in starts)
    told: list[float] = []
    found = best_waveform(loop, judge, ceiling_A, starts, SHORT, told.append)
    assert found.value < 0.97 * before
    assert found.value == pytest.approx(judge.value(loop.run(found.command_A), found.command_A))
    assert 0.0 <= found.command_A.min() and found.command_A.max() <= ceiling_A
    assert np.ptp(found.command_A) > 0.1
    held = found.command_A[: 10 * (loop.ticks // 10)].reshape(-1, 10)
    assert (held == held[:, :1]).all()
    assert told == sorted(told, reverse=True)


@pytest.mark.usefixtures("build")
def test_what_was_found_is_kept_under_all_that_decides_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, build: Path
) -> None:
    (tmp_path / "host").symlink_to(build / "host")
    monkeypatch.setenv("QUIESCE_BUILD", str(tmp_path))
    stage = comparison("quarter_car").stage(quake())
    loop = stage.loop()
    command_A = stage.constant_A(loop, 1.88)
    base = stage.figures(loop, loop.run(command_A), command_A)
    goal = read_goal("weighted_m_s2")

    def kept() -> set[Path]:
        return set((tmp_path / "clairvoyant").glob("*.npy"))

    first = clairvoyant(stage, goal, base, [], SHORT)
    assert goal.value(first.figures, base) < 1.0
    (file,) = kept()
    np.save(file, 0.5 * first.command_A)  # what is read back
    again = clairvoyant(stage, goal, base, [], SHORT)
    assert (again.command_A == 0.5 * first.command_A).all()
    clairvoyant(replace(stage, gain=1.1), goal, base, [], SHORT)
    clairvoyant(stage, read_goal("tyre_share"), base, [], SHORT)
    assert len(kept()) == 3


def test_a_share_is_of_the_gain_over_the_best_constant() -> None:
    def cell(law: str, weighted_m_s2: float) -> Cell:
        names = read_goal("index").weights
        figures = {**{name: 1.0 for name, _ in names}, "weighted_m_s2": weighted_m_s2}
        return Cell("rig", law, "r", 1, figures, 1.0)

    cells = [cell("no current", 1.2), cell("all current", 2.0), cell("best constant", 1.0)]
    goal = read_goal("weighted_m_s2")
    found = beside([*cells, cell("mine", 0.9)], cell("", 0.8).figures, goal)
    assert [one.law for one in found][2:] == ["best constant", "clairvoyant", "mine"]
    shares = {one.law: one.share for one in found}
    assert shares["clairvoyant"] == pytest.approx(1.0) and shares["best constant"] == 0.0
    assert shares["mine"] == pytest.approx(0.5) and shares["no current"] == pytest.approx(-1.0)
    assert "not a proof" in next(one.note for one in found if one.law == "clairvoyant")
    none = beside(cells, cell("", 1.0).figures, goal)
    assert all(one.share is None for one in none)


BAD_GOALS = [
    ("nothing", "'nothing' is nothing to search for"),
    ("lift_pct", "'lift_pct' is nothing to search for"),
    ("", "'' is nothing to search for"),
    ("disp_rms_mm,", "'' is nothing to search for"),
    ("disp_rms_mm:0", "a weight is a number"),
    ("disp_rms_mm:nan", "a weight is a number"),
    ("disp_rms_mm:x", "a weight is a number"),
]


@pytest.mark.parametrize(("text", "message"), BAD_GOALS)
def test_a_goal_that_is_none_is_refused(text: str, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        read_goal(text)


def test_weights_of_a_goal_sum_to_1() -> None:
    goal = read_goal("weighted_m_s2:3,tyre_share")
    assert dict(goal.weights) == {"weighted_m_s2": 0.75, "tyre_share": 0.25}
    twice = {"weighted_m_s2": 2.0, "tyre_share": 0.2}
    assert goal.value(twice, {"weighted_m_s2": 1.0, "tyre_share": 0.1}) == pytest.approx(2.0)


@pytest.mark.usefixtures("build")
def test_an_open_loop_refuses_what_it_cannot_simulate(tmp_path: Path) -> None:
    plant = DATA / "plants/quarter_car.toml"
    base = BaseMotion(np.sin(np.arange(100.0)), 100.0)
    loop = OpenLoop(plant, base, 500)
    with pytest.raises(UsageError, match="expected one for each of 500 ticks and 1 dampers"):
        loop.run(np.zeros((499, 1)))
    for bad_A in (-0.1, 1.9, np.nan):
        with pytest.raises(UsageError, match="not within 0 and the driver's most"):
            loop.run(np.full((500, 1), bad_A))
    with pytest.raises(UsageError, match="there is no run"):
        OpenLoop(plant, base, 500).pull(Motion.zeros(500, 2, 1))
    with pytest.raises(UsageError, match="closed to the end of its range"):
        OpenLoop(plant, replace(base, gain=300.0), 500).run(np.zeros((500, 1)))
    with pytest.raises(UsageError, match="1 to 1000000 ticks a second"):
        OpenLoop(plant, base, 1)
    with pytest.raises(UsageError):
        OpenLoop(tmp_path / "none.toml", base, 500)


@pytest.mark.usefixtures("build")
def test_without_a_possible_start_there_is_no_search() -> None:
    loop = OpenLoop(DATA / "plants/quarter_car.toml", BaseMotion(300 * np.ones(99), 100.0), 900)
    with pytest.raises(UsageError, match="keeps the dampers within their strokes"):
        best_waveform(loop, Acceleration(), 1.0, [np.zeros((900, 1))], SHORT)


def test_the_command_puts_it_beside_everything(quiesce, tmp_path: Path, build: Path) -> None:
    (tmp_path / "build").mkdir()  # with a store that is empty
    (tmp_path / "build/host").symlink_to(build / "host")
    store = {"QUIESCE_BUILD": str(tmp_path / "build")}
    quake_file = tmp_path / "quake.csv"
    quake_file.write_text(quake(0.6, 1.0).csv())
    words = ["compare", "--rig", "two_storeys", "--record", quake_file, "--law", "fuzzy"]
    goal = ["--clairvoyant", "disp_rms_mm"]
    result = quiesce(*words, *goal, "--seeds", "2", "--out", tmp_path / "out", **store)
    assert result.returncode == 0, result.stderr
    assert "clairvoyant, quake: disp_rms_mm" in result.stderr
    assert "the best waveform found for disp_rms_mm, not a proof" in result.stdout
    cells = json.loads((tmp_path / "out/compare.json").read_text())
    by_law = {(cell["law"], cell["seed"]): cell for cell in cells}
    best = by_law["clairvoyant", 1]
    assert best["figures"] == by_law["clairvoyant", 2]["figures"]
    for (_, seed), cell in by_law.items():
        assert best["figures"]["disp_rms_mm"] <= cell["figures"]["disp_rms_mm"]
        gain = (
            by_law["best constant", seed]["figures"]["disp_rms_mm"]
            - best["figures"]["disp_rms_mm"]
        )  # fmt: skip
        own = (
            by_law["best constant", seed]["figures"]["disp_rms_mm"]
            - cell["figures"]["disp_rms_mm"]
        )  # fmt: skip
        assert cell["share"] == pytest.approx(own / gain)
    rows = list(csv.DictReader((tmp_path / "out/compare.csv").open()))
    assert {row["share"] for row in rows if row["law"] == "clairvoyant"} == {"1"}
    page = (tmp_path / "out/compare.html").read_text()
    assert "not a proof" in page and "no controller can" in page
    currents = list(csv.DictReader((tmp_path / "out/clairvoyant_quake.csv").open()))
    assert list(currents[0]) == ["t_s", "lower_current_A", "upper_current_A"]
    assert len(currents) == 2595
    assert all(0.0 <= float(one["upper_current_A"]) <= 2.0 for one in currents)
    again = quiesce(*words, *goal, **store)
    assert again.returncode == 0 and " runs" not in again.stderr  # from the store
    for wrong in ("nothing", "tyre_share"):  # this plant has no tyre
        result = quiesce(*words, "--clairvoyant", wrong)
        assert result.returncode == 2 and result.stderr.count("\n") == 1, result.stderr
        assert wrong in result.stderr
