"""`./tools/benchmark laws`: its figures are what they say."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import require
from quiesce.base.errors import UsageError
from quiesce.compare.records import Record
from quiesce.compare.roads import CLASSES_1e6_m3, RATE_Hz, bump, read_road, road
from quiesce.engine.bench import Bench
from quiesce.engine.laws import labels
from quiesce.law.recipes import RECIPES, find
from quiesce.tune.gains.defaults import INDEX
from quiesce.tune.gains.trials import Trial
from quiesce_benchmarks.house.committed import Committed
from quiesce_benchmarks.laws import (
    cantilever_rig,
    law_cases,
    law_runs,
    page,
    rigs,
    scaled_settings,
    tuned,
)
from quiesce_benchmarks.laws.page import law_table
from quiesce_benchmarks.laws.parts import (
    bounded,
    building,
    cantilever,
    cost,
    integers,
    unseen,
    unseen_road,
)
from quiesce_benchmarks.laws.tuned import Tried
from quiesce_benchmarks.part import Effort


def test_integers_of_every_recipe_are_close(build, tmp_path) -> None:
    found = integers.measure(Effort(1, True, tmp_path))
    assert found.values["law_float_error_worst_pct"] < 1.0
    assert found.values["law_float_flips_worst_pct"] < 0.1
    assert found.tables[0].count("\n") == 1 + len(RECIPES)  # a row a recipe


def test_differences_are_of_what_was_published() -> None:
    ours = ([1.1, 2.0], [0.5, 0.6], [90.0, 100.0], [50.0])
    assert building.difference_pct(ours, ([1.0, 2.0], [], [100, 100], [])) == pytest.approx(10.0)
    assert building.difference_pct(ours, ([1.1, 2.0], [0.5, 0.3], [90, 100], [50])) == (
        pytest.approx(100.0)
    )


def trial(number: int, **index: float) -> Trial:
    """An index by record."""
    return Trial({"x": float(number)}, {name: {INDEX: value} for name, value in index.items()})


@pytest.fixture
def tried() -> Tried:
    """Law one is best where a is left out, but bad on a; settings 1 of two suit a alone."""
    constants = [{name: {INDEX: value} for name in "abc"} for value in (2.0, 1.2, 1.0)]
    return Tried(
        {
            "one": [trial(0, a=1.9, b=0.9, c=0.9), trial(1, a=2.0, b=1.0, c=1.0)],
            "two": [trial(0, a=0.95, b=0.95, c=1.1), trial(1, a=0.1, b=1.5, c=1.5)],
            "three": [Trial({"x": 0.0}, {}, "it does not fit"), Trial({"x": 1.0}, {}, "nor this")],
            "four": [Trial({"x": 0.0}, {}, "too large"), trial(1, a=3.0, b=3.0, c=3.0)],
        },
        constants,
    )


RECORDS = [Record(name, 100.0, np.ones(2)) for name in "abc"]


def test_law_and_settings_of_a_record_are_chosen_on_the_others(tried: Tried) -> None:
    law, chosen = tuned.chosen_law(unseen.AIM, tried.run(), "a")
    assert (law, chosen.values) == ("one", {"x": 0.0})  # what it does on a is not known
    law, chosen = tuned.chosen_law(unseen.AIM, tried.run(), "b")
    assert (law, chosen.values) == ("two", {"x": 1.0})
    assert tried.refused() == {"three": "it does not fit"}


def test_a_laws_row_is_of_what_it_was_not_tuned_on(tried: Tried) -> None:
    found = unseen.law_data("two", tried, RECORDS)
    # Without b: .95 and 1.1 cost 1.05, .1 and 1.5 cost 1.03, so that b gets 1.5.
    assert found["index_tuned"] == pytest.approx(np.mean([0.95, 1.5, 1.1]))
    assert found["index_tuned_worst"] == 1.5
    assert found["index_untuned"] == pytest.approx(1.0)
    assert found["index_passive_off"] == 2.0 and found["index_best_constant"] == 1.0
    assert found["beats_passive_off"] is True and found["beats_best_constant"] is False
    assert found["beats_hindsight_constant_of"] == 1  # a alone: .95 below 1
    started_refused = unseen.law_data("four", tried, RECORDS)
    assert started_refused["index_untuned"] is None
    assert "refused" in unseen.laws_table({"four": started_refused})


def test_a_road_is_judged_by_settings_of_the_others() -> None:
    def runs(**figure: float) -> dict:
        return {n: {"weighted_m_s2": x, "tyre_share": 2 - x} for n, x in figure.items()}

    one = [Trial({"x": 0.0}, runs(u=1.0, v=1.0)), Trial({"x": 1.0}, runs(u=0.1, v=1.2))]
    found = unseen_road.judged(Tried({"one": one}, [runs(u=1.5, v=1.5), runs(u=1.1, v=1.1)]), "u")
    comfort, tyre = (found.reported["laws"]["one"][key] for key in ("comfort", "tyre"))
    assert comfort["tuned"] == 1.0 and comfort["settings"] == {"x": 0.0}  # not the .1 of u itself
    assert comfort["best_constant"] == 1.1 and comfort["passive_off"] == 1.5
    assert comfort["beats_passive_off"] is True and comfort["beats_best_constant"] is True
    assert tyre["settings"] == {"x": 1.0} and tyre["tuned"] == 1.9
    assert tyre["beats_best_constant"] is False
    assert found.values["unseen_road_comfort_m_s2"] == 1.0


def test_every_recipe_gets_as_many_settings(build) -> None:
    own = tuned.candidates(rigs.BUILDING, unseen.START, None)
    assert {one.tunable.recipe.name for one in own} == {one.name for one in RECIPES}
    assert all(one.tunable.tracker != "inverse" for one in own)  # it has no map
    assert {len(one.settings(5, 1)) for one in own if one.tunable.space.searched} == {5}
    start = next(one for one in own if one.label == "lyapunov").settings(5, 1)[0]
    assert start["natural_Hz"] == 5.5


@pytest.mark.parametrize("kind", CLASSES_1e6_m3)
def test_a_road_has_the_density_of_its_class(kind: str) -> None:
    """Acceleration's mean square in a band of 2 to 10 Hz, from the height's density."""
    speed_m_s = 20.0
    accel = road(kind, 3.6 * speed_m_s).accel_m_s2[1000:]
    spectrum = np.abs(np.fft.rfft(accel)) ** 2 * 2 / len(accel) ** 2
    freq = np.fft.rfftfreq(len(accel), 1 / RATE_Hz)
    inside = (freq > 2) & (freq < 10)
    # G(n) = G0 (n / 0.1)^-2, f = n v: the acceleration's density is (2 pi)^4 f^2 G0 0.01 v.
    expected = (
        (2 * np.pi) ** 4 * (10**3 - 2**3) / 3 * 1e-6 * CLASSES_1e6_m3[kind] * 0.01 * speed_m_s
    )
    assert spectrum[inside].sum() == pytest.approx(expected, rel=0.25)
    assert (road(kind, 72.0).accel_m_s2 == road(kind, 72.0).accel_m_s2).all()


def test_a_bump_rises_to_its_height_and_comes_back() -> None:
    accel = bump(0.05, 2.0, 36.0).accel_m_s2
    speed, height = np.zeros(len(accel)), np.zeros(len(accel))
    speed[1:] = np.cumsum(accel[1:] + accel[:-1]) / (2 * RATE_Hz)
    height[1:] = np.cumsum(speed[1:] + speed[:-1]) / (2 * RATE_Hz)
    assert height.max() == pytest.approx(0.05, rel=0.02)
    assert abs(height[-1]) < 0.002


@pytest.mark.parametrize("text", ["", "F:72", "C", "C:x", "C:0", "C:400", "bump:1", "bump:9:1:36"])
def test_what_is_no_road_is_refused(text: str) -> None:
    with pytest.raises(UsageError, match="expected a class A to E"):
        read_road(text)


def test_every_law_and_tracker_of_the_registries_is_run(build) -> None:
    cases = [case for group in law_cases.all_cases() for case in group]
    assert {case.name for case in cases} == set(cost.NAMES)
    assert {case.law for case in cases} == set(labels())
    assert {case.tracker for case in cases if case.tracker} == set(law_cases.trackers())
    with_forces = [group for group in law_cases.all_cases() if group[0].tracker]
    assert all(len(group) == len(law_cases.trackers()) for group in with_forces)


@pytest.fixture
def law_programs(build: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As they are there: nothing is built."""
    monkeypatch.setenv("QUIESCE_BUILD", str(build))
    require(build / "host/tools/benchmarks/law_runs")
    require(build / "mps2/tools/benchmarks/law_runs.elf")


