"""Bouc-Wen parameters from three sines at one current, step by step, without a search.

    F  = c v + k x + h + f0
    h' = A v - beta v |h|^n - gamma |v| h |h|^(n-1)

The h-form of the model: h in N, A in N/m, beta and gamma in N^(1-n)/m. The tests are one sine, the
same about another displacement, and the same at another frequency: h is the same in all three,
because it knows neither where it is nor how fast it is passed through. So the second gives the
stiffness, the third the damping, and what is left is h, whose slope against the displacement is a
straight line in |h|^n.

Method: published for magnetorheological dampers with elastomers (MRD and MRE), corrected: there
the damping is taken where the velocity is zero, beta and gamma change places between two equations,
and the logarithm is of a quantity that is negative for every bounded hysteresis.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from quiesce.base.errors import UsageError
from quiesce.damper.data.record import Record

# Points in the mean cycle; even.
POINTS = 4096
# Second-order low-pass, forth and back, over the mean cycle: corner in harmonics, damping ratio.
CORNER_HARMONIC = 40.0
CORNER_DAMPING = 0.7
# A is the slope below this part of the largest h; yielding is between the other two.
SMALL_H = 0.05
LOW_H = 0.25
HIGH_H = 0.9
# Slower than this part of the largest speed, a slope against displacement is a quotient of noise.
SLOW = 0.02
# What the displacement may deviate from a sine, and two tests from each other in amplitude.
SINE_ERROR = 0.05
AMPLITUDE_ERROR = 0.02
LEAST_POINTS = 12
# Part of the force that h must be at least.
LEAST_H = 1e-3


@dataclass(frozen=True)
class Sines:
    """Three recordings at one current: a sine, the same about another displacement, and the same
    at another frequency; at least two cycles each, of which the first is left out."""

    still: Record
    shifted: Record
    faster: Record


@dataclass(frozen=True)
class BoucWenFit:
    """The h-form; see the head of the file."""

    current: float  # A, or V
    c_N_s_m: float
    k_N_m: float
    A_N_m: float
    beta: float  # N^(1-n)/m
    gamma: float  # N^(1-n)/m
    n: float
    f0_N: float

    @property
    def largest_h_N(self) -> float:
        return (self.A_N_m / (self.beta + self.gamma)) ** (1.0 / self.n)

    def bouc_wen(self) -> dict[str, float]:
        """Parameters of the library's model bouc_wen: z = h / A."""
        scale = self.A_N_m ** (self.n - 1.0)
        return {
            "c_N_s_m": self.c_N_s_m,
            "k_N_m": self.k_N_m,
            "alpha_N_m": self.A_N_m,
            "A": 1.0,
            "beta_1_mn": self.beta * scale,
            "gamma_1_mn": self.gamma * scale,
            "n": self.n,
            "f0_N": self.f0_N,
        }

    def normalised(self) -> dict[str, float]:
        """Parameters of the library's model normalised_bouc_wen."""
        return {
            "c_N_s_m": self.c_N_s_m,
            "k_N_m": self.k_N_m,
            "kw_N": self.largest_h_N,
            "rho_1_m": self.A_N_m / self.largest_h_N,
            "sigma": self.gamma / (self.beta + self.gamma),
            "n": self.n,
            "f0_N": self.f0_N,
        }


@dataclass(frozen=True)
class Cycle:
    """The mean cycle of a test, POINTS long, from its displacement's upward passage; smoothed but
    for raw_force_N."""

    freq_Hz: float
    disp_m: np.ndarray
    velocity_m_s: np.ndarray
    accel_m_s2: np.ndarray
    force_N: np.ndarray
    force_rate_N_s: np.ndarray
    raw_force_N: np.ndarray


