"""How well the data determine each variable of a fit, and whether the residual is noise."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from quiesce.damper.fit.problem import Problem

# Residuals of neighbouring samples count as related up to where their correlation sinks below this.
_CORRELATION_END = 0.05
_AT_BOUND = 1e-6


@dataclass(frozen=True)
class Interval:
    """One variable: 95 % lies within low .. high if the model is right. NaN where the data do not
    determine it or where it stands at a bound."""

    name: str
    unit: str
    value: float
    low: float
    high: float
    at_bound: bool

    @property
    def relative(self) -> float:
        """Half width over the value."""
        return 0.5 * (self.high - self.low) / abs(self.value) if self.value else float("inf")


def intervals(problem: Problem, values: np.ndarray, level: float = 0.95) -> list[Interval]:
    """From the derivative of the residuals at the fit. Where residuals of neighbouring samples are
    related, there are fewer independent ones: the intervals widen by the square root of their
    correlation time (in samples)."""
    jacobian = problem.jacobian(values, problem.difference_steps(values))
    residuals = problem.residuals(values)
    free = np.array(
        [
            not is_at_bound(value, one.bounds, one.natural)
            for value, one in zip(values, problem.variables, strict=True)
        ]
    )
    deviations = np.full(len(values), np.nan)
    if free.any():
        spare = max(1, len(residuals) - int(free.sum()))
        variance = float(np.sum(residuals**2)) / spare * correlation_time(problem, residuals)
        deviations[free] = standard_deviations(jacobian[:, free], variance)
    half = norm.ppf(0.5 + 0.5 * level) * deviations
    return [
        Interval(one.name, one.unit, float(value), value - wide, value + wide, not is_free)
        for one, value, wide, is_free in zip(problem.variables, values, half, free, strict=True)
    ]


def standard_deviations(jacobian: np.ndarray, variance: float) -> np.ndarray:
    """Cramer-Rao: square roots of the diagonal of variance (J^T J)^-1, [variables]; infinite for
    what the data do not determine."""
    sizes = np.linalg.norm(jacobian, axis=0)
    out = np.full(jacobian.shape[1], np.inf)
    seen = sizes > 1e-12 * np.max(sizes, initial=0.0)
    if not seen.any():
        return out
    scaled = jacobian[:, seen] / sizes[seen]
    strengths, directions = np.linalg.svd(scaled, full_matrices=False)[1:]
    usable = strengths > 1e-10 * strengths[0]
    spread = np.sum((directions[usable] / strengths[usable, None]) ** 2, axis=0)
    # A variable that lies in a direction that nothing determines is not determined either.
    lost = np.sum(directions[~usable] ** 2, axis=0) > 1e-6
    out[seen] = np.where(lost, np.inf, np.sqrt(variance * spread) / sizes[seen])
    return out


def is_at_bound(value: float, bounds: tuple[float, float], natural: float) -> bool:
    """natural: the variable's own size. Least squares stay a little inside their bounds."""
    low, high = bounds
    near = _AT_BOUND * max(natural, abs(value))
    return value - low <= near or high - value <= near


def autocorrelation(residuals: np.ndarray, lags: int) -> np.ndarray:
    """Of the residuals without their mean, at lags 0 .. lags."""
    centred = residuals - residuals.mean()
    size = 1 << int(2 * len(centred) - 1).bit_length()
    spectrum = np.abs(np.fft.rfft(centred, size)) ** 2
    found = np.fft.irfft(spectrum, size)[: lags + 1]
    return found / found[0] if found[0] > 0.0 else np.eye(1, lags + 1)[0]


def correlation_time(problem: Problem, residuals: np.ndarray) -> float:
    """Mean over the segments of 1 + 2 times the sum of the leading positive autocorrelations."""
    times, first = [], 0
    for segment in problem.segments:
        part = residuals[first : first + len(segment)]
        first += len(segment)
        found = autocorrelation(part, min(len(part) // 4, 1000))
        # Noise alone has correlations of this size: they do not count.
        floor = max(_CORRELATION_END, 2.0 / np.sqrt(len(part)))
        below = np.flatnonzero(found[1:] < floor)
        end = int(below[0]) + 1 if len(below) else len(found)
        times.append((1.0 + 2.0 * float(np.sum(found[1:end]))) * len(part))
    return sum(times) / max(1, len(residuals))


@dataclass(frozen=True)
class Whiteness:
    """Ljung-Box portmanteau of the residual over `lags` lags."""

    lags: int
    statistic: float
    limit: float  # 95 % quantile if it were white
    correlation_time: float  # samples

    @property
    def is_white(self) -> bool:
        return self.statistic <= self.limit


def whiteness(residuals: np.ndarray, lags: int = 25) -> Whiteness:
    from scipy.stats import chi2

    count = len(residuals)
    lags = max(1, min(lags, count // 4))
    found = autocorrelation(residuals, lags)[1:]
    statistic = count * (count + 2) * float(np.sum(found**2 / (count - np.arange(1, lags + 1))))
    below = np.flatnonzero(found < _CORRELATION_END)
    end = int(below[0]) if len(below) else lags
    return Whiteness(
        lags, statistic, float(chi2.ppf(0.95, lags)), 1.0 + 2.0 * float(np.sum(found[:end]))
    )
