"""Resampling against signals whose samples are known at any time."""

import numpy as np
import pytest
from quiesce.signal.resample import PASS, resample

EDGE_s = 0.5


def sine(rate_Hz: float, freq_Hz: float, duration_s: float = 4.0) -> np.ndarray:
    return np.sin(2.0 * np.pi * freq_Hz * np.arange(int(duration_s * rate_Hz)) / rate_Hz + 0.3)


def inner_error(rate_Hz: float, new_rate_Hz: float, freq_Hz: float) -> float:
    """Largest error of a sine after resampling, away from the ends."""
    got = resample(sine(rate_Hz, freq_Hz), rate_Hz, new_rate_Hz)
    expected = np.sin(2.0 * np.pi * freq_Hz * np.arange(len(got)) / new_rate_Hz + 0.3)
    edge = int(EDGE_s * new_rate_Hz)
    return float(np.abs(got - expected)[edge:-edge].max())


@pytest.mark.parametrize("rate_Hz", [100.0, 400.0, 639.4, 2557.5, 10000.0])
@pytest.mark.parametrize("new_rate_Hz", [500.0, 1000.0, 4000.0])
@pytest.mark.parametrize("share", [0.03, 0.4, 0.98])
def test_resample_in_band_is_exact_without_delay(rate_Hz, new_rate_Hz, share) -> None:
    freq_Hz = share * PASS * min(rate_Hz, new_rate_Hz) / 2.0
    assert inner_error(rate_Hz, new_rate_Hz, freq_Hz) < 1e-4


@pytest.mark.parametrize("freq_Hz", [505.0, 700.0, 900.0, 1240.0])
def test_resample_down_leaves_no_alias(freq_Hz) -> None:
    got = resample(sine(2557.5, freq_Hz), 2557.5, 1000.0)
    assert np.abs(got[500:-500]).max() < 1e-4


def test_resample_up_leaves_no_image() -> None:
    got = resample(sine(100.0, 30.0), 100.0, 1000.0)[500:-500]
    spectrum = np.abs(np.fft.rfft(got * np.hanning(len(got))))
    freq_Hz = np.fft.rfftfreq(len(got), 1e-3)
    assert spectrum[freq_Hz > 60.0].max() < 1e-4 * spectrum.max()


def test_resample_constant_stays_constant_to_the_ends() -> None:
    assert np.abs(resample(np.full(300, 9.81), 100.0, 1000.0) - 9.81).max() < 1e-3


def test_resample_same_rate_is_the_same() -> None:
    values = sine(1000.0, 12.0)
    assert np.array_equal(resample(values, 1000.0, 1000.0), values)


@pytest.mark.parametrize(("rows", "rate_Hz"), [(3, 100.0), (10, 639.4), (5000, 2000.0)])
def test_resample_spans_the_same_time(rows, rate_Hz) -> None:
    count = len(resample(np.zeros(rows), rate_Hz, 1000.0))
    assert 0 <= (rows - 1) / rate_Hz - (count - 1) / 1000.0 < 1e-3