def fit(sines: Sines, n: float | None = None, is_refined: bool = True) -> BoucWenFit:
    """The parameters at one current; n where it is given, else from the data. is_refined: after the
    steps, A, beta, gamma and n all at once, which noise harms less (see all_at_once).

    UsageError where the tests are not what this method needs, or show no bounded hysteresis.
    """
    current = _common_current(sines)
    still, shifted, faster = (
        cycle(record) for record in (sines.still, sines.shifted, sines.faster)
    )
    _check_sines(sines, still, shifted, faster)
    k = stiffness(still, shifted)
    c = damping(still, faster)
    h, offset = hysteresis(still, c, k)
    if np.max(np.abs(h)) < LEAST_H * np.max(np.abs(still.force_N)):
        raise UsageError(
            f"{sines.still.name}: no hysteretic force beside stiffness and damping; use --model "
            "bingham or a test with a larger current"
        )
    slope = slope_of(still, c, k)
    size = np.abs(h) / np.max(np.abs(h))
    is_moving = np.abs(still.velocity_m_s) > SLOW * np.max(np.abs(still.velocity_m_s))
    a = _first_slope(slope, is_moving & (size < SMALL_H), sines.still)
    is_yielding = is_moving & (size > LOW_H) & (size < HIGH_H)
    is_loading = still.velocity_m_s * h > 0.0
    is_n_free = n is None
    n, loading = _loading(slope, h, a, is_yielding & is_loading, n, sines.still)
    unloading = _unloading(slope, h, a, n, is_yielding & ~is_loading, sines.still)
    if is_refined:
        n, a, loading, unloading = all_at_once(still, c, k, offset, n, is_n_free)
    if not (a > 0.0 and loading > 0.0):
        raise UsageError(
            f"{sines.still.name}: the hysteretic force does not level off; test with a larger "
            "amplitude"
        )
    return BoucWenFit(
        current, c, k, a, 0.5 * (loading - unloading), 0.5 * (loading + unloading), n, offset
    )


def fit_currents(
    tests: Sequence[Sines], degree: int = 2
) -> tuple[list[BoucWenFit], dict[str, np.ndarray]]:
    """One fit a current, with one n for all (beta and gamma have its unit), and polynomials of the
    current, coefficients ascending, through the parameters of the h-form."""
    if degree < 0 or len({_common_current(one) for one in tests}) <= degree:
        raise UsageError(
            f"a polynomial of degree {degree} needs tests at {degree + 1} currents or more, "
            f"found {len(tests)}"
        )
    n = float(np.median([fit(one).n for one in tests]))
    fits = [fit(one, n) for one in tests]
    currents = [one.current for one in fits]
    laws = {
        name: np.polynomial.polynomial.polyfit(
            currents, [getattr(one, name) for one in fits], degree
        )
        for name in ("c_N_s_m", "k_N_m", "A_N_m", "beta", "gamma", "f0_N")
    }
    return fits, laws | {"n": np.array([n])}


def all_at_once(
    one: Cycle, c: float, k: float, offset_N: float, n: float, is_n_free: bool
) -> tuple[float, float, float, float]:
    """n, A, beta + gamma and gamma - beta from every sample of h'; n within a factor of 2.

    h' = A v - (beta + gamma) v |h|^n under load, A v + (gamma - beta) v |h|^n while unloading, is
    linear in all but n. Both sides are low-passed, so that the filter takes nothing from the knee
    where it yields, as it does from a slope; and nothing is divided by the velocity.
    """
    v = one.velocity_m_s
    h = one.raw_force_N - k * one.disp_m - c * v - offset_N
    target = _derived(h, one.freq_Hz, 1)

    def solved(exponent: float) -> tuple[float, np.ndarray]:
        loss = v * np.abs(h) ** exponent
        is_loading = v * h > 0.0
        sides = (v, np.where(is_loading, -loss, 0.0), np.where(is_loading, 0.0, loss))
        columns = np.stack([_derived(side, one.freq_Hz, 0) for side in sides]).T
        scales = np.linalg.norm(columns, axis=0)
        values = np.linalg.lstsq(columns / scales, target, rcond=None)[0] / scales
        return float(np.sum((target - columns @ values) ** 2)), values

    if is_n_free:
        bounds = (max(1.0, n / 2.0), 2.0 * n)
        n = float(minimize_scalar(lambda m: solved(m)[0], bounds=bounds, method="bounded").x)
    return n, *map(float, solved(n)[1])


