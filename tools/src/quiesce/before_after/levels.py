"""RMS, peak and shape of a signal, and how sure they are: moving blocks, no model of the signal."""

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

# Of the record: parts whose peaks and mean squares are looked at.
BLOCKS = 20
# Moving blocks of a tenth of the record, for the spread of the mean square: shorter ones remember
# too much of their neighbours.
BATCHES = 10
CONFIDENCE = 0.95
# A block that is shorter than this many correlation times of the squared signal forgets too little.
FORGETTING = 2.0
# A tone remembers itself for ever, and does no harm: its blocks' mean squares spread by less.
WAVERING = 0.2
# Mean squares of blocks that spread by less are one, whatever their order.
STEADY = 0.05
# Chance of taking a stationary signal for one that is not.
FALSE_ALARM = 1e-3


@dataclass(frozen=True)
class Estimate:
    """A positive figure, and the standard error of its logarithm with its degrees of freedom."""

    value: float
    error: float
    freedom: float

    def interval(self) -> tuple[float, float]:
        """95 %."""
        reach = self.error * _quantile(self.freedom)
        return self.value * math.exp(-reach), self.value * math.exp(reach)


@dataclass(frozen=True)
class Ratio:
    """after / before, with its 95 % interval."""

    value: float
    low: float
    high: float

    @property
    def change_dB(self) -> float:
        return 20.0 * math.log10(self.value)

    @property
    def is_certain(self) -> bool:
        """The interval does not hold 1."""
        return self.high < 1.0 or self.low > 1.0


def ratio(before: Estimate, after: Estimate) -> Ratio:
    """Of two independent estimates: normal logarithms, Welch's degrees of freedom."""
    value = after.value / before.value
    squares = [before.error**2, after.error**2]
    total = sum(squares)
    if total == 0.0:
        return Ratio(value, value, value)
    parts = zip(squares, (before.freedom, after.freedom), strict=True)
    freedom = total**2 / sum(square**2 / freedom for square, freedom in parts)
    reach = math.sqrt(total) * _quantile(freedom)
    return Ratio(value, value * math.exp(-reach), value * math.exp(reach))


def _quantile(freedom: float) -> float:
    return float(stats.t.ppf(0.5 + CONFIDENCE / 2.0, freedom))


def rms(values: np.ndarray) -> Estimate:
    """Of a signal without its mean. The spread of the mean square is that of moving blocks; what
    two lengths of blocks differ by corrects for what neighbours remember of each other (lugsail
    batch means: Vats and Flegal 2022)."""
    square = values**2
    mean = float(square.mean())
    size = len(values) // BATCHES
    variance = _batch_variance(square, size)
    variance = max(variance, 2.0 * variance - _batch_variance(square, size // 2))
    # d ln sqrt(m) = dm / (2 m)
    error = math.sqrt(variance) / (2.0 * mean) if mean > 0.0 else 0.0
    return Estimate(math.sqrt(mean), error, BATCHES - 1.0)


def _batch_variance(values: np.ndarray, size: int) -> float:
    """Of the mean of values, from the means of all stretches of `size` of them (overlapping batch
    means: Meketon and Schmeiser 1984)."""
    count = len(values)
    sums = np.concatenate([[0.0], np.cumsum(values - values.mean())])
    moving = (sums[size:] - sums[:-size]) / size
    scale = count * size / ((count - size + 1.0) * (count - size))
    return scale * float(np.sum(moving**2)) / count


def blocks(values: np.ndarray) -> np.ndarray:
    """[BLOCKS, samples]; what is left over at the end is left out."""
    return _stretches(values, len(values) // BLOCKS)[:BLOCKS]


def _stretches(values: np.ndarray, size: int) -> np.ndarray:
    count = len(values) // size
    return values[: count * size].reshape(count, size)


def typical_peaks(before: np.ndarray, after: np.ndarray) -> tuple[Estimate, Estimate]:
    """Geometric mean of the peaks of stretches as long as a twentieth of the shorter record, for
    those of longer stretches are larger."""
    size = min(len(before), len(after)) // BLOCKS
    return _typical_peak(_stretches(before, size)), _typical_peak(_stretches(after, size))


def _typical_peak(stretches: np.ndarray) -> Estimate:
    logs = np.log(np.maximum(np.abs(stretches).max(axis=1), np.finfo(float).tiny))
    error = float(logs.std(ddof=1)) / math.sqrt(len(logs))
    return Estimate(math.exp(float(logs.mean())), error, len(logs) - 1.0)


def peak(values: np.ndarray) -> float:
    return float(np.abs(values).max())


def crest(values: np.ndarray) -> float:
    return peak(values) / float(np.sqrt(np.mean(values**2)))


def kurtosis(values: np.ndarray) -> float:
    """Pearson's: 3 of a Gaussian signal, 1.5 of a sine."""
    return float(np.mean(values**4) / np.mean(values**2) ** 2)


# Is it stationary


def memory_samples(values: np.ndarray) -> float:
    """Correlation time of the squared signal, sum of its squared autocorrelation: of a Gaussian
    signal Var(mean square) = 2 m^2 memory / samples (Bendat and Piersol, 8.2)."""
    size = 2 ** math.ceil(math.log2(2 * len(values)))
    power = np.abs(np.fft.rfft(values - values.mean(), size)) ** 2
    correlation = np.fft.irfft(power)[: len(values) // BLOCKS]
    if correlation[0] <= 0.0:
        return 1.0
    found = (correlation / correlation[0]) ** 2
    return float(1.0 + 2.0 * found[1:].sum())


def unsteady(values: np.ndarray) -> list[str]:
    """Lines about what a stationary signal of this spectrum would hardly do."""
    means = np.mean(blocks(values) ** 2, axis=1)
    spread = float(means.std(ddof=1) / means.mean())
    if spread < STEADY:
        return []
    size = len(values) // BLOCKS
    memory = memory_samples(values)
    lines = []
    if size < FORGETTING * memory and spread > WAVERING:
        lines.append("short for its narrow spectrum: the intervals of RMS are too narrow")
    trend = stats.kendalltau(np.arange(BLOCKS), means)
    if trend.pvalue < FALSE_ALARM:
        way = "grows" if trend.statistic > 0 else "fades"
        lines.append(f"not stationary: it {way} from start to end of the record")
    expected = 2.0 * memory / size
    square = (BLOCKS - 1) * spread**2 / expected
    if square > stats.chi2.ppf(1.0 - FALSE_ALARM, BLOCKS - 1) and not lines:
        largest = math.sqrt(means.max() / means.mean())
        lines.append(
            f"not stationary: its strongest twentieth has {largest:.2g} times the RMS of the "
            "whole; the RMS depends on which stretch is compared"
        )
    return lines
