"""The normalised Bouc-Wen model integrated candidate by candidate with scipy: what a user writes
without this library, and how accurate that is."""

from collections.abc import Callable

import numpy as np
from quiesce.damper.data.record import Record
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline

RTOL = 1e-6
ATOL = 1e-8  # of the state, which stays within -1 .. 1

Speed = Callable[[float], float]


def spline_speed(record: Record) -> Speed:
    """Velocity in m/s at any time: scipy's cubic Hermite spline, as one writes it first."""
    return CubicHermiteSpline(record.time_s, record.velocity_m_s, record.accel_m_s2)


def tuned_speed(record: Record) -> Speed:
    """The same cubic from a table of coefficients, in plain Python: the fastest we found for one
    instant at a time."""
    value, slope = record.velocity_m_s, record.accel_m_s2 / record.rate_Hz
    rise = np.diff(value)
    square = 3.0 * rise - 2.0 * slope[:-1] - slope[1:]
    cube = slope[:-1] + slope[1:] - 2.0 * rise
    table = np.stack([value[:-1], slope[:-1], square, cube], axis=1).tolist()
    last, rate_Hz = len(table) - 1, record.rate_Hz
    start_s = float(record.time_s[0])

    def at(time_s: float) -> float:
        part = (time_s - start_s) * rate_Hz
        index = min(int(part), last)
        part -= index
        a, b, c, d = table[index]
        return a + part * (b + part * (c + part * d))

    return at


def rk45_force(row: np.ndarray, record: Record, speed: Speed) -> tuple[np.ndarray, int]:
    """Forces in N at the samples [n] of a row of the library's normalised_bouc_wen (constant
    parameters), by scipy's RK45 at RTOL and ATOL; and the evaluations of the state's rate."""
    c, k, kw, rho, sigma, n, offset_N = (float(value) for value in row[:7])
    back = 1.0 - 2.0 * sigma

    def rate(time_s: float, state: np.ndarray) -> tuple[float]:
        v, w = speed(time_s), state[0]
        return (rho * v * (1.0 - (back if v * w < 0.0 else 1.0) * abs(w) ** n),)

    span = (record.time_s[0], record.time_s[-1])
    found = solve_ivp(rate, span, [0.0], "RK45", record.time_s, rtol=RTOL, atol=ATOL)
    force_N = c * record.velocity_m_s + k * record.disp_m + kw * found.y[0] + offset_N
    return force_N, int(found.nfev)
