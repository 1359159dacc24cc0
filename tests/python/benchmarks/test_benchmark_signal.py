"""The bench of the sensing chain: its definitions on synthetic traces, its bound and its offline
estimate against closed forms, and the command on a small budget."""

import json
from pathlib import Path

import numpy as np
import pytest
from quiesce.signal.replay import own_sensor
from quiesce_benchmarks.cli import main
from quiesce_benchmarks.seeds import generator
from quiesce_benchmarks.signal import benchmark, recorded, response, truth
from quiesce_benchmarks.signal.accuracy import Readings, neighbour_Hz, reading_tick, wrapped_deg
from quiesce_benchmarks.signal.bounds import sine_bound
from quiesce_benchmarks.signal.offline import dominant_Hz, trailing_Hz
from quiesce_benchmarks.signal.plant import lasting_s
from quiesce_benchmarks.signal.records import (
    Rig,
    Tally,
    make_rig,
    noise_rms,
    tally_switched,
    tone,
    with_noise,
)
from quiesce_benchmarks.signal.response import ticks_until_first, ticks_until_lasting
from quiesce_benchmarks.signal.rms import conditioned, windowed_rms
from quiesce_benchmarks.signal.suite import Budget

TINY = Budget(accuracy=4, steps=3, steady=3, dropouts=3, truth=3, stick_slip=1, stress=2, offline=5)
FIGURES = [
    "freq_rmse_over_crlb_max", "freq_rmse_over_crlb_60dB", "phase_excess_deg", "rms_error_pct",
    "settle_10_20_s", "settle_5_10_s", "settle_20_5_s", "invalid_after_step_ms",
    "valid_steady_pct", "valid_but_wrong_pct", "dropout_recovery_s", "two_tone_correct_pct",
    "stickslip_fundamental_pct", "sweep_within_0p12Hz_pct", "tick_worst_instr",
    "tick_median_instr", "tick_mean_instr", "cmsis_q15_peak_instr", "cmsis_q31_peak_instr",
    "peak_ratio_q15", "peak_ratio_q31", "ram_bytes",
]  # fmt: skip


@pytest.fixture
def rig(build: Path, monkeypatch: pytest.MonkeyPatch) -> Rig:
    monkeypatch.setenv("QUIESCE_BUILD", str(build))
    return make_rig([])


# The bound


def closed_forms(snr: float, ticks: int, rate_Hz: int) -> tuple[float, float]:
    """Many cycles: deviations of frequency and of the phase at the last sample (Rife, Boorstyn)."""
    freq_Hz = np.sqrt(12.0 / snr / ticks / (ticks**2 - 1.0)) / (2.0 * np.pi) * rate_Hz
    phase_rad = np.sqrt((1.0 / ticks + 3.0 * (ticks - 1.0) / ticks / (ticks + 1.0)) / snr)
    return freq_Hz, phase_rad


@pytest.mark.parametrize(("ticks", "rate_Hz"), [(1024, 1000), (500, 500), (4096, 4000)])
def test_bound_of_many_cycles_is_the_closed_form(ticks, rate_Hz) -> None:
    # A^2 / (2 noise^2) = 50: the closed forms' ratio.
    bound = sine_bound(
        np.array([40.0]), np.array([0.3]), np.array(2.0), np.array(0.2), np.array([ticks]), rate_Hz
    )
    freq_Hz, phase_rad = closed_forms(50.0, ticks, rate_Hz)
    assert bound.freq_Hz[0] == pytest.approx(freq_Hz, rel=0.01)
    assert bound.phase_rad[0] == pytest.approx(phase_rad, rel=0.01)
    assert bound.amplitude_m_s2[0] == pytest.approx(0.2 * np.sqrt(2.0 / ticks), rel=0.01)