def test_a_law_has_the_same_words_on_host_and_image(law_programs) -> None:
    ticks, case = 640, law_cases.of_recipe(find("clipped_optimal"))[0]
    found = cost.cost_of(case, ticks, 1, 0.0)
    assert (found.mismatched, found.compared) == (0, ticks * (46 + 8))
    assert found.alone.worst < found.whole.worst < 6000
    assert found.row()["state_bytes"] == 92  # six states, their rests, a count
    off = law_cases.of_label("off")
    assert cost.cost_of(off, ticks, 1, 0.0).whole.mean < found.whole.mean


def test_words_that_differ_are_counted_by_their_blocks() -> None:
    ours = law_runs.Run({"words_a_tick": 5}, (1, 2, 3))
    assert law_runs.words_apart(ours, ours, 150) == 0
    theirs = law_runs.Run({"words_a_tick": 5}, (1, 9, 3))
    assert law_runs.words_apart(ours, theirs, 150) == law_runs.BLOCK_TICKS * 5
    none = law_runs.Run({"words_a_tick": 5}, (7, 8, 9))
    assert law_runs.words_apart(ours, none, 150) == 150 * 5


def test_what_the_controller_refuses_is_no_run(law_programs) -> None:
    case = law_cases.of_recipe(find("skyhook_on_off"))[0]
    for words in ((), case.words[:-1]):
        spoilt = replace(case, words=words)
        with pytest.raises(UsageError, match="the order is refused"):
            law_runs.on_host(law_runs.order(spoilt, law_runs.ALONE, 64, 1, None))


