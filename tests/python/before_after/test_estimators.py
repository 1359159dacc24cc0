"""Each estimator of a report against closed forms, scipy, and what its interval promises."""

import math

import numpy as np
import pytest
from quiesce.before_after import levels, thirds
from quiesce.before_after.integrate import gain, integrated
from quiesce.before_after.response import answer_rms, response, segments
from quiesce.before_after.sampling import Stamps, even
from quiesce.compare.zones import machines
from scipy import signal, stats

RATE_Hz = 500.0
TRIALS = 200
# So many of TRIALS intervals of 95 % hold the truth in all but one of ten thousand draws; more are
# no harm.
LEAST_COVERED = stats.binom.ppf(1e-4, TRIALS, 0.95)


def tone(freq_Hz: float, duration_s: float, phase: float = 0.3, rate_Hz: float = RATE_Hz):
    return np.cos(2 * np.pi * freq_Hz * np.arange(round(duration_s * rate_Hz)) / rate_Hz + phase)


def resonance(freq_Hz: float, damping: float) -> tuple[list[float], list[float]]:
    """Two poles, for scipy's lfilter at RATE_Hz."""
    pole = np.exp((-damping + 1j) * 2 * np.pi * freq_Hz / RATE_Hz)
    return [abs(1 - pole) ** 2], [1.0, -2 * pole.real, abs(pole) ** 2]


def shaken(rng: np.random.Generator, count: int, size: float, damping: float = 0.05) -> np.ndarray:
    """A resonance at 12 Hz under white noise, without its start."""
    return (
        size * signal.lfilter(*resonance(12.0, damping), rng.standard_normal(count + 5000))[5000:]
    )


# RMS, peaks, shape


def test_figures_of_a_sine_are_those_of_the_book() -> None:
    sine = 3.0 * tone(25.0, 20.0)
    assert levels.rms(sine).value == pytest.approx(3.0 / math.sqrt(2.0), rel=1e-9)
    assert levels.peak(sine) == pytest.approx(3.0, rel=2e-3)
    assert levels.crest(sine) == pytest.approx(math.sqrt(2.0), rel=2e-3)
    assert levels.kurtosis(sine) == pytest.approx(1.5, rel=1e-6)
    low, high = levels.rms(sine).interval()
    assert (high - low) / 3.0 < 1e-3
    assert levels.unsteady(sine) == []


def test_figures_of_noise_are_scipys() -> None:
    noise = np.random.default_rng(1).standard_normal(20_000)
    noise -= noise.mean()
    assert levels.rms(noise).value == pytest.approx(noise.std(), rel=1e-12)
    assert levels.kurtosis(noise) == pytest.approx(stats.kurtosis(noise, fisher=False), rel=1e-12)
    peaks = np.abs(noise).reshape(20, -1).max(axis=1)
    both = levels.typical_peaks(noise, np.concatenate([noise, noise]))
    assert [one.value for one in both] == pytest.approx([stats.gmean(peaks)] * 2, rel=1e-12)
    assert both[1].freedom == 39.0


def test_error_of_white_noise_is_that_of_its_degrees_of_freedom() -> None:
    """ln RMS of n independent Gaussian values has a standard deviation of 1 / sqrt(2 n)."""
    rng = np.random.default_rng(2)
    errors = [levels.rms(rng.standard_normal(8000)).error ** 2 for _ in range(200)]
    assert math.sqrt(np.mean(errors)) == pytest.approx(1.0 / math.sqrt(2 * 8000), rel=0.1)


@pytest.mark.parametrize("damping", [1.0, 0.05, 0.02])
def test_interval_of_a_ratio_holds_what_is_true(damping: float) -> None:
    rng = np.random.default_rng(3)
    covered = 0
    for _ in range(TRIALS):
        one, other = (levels.rms(shaken(rng, 20_000, size, damping)) for size in (1.0, 0.6))
        found = levels.ratio(one, other)
        covered += found.low <= 0.6 <= found.high
    assert covered >= LEAST_COVERED


def test_interval_of_a_typical_peak_holds_what_is_true() -> None:
    rng = np.random.default_rng(4)
    covered = 0
    for _ in range(TRIALS):
        records = shaken(rng, 20_000, 1.0), shaken(rng, 30_000, 0.6)
        found = levels.ratio(*levels.typical_peaks(*records))
        covered += found.low <= 0.6 <= found.high
    assert covered >= LEAST_COVERED