def cycle(record: Record) -> Cycle:
    """Mean of the cycles after the first, low-passed with zero phase, and its derivatives."""
    freq_Hz, phase = _sine(record)
    turns = freq_Hz * (record.time_s - record.time_s[0]) + phase / (2.0 * np.pi)
    first = int(np.ceil(turns[0])) + (1 if turns[-1] - turns[0] >= 2.0 else 0)
    count = int(np.floor(turns[-1] - first + 1e-9))
    if count < 1:
        raise UsageError(
            f"{record.name}: expected two cycles or more of a sine, found "
            f"{turns[-1] - turns[0]:.1f} at {freq_Hz:.3g} Hz; record it for longer"
        )
    grid = first + np.arange(count * POINTS) / POINTS
    disp, force = (
        np.interp(grid, turns, values).reshape(count, POINTS).mean(axis=0)
        for values in (record.disp_m, record.force_N)
    )
    return Cycle(
        freq_Hz,
        *(_derived(disp, freq_Hz, order) for order in (0, 1, 2)),
        *(_derived(force, freq_Hz, order) for order in (0, 1)),
        force,
    )


def stiffness(still: Cycle, shifted: Cycle) -> float:
    """k in N/m: the mean difference of force at the same phase over that of displacement."""
    difference_m = float(np.mean(shifted.disp_m - still.disp_m))
    return float(np.mean(shifted.force_N - still.force_N)) / difference_m


def damping(still: Cycle, faster: Cycle) -> float:
    """c in N s/m from two frequencies: at the same phase h and x are the same."""
    velocity = faster.velocity_m_s - still.velocity_m_s
    return float(np.sum((faster.force_N - still.force_N) * velocity) / np.sum(velocity**2))


def hysteresis(one: Cycle, c: float, k: float) -> tuple[np.ndarray, float]:
    """h in N, centred between its extremes, and the offset that this takes away."""
    h = one.force_N - k * one.disp_m - c * one.velocity_m_s
    offset = 0.5 * float(h.max() + h.min())
    return h - offset, offset


def slope_of(one: Cycle, c: float, k: float) -> np.ndarray:
    """dh/dx in N/m; meaningless where the velocity is near zero."""
    velocity = np.where(one.velocity_m_s == 0.0, np.finfo(float).tiny, one.velocity_m_s)
    with np.errstate(over="ignore"):
        return one.force_rate_N_s / velocity - k - c * one.accel_m_s2 / velocity


def _first_slope(slope: np.ndarray, chosen: np.ndarray, record: Record) -> float:
    _enough(chosen, "near h = 0", record)
    a = float(np.median(slope[chosen]))
    if a <= 0.0:
        raise UsageError(
            f"{record.name}: the hysteretic force does not rise with the displacement; check the "
            "sign of the force (--flip-force)"
        )
    return a


def _loading(
    slope: np.ndarray, h: np.ndarray, a: float, chosen: np.ndarray, n: float | None, record: Record
) -> tuple[float, float]:
    """n and beta + gamma from ln(A - dh/dx) = n ln|h| + ln(beta + gamma)."""
    chosen = chosen & (slope < a)
    _enough(chosen, "while it yields", record)
    size = np.log(np.abs(h[chosen]))
    loss = np.log(a - slope[chosen])
    if n is None:
        n = float(np.polyfit(size, loss, 1)[0])
    if n < 1.0:
        raise UsageError(
            f"{record.name}: the yielding has exponent {n:.2f}, below the 1 of any Bouc-Wen model; "
            "identify another model or test with a larger amplitude"
        )
    return n, float(np.exp(np.mean(loss - n * size)))


def _unloading(
    slope: np.ndarray, h: np.ndarray, a: float, n: float, chosen: np.ndarray, record: Record
) -> float:
    """gamma - beta from dh/dx - A = (gamma - beta)|h|^n."""
    _enough(chosen, "while it is unloaded", record)
    size = np.abs(h[chosen]) ** n
    return float(np.sum((slope[chosen] - a) * size) / np.sum(size**2))


def _enough(chosen: np.ndarray, where: str, record: Record) -> None:
    if int(chosen.sum()) < LEAST_POINTS:
        raise UsageError(
            f"{record.name}: too few samples of the hysteretic force {where}; test with a larger "
            "amplitude or a higher sampling rate"
        )


