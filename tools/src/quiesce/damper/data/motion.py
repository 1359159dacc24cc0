"""Displacement, velocity and acceleration from what was measured; zero phase throughout."""

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.signal import butter, sosfilt, sosfilt_zi

from quiesce.resample import extend_odd

ORDER = 4
# Samples beyond each end, in periods of the cut-off: the filter has forgotten its start by then.
_LEAD_PERIODS = 4.0
# The edge's parabola is fitted over this many periods of the cut-off, and at least these rows.
_EDGE_PERIODS = 1.0
_EDGE_ROWS = 6


def continued(values: np.ndarray, count: int, edge_rows: int) -> np.ndarray:
    """`count` samples more at each end: the parabola through the first `edge_rows` samples goes
    on, and what is left over it is mirrored oddly. Slope and curvature have no step."""
    count = min(count, len(values) - 1)
    head = _before(values, count, edge_rows)
    tail = _before(values[::-1], count, edge_rows)[::-1]
    return np.concatenate([head, values, tail])


def _before(values: np.ndarray, count: int, edge_rows: int) -> np.ndarray:
    rows = min(max(edge_rows, _EDGE_ROWS), len(values))
    # Scaled to 1 over the edge, for a fit that is well conditioned at any length.
    inner = np.arange(rows) / rows
    parabola = np.polynomial.polynomial.polyfit(inner, values[:rows], 2)
    ahead = np.arange(1, count + 1) / rows
    trend = np.polynomial.polynomial.polyval
    mirrored = trend(-ahead, parabola) - (values[1 : count + 1] - trend(ahead, parabola))
    return mirrored[::-1]


def _both_ways(sos: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Each pass starts settled at the value that it meets first."""
    for _ in range(2):
        values = sosfilt(sos, values, zi=sosfilt_zi(sos) * values[0])[0][::-1]
    return values


def low_passed(values: np.ndarray, rate_Hz: float, corner_Hz: float) -> np.ndarray:
    """Butterworth of 4th order run forth and back: -6 dB at the corner, no delay."""
    period = rate_Hz / corner_Hz
    count = min(int(np.ceil(_LEAD_PERIODS * period)) + 8, len(values) - 1)
    longer = continued(values, count, int(np.ceil(_EDGE_PERIODS * period)))
    sos = butter(ORDER, corner_Hz, fs=rate_Hz, output="sos")
    return _both_ways(sos, longer)[count : count + len(values)]


def derivatives(values: np.ndarray, rate_Hz: float) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative of the spline of 5th order through the samples."""
    time_s = np.arange(len(values)) / rate_Hz
    spline = make_interp_spline(time_s, values, k=5)
    return spline.derivative(1)(time_s), spline.derivative(2)(time_s)


def integrated(velocity_m_s: np.ndarray, rate_Hz: float, corner_Hz: float) -> np.ndarray:
    """Displacement from velocity: its spline's integral, slow drift below `corner_Hz` taken out
    (Butterworth high-pass of 2nd order run forth and back)."""
    time_s = np.arange(len(velocity_m_s)) / rate_Hz
    velocity_m_s = velocity_m_s - velocity_m_s.mean()
    disp_m = make_interp_spline(time_s, velocity_m_s, k=3).antiderivative()(time_s)
    disp_m = disp_m - np.polynomial.Polynomial.fit(time_s, disp_m, 1)(time_s)
    count = len(disp_m) - 1
    longer = extend_odd(disp_m, count)
    sos = butter(2, corner_Hz, btype="highpass", fs=rate_Hz, output="sos")
    return _both_ways(sos, longer)[count : count + len(disp_m)]