def test_what_is_not_stationary_is_told_and_noise_is_not() -> None:
    rng = np.random.default_rng(5)
    steady = [levels.unsteady(shaken(rng, 40_000, 1.0)) for _ in range(50)]
    assert sum(map(bool, steady)) <= 2
    noise = shaken(rng, 40_000, 1.0)
    assert "grows" in levels.unsteady(noise * np.linspace(0.5, 1.5, len(noise)))[0]
    assert "fades" in levels.unsteady(noise * np.linspace(1.5, 0.5, len(noise)))[0]
    assert levels.unsteady(tone(12.0, 40.0) * np.linspace(1.0, 1.01, 20_000)) == []
    burst = noise * (1.0 + 5.0 * (np.abs(np.arange(len(noise)) - 20_000) < 2000))
    assert "strongest twentieth" in levels.unsteady(burst)[0]
    narrow = shaken(rng, 10_000, 1.0, damping=0.003)
    assert "short for its narrow spectrum" in levels.unsteady(narrow)[0]


# Integration


@pytest.mark.parametrize("times", [0, 1, 2])
@pytest.mark.parametrize("freq_Hz", [2.3, 11.0, 73.0])
def test_integrals_of_a_tone_are_exact(times: int, freq_Hz: float) -> None:
    for phase in np.linspace(0.0, 2 * np.pi, 7):
        moved = integrated(5.0 + tone(freq_Hz, 30.0, phase), RATE_Hz, times, 1.0, 200.0)
        amplitude = gain(np.array([freq_Hz]), 1.0, 200.0)[0] / (2 * np.pi * freq_Hz) ** times
        assert levels.rms(moved).value == pytest.approx(amplitude / math.sqrt(2.0), rel=3e-3)
        assert levels.peak(moved) == pytest.approx(amplitude, rel=2e-2)


def test_filters_are_butterworths() -> None:
    b, a = signal.butter(4, 2 * np.pi * 2.0, "highpass", analog=True)
    d, c = signal.butter(4, 2 * np.pi * 80.0, "lowpass", analog=True)
    freq_Hz = np.array([0.5, 1.0, 2.0, 10.0, 80.0, 200.0])
    both = [signal.freqs(*one, 2 * np.pi * freq_Hz)[1] for one in ((b, a), (d, c))]
    assert gain(freq_Hz, 2.0, 80.0) == pytest.approx(np.abs(both[0] * both[1]), rel=1e-9)


def test_integral_of_noise_is_the_trapezoids() -> None:
    """An independent way: scipy's own filters and sums of trapezoids, far below the rate."""
    noise = signal.sosfilt(
        signal.butter(4, [4.0, 20.0], "bandpass", fs=RATE_Hz, output="sos"),
        np.random.default_rng(6).standard_normal(30_000),
    )
    velocity = np.concatenate([[0.0], np.cumsum((noise[1:] + noise[:-1]) / (2 * RATE_Hz))])
    kept = slice(1000, -1000)
    ours = integrated(noise, RATE_Hz, 1, 1.0, 200.0)
    assert len(ours) == len(noise[kept])
    assert np.std(ours) == pytest.approx(np.std(velocity[kept]), rel=5e-3)


# Third octaves


def test_mid_bands_are_those_of_iec_61260_1() -> None:
    """Base ten: every third band is a power of 10^(3/10), every tenth one a decade."""
    assert [thirds.nominal_Hz(i) for i in range(-3, 4)] == [500, 630, 800, 1000, 1250, 1600, 2000]
    assert thirds.nominal_Hz(-15) == 31.5 and thirds.nominal_Hz(-30) == 1.0
    assert thirds.mid_Hz(-10) == pytest.approx(100.0, rel=1e-12)
    assert thirds.mid_Hz(1) == pytest.approx(1258.9254117941673, rel=1e-12)
    for index in range(-30, 10):
        low, high = thirds.edges_Hz(index)
        assert high == pytest.approx(thirds.edges_Hz(index + 1)[0], rel=1e-12)
        assert math.sqrt(low * high) == pytest.approx(thirds.mid_Hz(index), rel=1e-12)
        assert thirds.mid_Hz(index) == pytest.approx(thirds.nominal_Hz(index), rel=0.02)


def test_bands_are_inside_the_band_and_wide_enough_for_the_record() -> None:
    found = thirds.bands(1.0, 100.0, 1000.0)
    assert found == list(range(min(found), max(found) + 1))
    assert thirds.edges_Hz(found[0])[0] >= 1.0 > thirds.edges_Hz(found[0] - 1)[0]
    assert thirds.edges_Hz(found[-1])[1] <= 100.0 < thirds.edges_Hz(found[-1] + 1)[1]
    assert thirds.bands(1.0, 100.0, 10.0)[0] > found[0]


