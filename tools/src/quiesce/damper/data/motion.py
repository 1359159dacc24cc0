"""Displacement, velocity and acceleration from what was measured; zero phase throughout.

Filters are solved for over the whole record, not run along it, so that the ends are free: inside,
the gain is that of a Butterworth filter run forth and back, 1 / (1 + (f / f_corner)^(2 order)); at
the ends no continuation of the record is assumed, and polynomials below the order pass unchanged.
"""

import numpy as np

ORDER = 4
# The equations are well conditioned up to this many samples a period of the corner; above it, they
# are solved on fewer samples, after a filter whose own corner is far above.
_MOST_A_PERIOD = 50.0
_SOLVED_A_PERIOD = 25.0
_AHEAD_OF_CORNER = 8.0
# Slow drift is found from means over this part of the corner's period.
_MEANS_A_PERIOD = 20.0


def free_end_filter(values: np.ndarray, corner: float, order: int) -> np.ndarray:
    """Low-pass of `values`; `corner` in cycles a sample, below 0.5.

    Minimises |S (y - x)|^2 + weight |D y|^2 over y, with S and D the sums and the differences of
    `order` + 1 neighbours: the bilinear Butterworth response squared.
    """
    from scipy.linalg import solveh_banded

    order = min(order, len(values) - 1)
    weight = np.tan(np.pi * corner) ** (-2 * order)
    sums = _squared(_weights(order, 1.0), len(values))
    differences = _squared(_weights(order, -1.0), len(values))
    return solveh_banded(sums + weight * differences, _times(sums, values), lower=True)


def _weights(order: int, sign: float) -> np.ndarray:
    """Coefficients of (1 + sign z)^order."""
    out = np.ones(1)
    for _ in range(order):
        out = np.convolve(out, [1.0, sign])
    return out


def _squared(weights: np.ndarray, count: int) -> np.ndarray:
    """W'W in lower banded form, W with `weights` in each of its rows."""
    width = len(weights)
    rows = count - width + 1
    bands = np.zeros((width, count))
    for i in range(width):
        for j in range(i, width):
            bands[j - i, i : i + rows] += weights[i] * weights[j]
    return bands


def _times(bands: np.ndarray, values: np.ndarray) -> np.ndarray:
    """A symmetric matrix in lower banded form times a vector."""
    out = bands[0] * values
    for k in range(1, len(bands)):
        out[k:] += bands[k, :-k] * values[:-k]
        out[:-k] += bands[k, :-k] * values[k:]
    return out


def low_passed(values: np.ndarray, rate_Hz: float, corner_Hz: float) -> np.ndarray:
    """Butterworth of 4th order forth and back: half the amplitude at the corner, no delay."""
    from scipy.interpolate import make_interp_spline
    from scipy.signal import butter, sosfiltfilt

    if rate_Hz <= _MOST_A_PERIOD * corner_Hz:
        return free_end_filter(values, corner_Hz / rate_Hz, ORDER)
    step = int(rate_Hz / (_SOLVED_A_PERIOD * corner_Hz))
    sos = butter(ORDER, _AHEAD_OF_CORNER * corner_Hz, fs=rate_Hz, output="sos")
    pad = min(len(values) - 1, int(4.0 * rate_Hz / (_AHEAD_OF_CORNER * corner_Hz)))
    smooth = sosfiltfilt(sos, values, padlen=pad)
    index = np.arange(len(values))
    few = free_end_filter(smooth[::step], corner_Hz * step / rate_Hz, ORDER)
    return make_interp_spline(index[::step], few, k=5)(index)


def derivatives(values: np.ndarray, rate_Hz: float) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative of the spline of 5th order through the samples."""
    from scipy.interpolate import make_interp_spline

    time_s = np.arange(len(values)) / rate_Hz
    spline = make_interp_spline(time_s, values, k=5)
    return spline.derivative(1)(time_s), spline.derivative(2)(time_s)


def integrated(velocity_m_s: np.ndarray, rate_Hz: float, corner_Hz: float) -> np.ndarray:
    """Displacement from velocity: the integral of its cubic spline, less what is slower than
    `corner_Hz` (2nd order, forth and back)."""
    from scipy.interpolate import make_interp_spline

    time_s = np.arange(len(velocity_m_s)) / rate_Hz
    disp_m = make_interp_spline(time_s, velocity_m_s, k=3).antiderivative()(time_s)
    disp_m = disp_m - np.polynomial.Polynomial.fit(time_s, disp_m, 1)(time_s)
    return disp_m - slow_part(disp_m, rate_Hz, corner_Hz)


def slow_part(values: np.ndarray, rate_Hz: float, corner_Hz: float) -> np.ndarray:
    from scipy.interpolate import make_interp_spline

    size = max(1, int(rate_Hz / (_MEANS_A_PERIOD * corner_Hz)))
    count = len(values) // size
    means = values[: count * size].reshape(count, size).mean(axis=1)
    middles = (np.arange(count) + 0.5) * size - 0.5
    slow = free_end_filter(means, corner_Hz * size / rate_Hz, 2)
    return make_interp_spline(middles, slow, k=3)(np.arange(len(values)))
