"""The bench of the control laws: its definitions on motions with a known answer, its ruler, and the
command on a small size."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from quiesce.base.errors import UsageError
from quiesce.base.paths import default_plant
from quiesce.engine.bench import Bench
from quiesce.optimum import store
from quiesce.plant.variant import Variant, write_variant
from quiesce_benchmarks.cli import main
from quiesce_benchmarks.control import benchmark, bounds, broadband, robust, safety
from quiesce_benchmarks.control.cost import Counted, added_worst_instr
from quiesce_benchmarks.control.measures import (
    band_bound_pct,
    band_reduction_pct,
    chirp_peaks,
    converge_s,
    dither_loss_pct,
    fraction_of,
    half_peaks,
    reduction_pct,
    second_amplitudes,
)
from quiesce_benchmarks.control.optima import Optima, load_optima
from quiesce_benchmarks.control.rig import (
    Plant,
    Reduction,
    Rig,
    grid_A,
    make_judged,
)
from quiesce_benchmarks.control.ruler import Bound, Ruler, reached
from quiesce_benchmarks.control.scenarios import Scenario, frozen, scaled, steady, step, two_tones
from quiesce_benchmarks.control.steady import Point, judge_sweep
from quiesce_benchmarks.control.suite import Size
from quiesce_benchmarks.control.variants import varied_plant

FIGURES = [
    "amp_red_5Hz_pct", "accel_red_5Hz_pct", "amp_red_10Hz_pct", "accel_red_10Hz_pct",
    "amp_red_15Hz_pct", "accel_red_15Hz_pct", "amp_red_20Hz_pct", "accel_red_20Hz_pct",
    "balanced_amp_red_5Hz_pct", "balanced_accel_red_5Hz_pct", "mean_current_10Hz_A",
    "amp_red_adapted_5Hz_pct", "accel_red_adapted_5Hz_pct", "amp_red_adapted_10Hz_pct",
    "accel_red_adapted_10Hz_pct", "amp_red_adapted_15Hz_pct", "accel_red_adapted_15Hz_pct",
    "amp_red_adapted_20Hz_pct", "accel_red_adapted_20Hz_pct",
    "sweep_displacement_min_fraction", "sweep_balanced_min_fraction",
    "sweep_balanced_min_accel_pct", "sweep_worst_below_constant_pts", "step_10_20_settle_s",
    "step_10_20_rms_disp_um", "step_5_10_peak_um", "step_5_10_settle_s", "robust_min_fraction",
    "robust_worst_below_constant_pts", "robust_converge_s", "robust_dither_loss_pts",
    "broadband_worst_disp_ratio", "broadband_worst_accel_ratio", "broadband_mean_current_A",
    "chirp_low_fraction", "worst_cycle_work_uJ", "inverted_worst_below_unlock_pts",
    "inverted_worst_change_pts", "day_samples_outside_limits", "day_lost_pts",
    "own_bound_worst_under_pts", "host_image_mismatches", "law_added_worst_instr",
    "law_table_bytes",
]  # fmt: skip
TINY = Size(
    sweep_Hz=(5.0, 10.0, 15.0, 20.0),
    adapt_s=12.0,
    variations=robust.GOAL_VARIATIONS[:1],
    robust_s=12.0,
    robust_step_A=5.0,
    broadband_step_A=5.0,
    day_s=60.0,
    safety_Hz=(5.0,),
)
TIME_s = np.arange(12_000) / 1000.0


# Definitions


def test_reduction_is_negative_where_it_is_worse() -> None:
    assert reduction_pct(75.0, 100.0) == pytest.approx(25.0)
    assert reduction_pct(110.0, 100.0) == pytest.approx(-10.0)


def test_fraction_of_what_cannot_be_reduced() -> None:
    assert fraction_of(9.0, 10.0) == pytest.approx(0.9)
    assert fraction_of(0.0, 0.0) == 1.0
    assert fraction_of(-1.0, 0.0) == 0.0


def test_half_peaks_are_of_whole_cycles() -> None:
    values = np.sin(2.0 * np.pi * 5.0 * TIME_s) * (1.0 + np.floor(5.0 * TIME_s + 1e-9))
    numbers, peaks = half_peaks(values, 5.0 * TIME_s)
    assert numbers.tolist() == list(range(59))
    assert peaks == pytest.approx(1.0 + np.arange(59))


def test_amplitude_of_each_second_sees_harmonics_and_not_the_mean() -> None:
    phase = 2.0 * np.pi * 4.0 * TIME_s
    values = 7.0 + np.where(TIME_s < 6.0, 1.0, 2.0) * (np.cos(phase) + np.cos(3.0 * phase) / 3.0)
    found = second_amplitudes(TIME_s, values, 4.0)
    assert len(found) == 12
    assert found[:6] == pytest.approx(np.full(6, 4.0 / 3.0), rel=1e-3)
    assert found[6:] == pytest.approx(np.full(6, 8.0 / 3.0), rel=1e-3)


def test_convergence_is_when_ten_seconds_stay_near_the_final_ones() -> None:
    falling = np.concatenate([np.linspace(2.0, 1.0, 41), np.ones(60)])
    # Ten seconds from 37 on are 0.025 (3 + 2 + 1) / 10 = 0.015 above the last ones; from 36, 0.025.
    assert converge_s(falling) == 37.0
    assert converge_s(np.ones(40)) == 0.0
    # A trial of one second changes ten seconds by a tenth of it.
    trial = np.ones(60)
    trial[50] = 1.15
    assert converge_s(trial) == 0.0
    assert converge_s(np.concatenate([np.ones(30), np.full(30, 0.9)])) > 20.0
    assert converge_s(np.array([1.0, 1.0, 1.0])) == 0.0


def test_dither_is_what_the_trials_cost() -> None:
    trials = np.tile([1.0, 1.0, 1.1], 30)
    assert dither_loss_pct(trials, 2.0) == pytest.approx(100.0 * (0.1 / 3.0) / 2.0)
    assert dither_loss_pct(np.ones(90), 2.0) == 0.0


def test_chirp_cycles_have_their_frequency() -> None:
    time_s = np.arange(36_000) / 1000.0
    phase = 2.0 * np.pi * (4.0 + 0.25 * time_s) * time_s
    freq_Hz, peaks = chirp_peaks(time_s, (4.0 + 0.5 * time_s) * np.sin(phase), 4.0, 0.5)
    assert freq_Hz[0] == pytest.approx(4.06, abs=0.02)
    assert freq_Hz[-1] == pytest.approx(22.0, abs=0.05)
    inside = freq_Hz < 15.0
    assert peaks[inside] == pytest.approx(freq_Hz[inside], rel=0.02)


def test_band_and_its_bound_weigh_cycles_alike() -> None:
    freq_Hz = np.array([3.0, 5.0, 6.0, 12.0])
    base = np.array([1.0, 2.0, 6.0, 1.0])
    assert band_reduction_pct(freq_Hz, base * 0.75, base, (4.0, 10.0)) == pytest.approx(25.0)
    found = band_bound_pct(freq_Hz, base, (4.0, 10.0), [4.0, 6.0], [30.0, 10.0])
    assert found == pytest.approx((2.0 * 20.0 + 6.0 * 10.0) / 8.0)


def test_grid_of_currents_ends_at_both_ends() -> None:
    assert grid_A(5.0, 0.25)[:2] == [0.0, 0.25] and len(grid_A(5.0, 0.25)) == 21
    assert grid_A(2.0, 0.75)[-1] == 2.0
    assert grid_A(0.1, 0.5) == [0.0, 0.1]


def test_added_instructions_compare_the_worst_of_all_scenarios() -> None:
    def counted(law: str, worst: int) -> Counted:
        return Counted("s", law, "-", worst, 1, 1, 0)

    found = [counted("fuzzy", 900), counted("fuzzy", 700), counted("phase", 950)]
    assert added_worst_instr(found, "phase") == 50


# Scenarios


def test_scenario_is_a_file_of_the_bench(build: Path, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("QUIESCE_BUILD", str(build))
    bench = Bench()
    fault = ("dropout", 1.0, 0.5)
    for scenario in (
        steady(5.0, 8.0, drive_V=0.12),
        step(5.0, 10.0, 4.0),
        two_tones((5.0, 8.0), 0.1, 10.0),
        replace(steady(5.0, 8.0), faults=(fault,), feed_current=True),
        broadband.CHIRP.scenario(),
        safety.day(1, 240.0),
    ):
        file = tmp_path / "scenario.toml"
        file.write_text(scenario.text(default_plant()), encoding="utf-8")
        assert "is valid" in bench.call("scenario-check", str(file))


def test_scenario_tables_come_out_as_they_went_in() -> None:
    data = tomllib.loads(two_tones((5.0, 8.0), 0.1, 10.0).text(Path("p.toml")))
    tones = [{"freq_Hz": 5.0, "drive_V": 0.05}, {"freq_Hz": 8.0, "drive_V": 0.05}]
    assert data["segment"] == [{"kind": "tones", "tone": tones}]
    assert "fault" not in data and "transient" not in data


def test_scaling_changes_one_number() -> None:
    one = Scenario("a", 1.0, (frozen(kind="record", gain=2.0, time_scale=5.0),), ((0.0, 1.0),))
    assert dict(scaled(one, "gain", 3.0).segments[0]) == {
        "kind": "record", "gain": 6.0, "time_scale": 5.0,
    }  # fmt: skip


def test_day_has_a_fault_every_few_seconds_and_acknowledges_what_latches() -> None:
    faults = safety.day_faults(1, 3600.0)
    assert faults == safety.day_faults(1, 3600.0) != safety.day_faults(2, 3600.0)
    starts = [t_s for kind, t_s, _ in faults if kind != "fault_reset"]
    assert 600 < len(starts) < 800 and max(np.diff(starts)) < 9.0
    for (kind, t_s, lasts_s), after in zip(faults, faults[1:], strict=False):
        if kind in safety.LATCHED:
            assert after[0] == "fault_reset" and after[1] > t_s + lasts_s


def test_robustness_has_54_plants() -> None:
    variants = {one.variant for one in robust.GOAL_VARIATIONS}
    assert len(variants) == 54
    assert Variant(rise_s=0.002, force=0.7, freq=0.9, drive_V=0.09) in variants
    assert len(robust.corners(robust.GOAL_VARIATIONS)) == 16


# The day's limits


def test_trims_beyond_their_limits_are_counted() -> None:
    trace = {
        "trim_on_mdeg": np.array([0.0, 45_000.0, -45_500.0, 0.0, 0.0]),
        "trim_off_mdeg": np.array([0.0, -45_000.0, 0.0, 0.0, 0.0]),
        "trim_level_q15": np.array([32768.0, 16384.0, 32768.0, 16000.0, 33000.0]),
    }
    assert safety.outside_limits(trace, 45_000, 50) == 3


# The ruler


class Known(Optima):
    """Own optimal control of the published plant at some frequencies."""

    def __init__(self, found: dict[float, dict[str, tuple[float, float]]]) -> None:
        self._found = found

    def reductions(self, plant_file: Path, freq_Hz: float) -> dict[str, dict[str, float]]:
        goals = self._found.get(freq_Hz, {})
        return {
            goal: {"amp_red_pct": amp, "accel_red_pct": accel, "mean_current_A": 1.0}
            for goal, (amp, accel) in goals.items()
        }


def published_plant(drive_V: float = 0.1) -> Plant:
    return Plant(default_plant().resolve(), 5.0, drive_V, 0.005)


def test_bound_is_the_best_of_all_that_is_known() -> None:
    own = {"amp": (18.9, -16.0), "accel": (9.0, 8.5), "no_worse": (17.0, -0.0005)}
    ruler = Ruler(published_plant(), Known({5.0: own}), [5.0])
    assert ruler.bound(5.0) == Bound(19.1, 8.5, 17.0)
    assert ruler.own_under()[0]["under_pts"] == pytest.approx(0.2)
    ruler.learn(5.0, [Reduction(19.4, -12.0, 2.0), Reduction(17.2, 0.3, 3.0)])
    assert ruler.bound(5.0) == Bound(19.4, 8.5, 17.2)
    assert ruler.own_under()[0]["under_pts"] == pytest.approx(0.2)


def test_what_laws_reach_is_no_bound_by_itself() -> None:
    ruler = Ruler(published_plant(0.12), Known({}), [7.5])
    ruler.learn(7.5, [Reduction(10.0, 5.0, 2.0)])
    assert ruler.bound(7.5) == Bound()
    assert not ruler.is_published and ruler.lacking_Hz() == [7.5]
    assert ruler.amp_grid((4.0, 10.0)) is None and ruler.worst_under_pts() is None


def test_own_bound_is_judged_over_the_whole_table() -> None:
    some = {5.0: {"amp": (19.1, 8.3)}}
    assert Ruler(published_plant(), Known(some), []).worst_under_pts() is None
    table = Ruler(published_plant(), Known({}), []).lacking_Hz()
    own = {f: {"amp": (50.0, 50.0)} for f in table}
    assert Ruler(published_plant(), Known(own), []).worst_under_pts() < 0.0
    own[20.0] = {"amp": (26.0, 20.0)}
    assert Ruler(published_plant(), Known(own), []).worst_under_pts() == pytest.approx(1.8)


def test_other_plants_have_their_own_bound() -> None:
    ruler = Ruler(published_plant(), Known({5.0: {"amp": (14.0, 0.0)}}), [])
    other = replace(published_plant(), file=Path("other.toml"))
    assert ruler.amp_pct_of(other, 5.0, 13.0) == 14.0
    assert ruler.amp_pct_of(other, 5.0, 14.5) == 14.5
    assert ruler.amp_pct_of(other, 10.0, 14.5) is None


def test_other_plants_are_those_whose_bounds_are_stored(
    build: Path, tmp_path: Path, monkeypatch
) -> None:
    monkeypatch.setenv("QUIESCE_BUILD", str(build))
    plant = published_plant()
    judged, params = make_judged(Bench(), "constant", [], plant)
    rig = Rig(Bench(), plant, judged, params, 1, tmp_path)
    variations = robust.GOAL_VARIATIONS[::7]
    mine = {store.case_key(varied_plant(rig, one).file, 5.0) for one in variations}
    stored = [case for case in bounds.robust_cases(plant.file) if case.freq_Hz == 5.0]
    for case in stored[::7]:
        write_variant(case.plant, case.variant, tmp_path / "theirs.toml")
        mine.discard(store.case_key(tmp_path / "theirs.toml", 5.0))
    assert len(variations) == len(stored[::7]) and not mine


def test_balanced_bound_needs_acceleration_no_worse() -> None:
    assert reached([Reduction(20.0, -1.0, 0.0), Reduction(15.0, 0.0, 0.0)]) == Bound(
        20.0, 0.0, 15.0
    )
    assert reached([Reduction(20.0, -1.0, 0.0)]).balanced_amp_pct is None


def test_committed_bounds_are_found_and_near_the_published_table() -> None:
    ruler = Ruler(published_plant(), load_optima([]), [])
    assert ruler.lacking_Hz() == []
    assert ruler.worst_under_pts() <= 0.5


def point(freq_Hz: float, amp_pct: float, accel_pct: float) -> Point:
    law = Reduction(amp_pct, accel_pct, 3.0)
    both = {"displacement": law, "balanced": law}
    constant = Reduction(20.0, 20.0, 5.0)
    times = {"displacement": 0.0, "balanced": 0.0}
    return Point(freq_Hz, {}, constant, constant, both, both, times, times)


def test_sweep_is_judged_by_its_worst_frequency() -> None:
    own = {
        5.0: {"amp": (20.0, -20.0), "no_worse": (16.0, 0.0)},
        10.0: {"amp": (26.0, 26.0)},
        20.0: {"amp": (27.0, 20.0)},
    }
    ruler = Ruler(published_plant(0.12), Known(own), list(own))
    points = [point(5.0, 15.0, -0.5), point(10.0, 26.0, 25.0), point(20.0, 18.9, 19.0)]
    sweep = judge_sweep(points, ruler)
    assert sweep.displacement_min_fraction == pytest.approx(0.7)
    assert sweep.balanced_min_fraction == pytest.approx(0.7)
    assert sweep.balanced_min_accel_pct == -0.5
    # Below 10 Hz the constant may be better.
    assert sweep.worst_below_constant_pts == pytest.approx(1.1)
    assert judge_sweep([*points, point(7.5, 1.0, 1.0)], ruler).displacement_min_fraction is None


# The command


@pytest.fixture
def bench(build: Path, tmp_path: Path, monkeypatch, capsys):
    """`./tools/benchmark control` on a tiny size: exit code and what it printed."""
    monkeypatch.setenv("QUIESCE_BUILD", str(build))
    monkeypatch.setattr(benchmark, "QUICK", TINY)
    monkeypatch.chdir(tmp_path)

    def run(*options: str) -> tuple[int, str]:
        code = main(["control", "--quick", "--no-cost", "--out", "out", *options])
        return code, capsys.readouterr().out

    return run


@pytest.mark.slow
def test_command_prints_every_figure_and_writes_plots(bench, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    code, printed = bench("--json", "--check", "--data", "empty")
    report = json.loads(printed)
    figures = {figure["name"]: figure for figure in report["figures"]}
    assert list(figures) == FIGURES
    assert code == (1 if any(one["ok"] is False for one in figures.values()) else 3)
    for name in ("broadband_worst_disp_ratio", "law_added_worst_instr", "host_image_mismatches"):
        assert figures[name]["value"] is None and figures[name]["ok"] is None
    for name in ("amp_red_5Hz_pct", "robust_worst_below_constant_pts", "chirp_low_fraction"):
        assert isinstance(figures[name]["value"], float)
    context = report["context"]
    assert len(context["robust"]) == 4 and len(context["robust_extra"]) == 12
    assert len(context["broadband"]) == 8
    assert sum("not on this machine" in line for line in context["absent"]) == 2
    for name in ("sweep", "robust", "steps", "broadband", "chirp", "adaptation"):
        assert "<svg" in (tmp_path / f"out/{name}.svg").read_text()


@pytest.mark.slow
def test_any_law_on_any_plant_can_be_judged(bench, tmp_path: Path) -> None:
    """Published goals are not for it, and bounds are not known; constants are."""
    plant = tomllib.loads(default_plant().read_text())
    text = default_plant().read_text().replace("rise_s = 0.005", "rise_s = 0.004")
    assert plant["coil"]["rise_s"] == 0.005
    (tmp_path / "mine.toml").write_text(text)
    (tmp_path / "empty").mkdir()
    code, printed = bench(
        "--json", "--plant", "mine.toml", "--law", "constant", "--data", "empty",
        "--set", "constant_current_mA=5000",
    )  # fmt: skip
    report = json.loads(printed)
    figures = {figure["name"]: figure for figure in report["figures"]}
    assert code == 0
    assert figures["amp_red_10Hz_pct"]["value"] == pytest.approx(22.88, abs=0.02)
    assert figures["amp_red_10Hz_pct"]["goal"] is None
    assert figures["robust_worst_below_constant_pts"]["value"] == pytest.approx(0.0, abs=0.05)
    assert figures["sweep_displacement_min_fraction"]["value"] is None
    assert any("mine.toml" in line for line in report["context"]["absent"])


def test_laws_without_adaptation_take_no_settings_of_it(build: Path, monkeypatch) -> None:
    monkeypatch.setenv("QUIESCE_BUILD", str(build))
    bench, plant = Bench(), published_plant()
    judged, _ = make_judged(bench, "fuzzy", ["rms_window_ms=400"], plant)
    assert judged.control("displacement") == judged.control("balanced", "off")
    judged, params = make_judged(bench, "phase", [], plant)
    words = judged.control("balanced", "off").words()
    assert "phase_setting=balanced" in words and "adapt=off" in words
    assert params["unlock_current_mA"] == 5000
    with pytest.raises(UsageError, match="magic"):
        make_judged(bench, "magic", [], plant)


def test_controller_fits_the_plant_s_driver_and_coil(build: Path, monkeypatch) -> None:
    monkeypatch.setenv("QUIESCE_BUILD", str(build))
    small = Plant(Path("p.toml"), 2.0, 0.5, 0.012)
    settings = ["unlock_current_mA=1500"]
    params = make_judged(Bench(), "phase", settings, small)[1]
    assert params["max_current_mA"] == 2000 and params["constant_current_mA"] == 2000
    assert params["unlock_current_mA"] == 1500 and params["current_lag_ms"] == 12
    large = Plant(Path("p.toml"), 8.0, 0.5, 0.005)
    assert make_judged(Bench(), "phase", [], large)[1]["max_current_mA"] == 5000


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--plant", "nowhere.toml"], ["nowhere.toml"]),
        (["--plant", "half.toml"], ["half.toml", "structure.mode"]),
        (["--law", "magic"], ["--law magic", "fuzzy", "phase"]),
        (["--law", "fuzzy", "--table", "half.toml"], ["--table half.toml", "no table"]),
        (["--table", "half.toml"], ["half.toml"]),
        (["--bounds", "nowhere.json"], ["--bounds nowhere.json", "no such file"]),
        (["--bounds", "half.toml"], ["half.toml", "bounds"]),
        (["--set", "colour=1"], ["colour", "quiesce params"]),
        (["--data", "nowhere"], ["--data nowhere", "no such folder"]),
        (["--seed", "-1"], ["--seed"]),
    ],
)
def test_bad_input_is_one_line(refused, tmp_path: Path, options, words) -> None:
    text = default_plant().read_text().replace("freq_Hz = 96.0", "freq_Hz = -96.0")
    (tmp_path / "half.toml").write_text(text)
    message = refused("bench", "control", "--quick", *options)
    for word in words:
        assert word in message