@pytest.mark.parametrize("index", [-22, -15, -10])
def test_a_tone_is_all_in_its_band(index: int) -> None:
    found = thirds.levels(2.0 * tone(thirds.mid_Hz(index), 60.0), RATE_Hz, 1.0, 200.0)
    assert found[index].value == pytest.approx(math.sqrt(2.0), rel=1e-3)
    # 10^(3/10) away, three bands: Butterworth's 1 / (1 + (q (G - 1/G))^6), q of six poles.
    assert found[index - 3].value < 0.02 * found[index].value
    edge = thirds.edges_Hz(index)[1]
    found = thirds.levels(tone(edge, 60.0), RATE_Hz, 1.0, 200.0)
    assert 2.0 < -20 * math.log10(found[index].value * math.sqrt(2.0)) < 4.0


def test_noise_bandwidth_is_the_bands_width() -> None:
    freq_Hz = np.linspace(0.01, 5000.0, 500_000)
    for index in (-15, -8):
        low, high = thirds.edges_Hz(index)
        width = np.trapezoid(thirds.power_gain(freq_Hz, index), freq_Hz)
        assert width == pytest.approx(high - low, rel=1e-4)


def test_white_noise_has_its_density_times_the_width() -> None:
    rng = np.random.default_rng(7)
    runs = [thirds.levels(rng.standard_normal(30_000), RATE_Hz, 1.0, 200.0) for _ in range(20)]
    for index in runs[0]:
        low, high = thirds.edges_Hz(index)
        power = np.mean([one[index].value ** 2 for one in runs])
        sigmas = 1.0 / math.sqrt(20 * thirds.bandwidth_time(index, 56.0))
        assert power == pytest.approx(2.0 / RATE_Hz * (high - low), rel=5.0 * sigmas)


@pytest.mark.slow
def test_interval_of_a_bands_ratio_holds_what_is_true() -> None:
    rng = np.random.default_rng(8)
    covered: dict[int, int] = {}
    for _ in range(TRIALS):
        one, other = (
            thirds.levels(size * rng.standard_normal(10_000), RATE_Hz, 2.0, 100.0)
            for size in (1.0, 0.7)
        )
        for index in one:
            found = levels.ratio(one[index], other[index])
            covered[index] = covered.get(index, 0) + (found.low <= 0.7 <= found.high)
    assert len(covered) > 8 and min(covered.values()) >= LEAST_COVERED


# Spectra and transmissibility


def pair(rng: np.random.Generator, count: int = 30_000, noise: float = 0.5, size: float = 1.0):
    """White input, the resonance's answer and noise beside it."""
    x = size * rng.standard_normal(count)
    y = signal.lfilter(*resonance(12.0, 0.05), x) + noise * rng.standard_normal(count)
    return x, y