def test_no_law_energises(law_programs) -> None:
    case = law_cases.of_recipe(find("sliding_mode"))[0]
    row = bounded.row_of(case, bounded.runs_of(case, 20000, 1))
    assert row["energised"] == row["beyond"] == 0
    assert row["ticks"] > 30000 and 0.05 < row["with_current"] < 0.95
    assert 0 < row["accepted"] < row["tables"]


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("sky_N_s_m", {"N": 1, "s": 1, "m": -1}),
        ("gain_N_m", {"N": 1, "m": -1}),
        ("limit_N", {"N": 1}),
        ("band_m_s2", {"m": 1, "s": -2}),
        ("displacement_1_m2", {"m": -2}),
        ("accel_s4_m2", {"s": 4, "m": -2}),
        ("force_1_N2", {"N": -2}),
        ("e3_A_s2_m2", {"A": 1, "s": 2, "m": -2}),
        ("natural_Hz", {"Hz": 1}),
        ("mass_kg", {"kg": 1}),
        ("last_share", {}),
        ("outward", {}),
    ],
)
def test_units_of_settings(name: str, unit: dict[str, int]) -> None:
    assert scaled_settings.unit_of(name) == unit


def test_settings_follow_the_size_of_the_rig() -> None:
    there = scaled_settings.Sizes(N=100.0, m=0.01, s=0.1, A=2.0)
    here = scaled_settings.Sizes(N=1.0, m=0.001, s=0.1, A=2.0)
    sky, friction = find("skyhook"), find("modulated_friction")
    assert [scaled_settings.scaled(one, here, there) for one in sky.settings] == pytest.approx(
        [0.1 * one.default if one.name == "sky_N_s_m" else 0.01 * one.default
         for one in sky.settings]
    )  # fmt: skip
    tried = scaled_settings.trials(friction, here, there, 20, 1)
    assert tried == scaled_settings.trials(friction, here, there, 20, 1)
    assert tried != scaled_settings.trials(friction, here, there, 20, 2)
    for one in friction.settings:
        values = [trial[one.name] for trial in tried]
        assert all(one.low <= value <= one.high for value in values)
        assert len(set(values)) > 1