def _derived(values: np.ndarray, freq_Hz: float, order: int) -> np.ndarray:
    """Derivative of a cycle, low-passed; all in the frequency domain, so without ends."""
    harmonic = np.arange(len(values) // 2 + 1)
    ratio = harmonic / CORNER_HARMONIC
    gain = 1.0 / ((1.0 - ratio**2) ** 2 + (2.0 * CORNER_DAMPING * ratio) ** 2)
    factor = (2j * np.pi * freq_Hz * harmonic) ** order
    return np.fft.irfft(np.fft.rfft(values) * gain * factor, len(values))


def _sine(record: Record) -> tuple[float, float]:
    """Frequency in Hz and phase of the displacement's sine at the first sample."""
    time_s = record.time_s - record.time_s[0]
    disp = record.disp_m - np.mean(record.disp_m)
    padded = 8 * len(disp)
    spectrum = np.abs(np.fft.rfft(disp * np.hanning(len(disp)), padded))
    freq_Hz = float(np.argmax(spectrum)) * record.rate_Hz / padded
    if freq_Hz == 0.0:
        raise UsageError(f"{record.name}: expected a sine of the displacement, found none")
    for _ in range(10):  # Gauss-Newton: amplitude, phase, mean and frequency
        angle = 2.0 * np.pi * freq_Hz * time_s
        columns = np.stack([np.sin(angle), np.cos(angle), np.ones_like(angle)])
        fitted = np.linalg.lstsq(columns.T, record.disp_m, rcond=None)[0]
        turn = time_s * (fitted[0] * columns[1] - fitted[1] * columns[0])
        step = np.linalg.lstsq(
            np.vstack([columns, turn]).T, record.disp_m - fitted @ columns, rcond=None
        )[0][3]
        freq_Hz += float(step) / (2.0 * np.pi)
    left = record.disp_m - fitted @ columns
    amplitude_m = float(np.hypot(fitted[0], fitted[1]))
    if not freq_Hz > 0.0 or np.std(left) > SINE_ERROR * amplitude_m:
        raise UsageError(
            f"{record.name}: expected a sine of constant amplitude and frequency; this method "
            "needs one, --model normalised_bouc_wen does not"
        )
    return freq_Hz, float(np.arctan2(fitted[1], fitted[0]))


def _common_current(sines: Sines) -> float:
    records = (sines.still, sines.shifted, sines.faster)
    levels = [one.level for one in records]
    if any(level is None for level in levels):
        name = records[levels.index(None)].name
        raise UsageError(f"{name}: expected a constant current, found one that changes")
    low, high = min(levels), max(levels)
    if high - low > max(0.02 * abs(high), 0.01):
        raise UsageError(
            f"{sines.still.name}: the three tests have different currents, {low:g} to {high:g}; "
            "give three tests at one current"
        )
    return float(np.mean(levels))


def _check_sines(sines: Sines, still: Cycle, shifted: Cycle, faster: Cycle) -> None:
    amplitude_m = [0.5 * float(np.ptp(one.disp_m)) for one in (still, shifted, faster)]
    for one, record in zip(amplitude_m[1:], (sines.shifted, sines.faster), strict=True):
        if abs(one / amplitude_m[0] - 1.0) > AMPLITUDE_ERROR:
            raise UsageError(
                f"{record.name}: expected the amplitude of {sines.still.name}, "
                f"{1e3 * amplitude_m[0]:.3g} mm, found {1e3 * one:.3g} mm"
            )
    shift_m = abs(float(np.mean(shifted.disp_m - still.disp_m)))
    if shift_m < 0.02 * amplitude_m[0]:
        raise UsageError(
            f"{sines.shifted.name}: expected the sine of {sines.still.name} about another "
            f"displacement, found it shifted by {1e3 * shift_m:.2g} mm"
        )
    if abs(shifted.freq_Hz / still.freq_Hz - 1.0) > AMPLITUDE_ERROR:
        raise UsageError(
            f"{sines.shifted.name}: expected the frequency of {sines.still.name}, "
            f"{still.freq_Hz:.3g} Hz, found {shifted.freq_Hz:.3g} Hz"
        )
    if abs(faster.freq_Hz / still.freq_Hz - 1.0) < 0.1:
        raise UsageError(
            f"{sines.faster.name}: expected a frequency that differs from that of "
            f"{sines.still.name}, {still.freq_Hz:.3g} Hz, by a tenth or more"
        )
