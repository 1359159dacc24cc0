"""What `./tools/benchmark control` derives from figures and traces. Pure; times in s."""

from collections.abc import Sequence

import numpy as np

CONVERGED = 0.02  # share of the final amplitude
SECOND_s = 1.0
SETTLED_SECONDS = 10  # amplitudes are averaged over so many


def reduction_pct(value: float, open_loop: float) -> float:
    """Against 0 A; negative is worse."""
    return 100.0 * (1.0 - value / open_loop)


def fraction_of(reduction: float, bound: float) -> float:
    """Share of what is attainable; 1 where nothing is and nothing is lost."""
    if bound <= 0.0:
        return 1.0 if reduction >= bound else 0.0
    return reduction / bound


def half_peaks(values: np.ndarray, cycles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Half peak-to-peak of each whole cycle.

    values: n samples; cycles: n, the excitation's phase in turns, rising, from a whole number at
    the first sample on. Returns whole cycle numbers (m,) and the half peak-to-peak values (m,).
    A cycle counts where samples before and after it exist.
    """
    number = np.floor(cycles + 1e-9).astype(int)
    starts = np.flatnonzero(np.diff(number)) + 1
    starts = np.concatenate([[0], starts])
    high = np.maximum.reduceat(values, starts)
    low = np.minimum.reduceat(values, starts)
    return number[starts][:-1], 0.5 * (high - low)[:-1]


def second_amplitudes(time_s: np.ndarray, values: np.ndarray, freq_Hz: float) -> np.ndarray:
    """Mean half peak-to-peak of the cycles that begin in each second of a sine. From time 0."""
    numbers, peaks = half_peaks(values, time_s * freq_Hz)
    second = np.floor((numbers + 1e-9) / freq_Hz / SECOND_s).astype(int)
    count = np.bincount(second)
    sums = np.bincount(second, weights=peaks)
    return sums[count > 0] / count[count > 0]


def converge_s(amplitudes: np.ndarray, within: float = CONVERGED) -> float:
    """Time from which the amplitude is within a share of its final value, or below.

    amplitudes: of each second. Over 10 s from that time on, and any later time, so that a trial of
    the adaptation, which lasts one or two, is not taken for what it has reached.
    """
    seconds = min(SETTLED_SECONDS, len(amplitudes))
    means = np.convolve(amplitudes, np.full(seconds, 1.0 / seconds), mode="valid")
    late = np.flatnonzero(means > (1.0 + within) * means[-1])
    return float(late[-1] + 1) * SECOND_s if late.size else 0.0


def dither_loss_pct(amplitudes: np.ndarray, open_loop: float) -> float:
    """What trying costs: mean of the last seconds over the best tenth of them, in % of 0 A's
    amplitude, that is in points of reduction."""
    last = amplitudes[-3 * SETTLED_SECONDS :]
    return 100.0 * float(last.mean() - np.quantile(last, 0.1)) / open_loop


def chirp_peaks(
    time_s: np.ndarray, values: np.ndarray, from_Hz: float, slope_Hz_s: float
) -> tuple[np.ndarray, np.ndarray]:
    """Frequency in the middle of each cycle of a linear chirp, and its half peak-to-peak."""
    cycles = (from_Hz + 0.5 * slope_Hz_s * time_s) * time_s
    numbers, peaks = half_peaks(values, cycles)
    # f at phase n + 1/2: f^2 = f0^2 + 2 slope (n + 1/2)
    freq_Hz = np.sqrt(from_Hz**2 + 2.0 * slope_Hz_s * (numbers + 0.5))
    return freq_Hz, peaks


def band_reduction_pct(
    freq_Hz: np.ndarray, peaks: np.ndarray, open_loop: np.ndarray, band_Hz: tuple[float, float]
) -> float:
    """Reduction of the mean half peak-to-peak over the cycles inside a band."""
    inside = (freq_Hz >= band_Hz[0]) & (freq_Hz <= band_Hz[1])
    return reduction_pct(float(peaks[inside].mean()), float(open_loop[inside].mean()))


def band_bound_pct(
    freq_Hz: np.ndarray,
    open_loop: np.ndarray,
    band_Hz: tuple[float, float],
    bound_Hz: Sequence[float],
    bound_pct: Sequence[float],
) -> float:
    """The same of amplitudes that are lower than open loop by the interpolated bound, cycle by
    cycle."""
    at_bound = open_loop * (1.0 - 0.01 * np.interp(freq_Hz, bound_Hz, bound_pct))
    return band_reduction_pct(freq_Hz, at_bound, open_loop, band_Hz)