def test_the_heavy_twin_moves_as_the_cantilever_does(build, tmp_path) -> None:
    made = cantilever_rig.make_rig(tmp_path)
    scenario = cantilever_rig.steady(10.0)
    figures = []
    for on in (None, 0, 1):
        file = cantilever_rig.scenario_file(made, scenario, on)
        control = cantilever_rig.Control("constant", ("--set", "constant_current_mA=5000"), on)
        figures.append(cantilever_rig.run(Bench(), file, control, 1))
    own, *twins = figures
    for twin in twins:
        assert twin["faults_seen"] == []
        for key in ("amp_um", "accel_rms_mm_s2", "mean_current_A"):
            assert twin[key] == pytest.approx(own[key], rel=1e-9)
        assert twin["damper_work_J"] == pytest.approx(1000 * own["damper_work_J"], rel=1e-9)


def test_a_recipe_on_the_cantilever_is_the_best_of_its_trials(build, tmp_path) -> None:
    made = cantilever_rig.make_rig(tmp_path)
    runs, rigs = cantilever.Runs(Bench(), made, 1), cantilever_rig.law_rigs(made)
    few = cantilever.of_recipe(runs, rigs, find("skyhook"), 1, 1)
    more = cantilever.of_recipe(runs, rigs, find("skyhook"), 4, 1)
    assert isinstance(few, cantilever.Row) and isinstance(more, cantilever.Row)
    assert more.score_pct >= few.score_pct
    assert more.on == 0 and len(more.steady) == 4 and len(more.step.amp_pct) == 2
    assert "no lower body" in str(cantilever.of_recipe(runs, rigs, find("groundhook"), 2, 1))


def test_tables_of_the_page_are_of_the_committed_result() -> None:
    assert law_table("costs", Committed({})) == page.UNKNOWN
    outcome = {"amp_pct": [12.34], "accel_pct": [-1.0], "mean_current_A": 2.0}
    row = {
        "tracker": "inverse", "steady": [outcome] * 4, "score_pct": 5.67,
        "step": {**outcome, "amp_pct": [1.0, 2.0], "transient_rms_um": 13.7},
    }  # fmt: skip
    bound = {"amp_pct": [19.1], "accel_pct": [8.3]}
    costs = {"skyhook, inverse": {
        "tracker": "inverse", "tick_worst_instr": 5226, "tick_mean_instr": 3926.4,
        "added_mean_instr": 453.0, "own_worst_instr": 707, "own_mean_instr": 337.2,
        "state_bytes": 0, "table_words": 14,
    }}  # fmt: skip
    parts = {
        "cantilever": {"rows": {"skyhook": row}, "simulated": {}, "bound": bound},
        "cost": {"costs": costs},
    }
    committed = Committed({"laws": {"figures": [], "context": {"reported": parts}}})
    assert "| skyhook | inverse | 12.3 / 12.3 / 12.3 / 12.3 |" in law_table("cantilever", committed)
    assert "| bound | | 19.1 | 8.3 |" in law_table("cantilever", committed)
    assert "| skyhook | inverse | 5226 | 3926 | 453 | 707 | 337 | 0 | 14 |" in (
        law_table("costs", committed)
    )
    with pytest.raises(KeyError):
        law_table("nothing", committed)