def test_bound_rises_with_few_cycles_and_depends_on_phase() -> None:
    phase = np.linspace(0.0, np.pi, 60)
    windows = np.full(phase.size, 250)
    many = sine_bound(np.full(phase.size, 40.0), phase, 1.0, 0.1, windows, 1000).freq_Hz
    few = sine_bound(np.full(phase.size, 3.0), phase, 1.0, 0.1, windows, 1000).freq_Hz
    assert np.ptp(many) < 0.1 * many.mean()
    assert few.max() > 1.2 * many.mean()
    assert np.ptp(few) > 0.2 * few.mean()


def test_bound_keeps_records_of_different_windows_apart() -> None:
    windows = np.array([1024, 256, 1024, 128])
    freq_Hz, phase = np.array([10.0, 20.0, 30.0, 40.0]), np.zeros(4)
    together = sine_bound(freq_Hz, phase, 1.0, 0.1, windows, 1000)
    for i in range(4):
        alone = sine_bound(freq_Hz[[i]], phase[[i]], 1.0, 0.1, windows[[i]], 1000)
        assert together.freq_Hz[i] == pytest.approx(alone.freq_Hz[0], rel=1e-9)


# The offline estimate


def test_offline_estimate_reaches_the_bound_at_few_cycles() -> None:
    rng = generator(3, "offline")
    count, ticks = 400, 512
    freq_Hz = rng.uniform(4.5, 9.0, count)
    phase = rng.uniform(-np.pi, np.pi, count)
    clean = tone(freq_Hz, phase, ticks - 1, ticks, 1000)
    windows = with_noise(clean, 0.1, rng)
    error_Hz = dominant_Hz(windows, 1000, tones=1) - freq_Hz
    bound = sine_bound(freq_Hz, phase, 1.0, 0.1, np.full(count, ticks), 1000)
    ratio = np.sqrt(np.mean(np.square(error_Hz / bound.freq_Hz)))
    assert 0.9 < ratio < 1.1


@pytest.mark.parametrize(
    ("components", "dominant"),
    [
        ([(4.0, 1.0), (12.0, 3.0)], 4.0),
        ([(7.3, 1.0), (11.0, 1.0)], 7.3),
        ([(7.3, 0.2), (11.0, 1.0)], 11.0),
        ([(5.0, 0.02), (21.0, 1.0)], 21.0),
        ([(12.2, 0.45), (26.0, 1.0)], 26.0),
        ([(7.05, 0.1), (21.1, 1.0)], 21.1),
        ([(6.0, 1.0), (9.0, 0.8), (14.0, 0.9)], 6.0),
    ],
)
def test_offline_estimate_names_the_dominant_component(components, dominant) -> None:
    time_s = np.arange(1024) / 1000.0
    signal = 9.8 + sum(a * np.cos(2.0 * np.pi * f * time_s + f) for f, a in components)
    assert dominant_Hz(signal[None, :], 1000, tones=3)[0] == pytest.approx(dominant, abs=1e-3)


@pytest.mark.parametrize("kind", list(truth.KINDS))
def test_truth_table_can_be_met_from_one_window(kind) -> None:
    rng = generator(6, kind)
    cases = truth.KINDS[kind](rng, 60)
    clean = sum(
        cases.amplitude_m_s2[:, i, None]
        * tone(cases.freq_Hz[:, i], rng.uniform(-np.pi, np.pi, 60), 0, 1024, 1000)
        for i in range(2)
    )
    noise = noise_rms(cases.amplitude_m_s2[:, 0], truth.SNR_dB, 1000)
    told_Hz = dominant_Hz(with_noise(clean, noise, rng), 1000, tones=3)
    assert np.abs(told_Hz / cases.freq_Hz[:, 0] - 1.0).max() <= truth.TOLERANCE


def test_trailing_estimate_uses_the_samples_before_its_end() -> None:
    first, second = (tone(np.array([f]), np.zeros(1), 0, 600, 1000)[0] for f in (10.0, 20.0))
    samples = np.concatenate([first, second])
    found = trailing_Hz(
        samples, np.array([599, 1199, 1199, 100, 599]), np.array([512, 512, 256, 512, 0]), 1000, 1
    )
    assert found[:3] == pytest.approx([10.0, 20.0, 20.0], abs=0.01)
    assert np.isnan(found[3:]).all()


