"""Frequency of a reference sensor, to judge the firmware's estimate by.

Float64: the strongest peak of a trailing Hann window of WINDOW_s, zero-padded, interpolated by a
parabola through the logarithms. Such an estimate describes the middle of its window.
"""

from dataclasses import dataclass

import numpy as np

WINDOW_s = 2.0
PAD = 8
BAND_Hz = (1.0, 50.0)
_CHUNK = 2048


def peak_freq_Hz(power: np.ndarray, bin_Hz: float) -> np.ndarray:
    """Strongest peak of each row inside BAND_Hz."""
    low = max(1, int(np.ceil(BAND_Hz[0] / bin_Hz)))
    high = min(power.shape[1] - 2, int(BAND_Hz[1] / bin_Hz))
    top = low + np.argmax(power[:, low : high + 1], axis=1)
    rows = np.arange(len(power))
    left, middle, right = (np.log(np.maximum(power[rows, top + d], 1e-300)) for d in (-1, 0, 1))
    curve = left - 2.0 * middle + right
    shift = np.where(curve < 0.0, 0.5 * (left - right) / np.where(curve < 0.0, curve, 1.0), 0.0)
    return (top + np.clip(shift, -0.5, 0.5)) * bin_Hz


def reference_freq_Hz(values: np.ndarray, rate_Hz: float) -> tuple[np.ndarray, np.ndarray]:
    """Times of the windows' middles (from the first sample on) and the peak of each window."""
    points = int(round(WINDOW_s * rate_Hz))
    if len(values) < points:
        return np.empty(0), np.empty(0)
    windows = np.lib.stride_tricks.sliding_window_view(values, points)
    hann = np.hanning(points + 1)[:-1]
    padded = 1 << int(np.ceil(np.log2(PAD * points)))
    peaks = []
    for first in range(0, len(windows), _CHUNK):
        block = windows[first : first + _CHUNK]
        block = (block - block.mean(axis=1, keepdims=True)) * hann
        power = np.abs(np.fft.rfft(block, padded, axis=1)) ** 2
        peaks.append(peak_freq_Hz(power, rate_Hz / padded))
    middle_s = (np.arange(len(windows)) + (points - 1) / 2.0) / rate_Hz
    return middle_s, np.concatenate(peaks)


@dataclass(frozen=True)
class Agreement:
    """How often the firmware's frequency agrees with the reference's."""

    updates: int
    valid: int
    within: int  # of the valid ones
    worst_Hz: float  # of the valid ones
    from_s: float
    to_s: float
    tolerance_Hz: float

    @property
    def valid_pct(self) -> float:
        return 100.0 * self.valid / self.updates

    @property
    def within_pct(self) -> float:
        return 100.0 * self.within / self.valid if self.valid else 0.0


def compare(
    described_s: np.ndarray,
    freq_Hz: np.ndarray,
    is_valid: np.ndarray,
    reference_s: np.ndarray,
    reference_Hz: np.ndarray,
    tolerance_Hz: float,
    from_s: float,
    to_s: float,
) -> Agreement:
    """Compares updates with the reference at the instant that each describes.

    described_s: the instant that an update describes (its time less its latency). Updates outside
    the reference's span do not count.
    """
    inside = (described_s >= reference_s[0]) & (described_s <= reference_s[-1])
    error_Hz = np.abs(freq_Hz - np.interp(described_s, reference_s, reference_Hz))[inside]
    valid = is_valid[inside].astype(bool)
    return Agreement(
        updates=int(inside.sum()),
        valid=int(valid.sum()),
        within=int((valid & (error_Hz <= tolerance_Hz)).sum()),
        worst_Hz=float(error_Hz[valid].max()) if valid.any() else 0.0,
        from_s=from_s,
        to_s=to_s,
        tolerance_Hz=tolerance_Hz,
    )