def test_spectra_are_scipys() -> None:
    x, y = pair(np.random.default_rng(9))
    size = 1000
    known = {"fs": RATE_Hz, "window": "hann", "nperseg": size, "noverlap": size // 2}
    one, other = segments(x, RATE_Hz, size), segments(y, RATE_Hz, size)
    freq_Hz, density = signal.welch(x, **known)
    assert one.freq_Hz == pytest.approx(freq_Hz)
    assert one.density() == pytest.approx(density, rel=1e-9, abs=1e-15)
    found = response(one, other)
    cross = signal.csd(x, y, **known)[1]
    inner = slice(1, None)  # at 0 Hz there is nothing but rounding
    assert found.h1[inner] == pytest.approx((cross / density)[inner], rel=1e-9)
    other_density = signal.welch(y, **known)[1]
    assert np.abs(found.h2)[inner] == pytest.approx(
        (other_density / np.abs(cross))[inner], rel=1e-9
    )
    assert found.coherence[inner] == pytest.approx(signal.coherence(x, y, **known)[1][inner])


def test_density_of_a_tone_is_its_power() -> None:
    one = segments(3.0 * tone(40.0, 60.0), RATE_Hz, 1000)
    assert one.density().sum() * one.freq_Hz[1] == pytest.approx(4.5, rel=1e-3)


def test_circle_around_h1_holds_what_is_true() -> None:
    x, y = pair(np.random.default_rng(10), 200_000)
    found = response(segments(x, RATE_Hz, 1000), segments(y, RATE_Hz, 1000))
    b, a = resonance(12.0, 0.05)
    _, true = signal.freqz(b, a, found.freq_Hz, fs=RATE_Hz)
    inside = (found.freq_Hz > 20.0) & (found.freq_Hz < 200.0)  # where it is smooth: no bias
    covered = np.mean(np.abs(found.h1 - true)[inside] <= found.reach[inside])
    assert 0.90 < covered <= 1.0


def test_coherence_of_chance_is_exceeded_in_one_of_twenty() -> None:
    rng = np.random.default_rng(11)
    one, other = (segments(rng.standard_normal(400_000), RATE_Hz, 1000) for _ in range(2))
    found = response(one, other)
    assert np.mean(found.coherence[5:-5] > found.chance_coherence) == pytest.approx(0.05, abs=0.03)


@pytest.mark.slow
def test_ratio_under_the_same_input_does_not_know_the_input() -> None:
    """The answer halved, the input doubled: RMS says nothing, the normalised ratio a half."""
    rng = np.random.default_rng(12)
    covered = 0
    for _ in range(TRIALS):
        before, after = pair(rng, 12_000, 0.1), pair(rng, 12_000, 0.1, size=2.0)
        parts = [[segments(v, RATE_Hz, 500) for v in one] for one in (before, after)]
        freq_Hz = parts[0][0].freq_Hz
        inside = (freq_Hz > 2.0) & (freq_Hz < 100.0)
        density = np.mean([one.density() for one, _ in parts], axis=0)
        halved = parts[1][1].spectra * 0.5
        parts[1][1] = type(parts[1][1])(freq_Hz, halved)
        found = levels.ratio(*(answer_rms(x, y, density, inside) for x, y in parts))
        covered += found.low <= 0.5 <= found.high
    assert covered >= LEAST_COVERED


# Sampling


def stamps(count: int = 2000) -> tuple[np.ndarray, np.ndarray]:
    time_s = np.arange(count) / 100.0
    return time_s, np.sin(2 * np.pi * 3.0 * time_s)


def test_missing_samples_are_filled_and_told() -> None:
    time_s, values = stamps()
    kept = np.ones(len(time_s), bool)
    kept[[300, 301, 900]] = False
    found = even(Stamps("f", time_s[kept], values[kept]))
    assert len(found.values) == 2000 and found.rate_Hz == pytest.approx(100.0)
    assert found.doubts == ["3 of 2000 samples are missing; filled by straight lines"]
    assert found.values[900] == pytest.approx((values[899] + values[901]) / 2)


def test_gaps_cut_and_the_longest_stretch_stays() -> None:
    time_s, values = stamps()
    kept = (time_s < 5.0) | (time_s >= 6.0)
    found = even(Stamps("f", time_s[kept], values[kept]))
    assert found.start_s == pytest.approx(6.0) and found.duration_s == pytest.approx(14.0)
    assert "1 gap of up to 100 samples" in found.doubts[0] and "14 s of 20 s" in found.doubts[0]


def test_drift_jitter_and_clipping_are_told() -> None:
    time_s, values = stamps()
    drifting = time_s + 0.01 * time_s**2 / time_s[-1]
    line = even(Stamps("f", drifting, values)).doubts[0]
    assert "the period at the end differs by +1.8" in line
    rng = np.random.default_rng(13)
    late = time_s + 0.004 * rng.random(len(time_s))
    assert "away from an even grid" in even(Stamps("f", late, values)).doubts[0]
    clipped = np.clip(values, -0.8, 0.8)
    assert "clipped" in even(Stamps("f", time_s, clipped)).doubts[0]
    assert even(Stamps("f", time_s, values)).doubts == []
    rounded = np.round(8.0 * values) / 8.0  # flat tops of a coarse sensor
    assert even(Stamps("f", time_s, rounded)).doubts == []


@pytest.mark.parametrize("step", [1e-6, 1e-3, 1 / 128])
@pytest.mark.parametrize("freq_Hz", [0.5, 3.0, 20.0])
def test_flat_tops_of_a_coarse_sensor_are_not_clipped_and_stops_are(step: float, freq_Hz: float):
    values = tone(freq_Hz, 10.0, rate_Hz=10_000.0)
    time_s = np.arange(len(values)) / 10_000.0
    for held, is_told in ((values, False), (np.clip(values, -0.9, 0.9), True)):
        found = even(Stamps("f", time_s, np.round(held / step) * step))
        assert any("clipped" in line for line in found.doubts) == is_told


# Zones


def test_zones_begin_at_their_boundaries() -> None:
    machine = machines()["medium:rigid"]
    assert machine.boundaries_mm_s == (1.4, 2.8, 4.5)
    found = [machine.zone(v) for v in (0.0, 1.39, 1.4, 2.79, 2.8, 4.49, 4.5, 99.0)]
    assert "".join(found) == "AABBCCDD"
    for one in machines().values():
        assert list(one.boundaries_mm_s) == sorted(one.boundaries_mm_s)