# Definitions on synthetic traces


def flags(text: str) -> np.ndarray:
    return np.array([[letter == "1" for letter in row] for row in text.split()])


def test_settling_counts_to_where_it_stays() -> None:
    good = flags("0011111111 0010111111 1111111111 0000000000 0011111110")
    assert ticks_until_lasting(good, np.full(5, 1)).tolist() == [1, 3, 0, 9, 9]
    assert lasting_s(np.array([10.0, 15.0, 20.9, 21.5, 20.9, 19.1]), 20.0, 0.1) == (
        pytest.approx(0.4)
    )
    assert lasting_s(np.array([20.0, 10.0]), 20.0, 0.1) is None
    assert lasting_s(np.array([20.0, np.nan, 20.0]), 20.0, 0.1) == pytest.approx(0.2)


def test_first_tick_ignores_what_was_before() -> None:
    good = flags("1100001100 0000000000 1111111111")
    assert ticks_until_first(good, np.array([2, 2, 4])).tolist() == [4, 8, 0]


def test_reading_is_the_last_full_window_else_the_last_tick() -> None:
    window_ms = np.array(
        [
            [512, 1024, 1024, 1024, 128, 256],
            [1024, 1024, 256, 256, 256, 512],
            [0, 0, 0, 0, 512, 1024],
        ]
    )
    assert reading_tick(window_ms, 1024, 3).tolist() == [3, 5, 5]


def test_phase_errors_wrap() -> None:
    assert wrapped_deg(np.array([359.0, -359.0, 181.0, 540.5, 90.0])) == pytest.approx(
        [-1.0, 1.0, -179.0, -179.5, 90.0]
    )


def readings(**changes: float) -> Readings:
    values = {
        "freq_Hz": 10.0, "error_Hz": 0.0, "bound_Hz": 0.1, "phase_error_deg": 0.0,
        "phase_bound_deg": 1.0, "amplitude_error": 0.0, "window_ms": 1024.0, "is_valid": 1.0,
    }  # fmt: skip
    return Readings(**{name: np.array([value]) for name, value in {**values, **changes}.items()})


def test_readings_need_two_cycles_or_count_as_no_estimate() -> None:
    assert readings(window_ms=200.0).is_counted.all()
    assert not readings(window_ms=199.0).is_counted.any()
    assert readings(window_ms=0.0).is_counted.all()


def test_readings_are_judged_against_their_own_bound() -> None:
    assert readings(error_Hz=-0.15).ratio == pytest.approx(1.5)
    assert readings(phase_error_deg=2.0).phase_excess_deg == pytest.approx(0.5)
    assert readings(error_Hz=1.01).outlier_pct == 100.0
    assert readings(error_Hz=0.99).outlier_pct == 0.0


def test_tally_counts_valid_ticks_that_are_more_than_10_percent_off() -> None:
    tally = Tally()
    freq_uHz = np.array([[10_000_000, 11_100_000, 8_900_000, 10_900_000, 30_000_000]])
    tally.add(freq_uHz, np.array([[1, 1, 1, 1, 0]]), np.array(10.0))
    assert (tally.ticks, tally.valid, tally.wrong, tally.wrong_late) == (5, 4, 2, 2)


def test_tally_knows_what_comes_right_after_a_change(rig: Rig) -> None:
    out = {
        "freq_uHz": np.full((1, 200), 10_000_000),
        "freq_is_valid": np.ones((1, 200), dtype=int),
    }
    tally = tally_switched(rig, out, np.array([10.0]), np.array([20.0]), np.array([100]))
    assert (tally.wrong, tally.wrong_late) == (100, 69)
    assert tally.wrong_pct == 50.0


# Signals


def test_noise_follows_the_ratio_and_the_tick_rate() -> None:
    assert noise_rms(1.0, 20.0, 1000) == pytest.approx(0.1 / np.sqrt(2.0))
    assert noise_rms(1.0, 20.0, 4000) == pytest.approx(0.2 / np.sqrt(2.0))


def test_tone_has_its_phase_at_its_tick() -> None:
    values = tone(np.array([25.0]), np.array([0.7]), np.array([30]), 100, 1000)[0]
    assert values[30] == pytest.approx(np.cos(0.7))
    assert values[40] == pytest.approx(np.cos(0.7 + np.pi / 2.0))


def test_neighbour_is_30_percent_away_inside_the_band() -> None:
    freq_Hz = np.array([1.1, 45.0, *np.full(50, 10.0)])
    near_Hz = neighbour_Hz(freq_Hz, (1.0, 50.0), generator(1, "neighbour"))
    assert near_Hz[:2] == pytest.approx([1.43, 45.0 / 1.3])
    assert set(np.round(near_Hz[2:], 6)) == {13.0, round(10.0 / 1.3, 6)}


@pytest.mark.parametrize("kind", list(truth.KINDS))
def test_truth_table_s_first_component_is_the_one_to_report(kind) -> None:
    cases = truth.KINDS[kind](generator(5, kind), 200)
    first, second = cases.freq_Hz.T
    displacement = cases.amplitude_m_s2 / cases.freq_Hz**2
    assert len(first) == 200
    if kind == "drift and a tone":
        assert (second <= 0.6).all() and (first >= 2.0).all()
        return
    share = cases.amplitude_m_s2[:, 0] ** 2 / (cases.amplitude_m_s2**2).sum(axis=1)
    is_strongest = share >= 0.65
    is_farthest = displacement[:, 0] >= 1.2 * displacement[:, 1]
    if kind == "f and 3f":
        assert is_farthest.all()
        assert second == pytest.approx(3.0 * first)
        assert (cases.amplitude_m_s2[:, 1] > cases.amplitude_m_s2[:, 0]).any()
    else:
        assert (is_strongest | (is_farthest & (np.abs(share - 0.5) <= 0.05))).all()
        assert is_strongest.any() and not is_strongest.all()
        assert (np.abs(first - second) >= 3.0).all()
        assert (first > second).any() and (first < second).any()


# The RMS


def test_conditioning_removes_gravity_and_keeps_the_band() -> None:
    params = {
        "accel_polarity": -1, "accel_scale_nm_s2": 57751, "accel_offset_counts": 1000,
        "accel_full_scale_counts": 8388607, "dc_cutoff_mHz": 200, "tick_rate_Hz": 1000,
    }  # fmt: skip
    ticks = 20000
    accel = 9.81 + tone(np.array([1.0, 10.0]), np.zeros(2), 0, ticks, 1000)
    rest = conditioned(own_sensor(params).counts(accel), params)[:, ticks // 2 :]
    gain = np.sqrt(2.0 * np.mean(np.square(rest), axis=1))
    assert gain == pytest.approx([1.0 / np.hypot(1.0, 0.2), 1.0], abs=2e-3)
    assert np.abs(rest.mean(axis=1)).max() < 2e-3


def test_windowed_rms_is_over_whole_blocks() -> None:
    values = np.arange(70, dtype=float)[None, :]
    found = windowed_rms(values, block_ticks=10, window_blocks=3)[0]
    assert len(found) == 5
    assert found[0] == pytest.approx(np.sqrt(np.mean(np.arange(30.0) ** 2)))
    assert found[4] == pytest.approx(np.sqrt(np.mean(np.arange(40.0, 70.0) ** 2)))


def test_firmware_s_rms_is_the_float_s(rig: Rig) -> None:
    steady = response.measure_steady(rig, seed=1, trials=4, snr_dB=20)
    assert 0.0 < steady.rms_error < 1e-4


# Records through the firmware


def test_records_do_not_know_of_each_other(rig: Rig) -> None:
    rng = generator(9, "records")
    accel = with_noise(tone(np.array([5.0, 17.0, 30.0]), np.zeros(3), 0, 700, 1000), 0.05, rng)
    together = rig.run(accel, ("rms_um_s2", "accel_um_s2"))
    for i in range(3):
        alone = rig.run(accel[i : i + 1], ("rms_um_s2", "accel_um_s2"))
        for name, values in alone.items():
            assert np.array_equal(values[0], together[name][i])
    assert together["rms_um_s2"].shape == (3, 700)


def test_missing_samples_and_chosen_ticks_reach_the_firmware(rig: Rig) -> None:
    accel = with_noise(np.zeros((1, 100)), 0.05, generator(2, "missing"))
    missing = np.zeros((1, 100), dtype=bool)
    missing[0, 40:45] = True
    out = rig.run(accel, ("bad_sample_count", "tick"), missing, from_tick=39, every=3)
    assert np.diff(out["tick"][0]).tolist() == [3] * 20
    assert out["bad_sample_count"][0, :3].tolist() == [0, 3, 5]


# The command


@pytest.fixture
def bench(
    build: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
):
    """`./tools/benchmark signal` on a tiny budget: exit code and what it printed."""
    monkeypatch.setenv("QUIESCE_BUILD", str(build))
    monkeypatch.setattr(benchmark, "QUICK", TINY)
    monkeypatch.chdir(tmp_path)

    def run(*options: str) -> tuple[int, str]:
        code = main(["signal", "--quick", "--no-cost", "--out", "out", *options])
        return code, capsys.readouterr().out

    return run


@pytest.mark.slow
def test_command_prints_every_figure_and_writes_plots(bench, tmp_path: Path) -> None:
    code, printed = bench("--json", "--check")
    report = json.loads(printed)
    assert report["bench"] == "signal"
    assert [figure["name"] for figure in report["figures"]] == FIGURES
    oks = [figure["ok"] for figure in report["figures"]]
    assert code == (1 if False in oks else 3)
    for figure in report["figures"][:13]:
        assert isinstance(figure["value"], float) and figure["goal"] is not None, figure
    for figure in report["figures"][14:]:
        assert figure["value"] is None, figure
    assert any("--no-cost" in line for line in report["context"]["absent"])
    assert len(report["context"]["accuracy"]) == 28
    assert report["context"]["valid_but_wrong"]["accuracy"]["ticks"] > 300_000
    assert json.loads((tmp_path / "out/signal.json").read_text()) == report
    for name in ("accuracy", "step_response", "truth_table"):
        assert "<svg" in (tmp_path / f"out/{name}.svg").read_text()


@pytest.mark.slow
def test_command_prints_tables_and_depends_on_the_seed_alone(bench, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    options = ("--data", "empty", "--seed")
    first, again, other = (bench(*options, seed)[1] for seed in ("7", "7", "8"))
    assert first == again != other
    for words in ("freq_rmse_over_crlb_max", "steps at 20 dB", "flat tops", "written    out/"):
        assert words in first


@pytest.mark.slow
def test_absent_recordings_are_not_a_met_goal(bench, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    report = json.loads(bench("--json", "--data", "empty")[1])
    sweep = next(f for f in report["figures"] if f["name"] == "sweep_within_0p12Hz_pct")
    assert sweep["value"] is None and sweep["ok"] is None and sweep["goal"] == 99.0
    lines = report["context"]["absent"]
    assert sum("not on this machine" in line for line in lines) == len(recorded.SOURCES)
    assert report["context"]["recordings"] == []


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], ["NAME"]),
        (["noise"], ["noise", "signal"]),
        (["signal", "--seed", "many"], ["--seed"]),
        (["signal", "--seed", "-1"], ["--seed"]),
        (["signal", "--set", "track_snr_dB=200"], ["track_snr_dB"]),
        (["signal", "--set", "colour=1"], ["colour", "quiesce params"]),
        (["signal", "--set", "tick_rate_Hz"], ["NAME=VALUE"]),
        (["signal", "--data", "nowhere"], ["--data nowhere", "no such folder"]),
        (["signal", "--fast"], ["--fast"]),
        (["signal", "--out", "file/below"], ["file"]),
    ],
)
def test_bad_input_is_one_line(refused, tmp_path: Path, options, words) -> None:
    (tmp_path / "file").touch()
    message = refused("bench", *options)
    for word in words:
        assert word in message
