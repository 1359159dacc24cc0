"""Which cases a campaign has: samples of its factors, each with every choice that is crossed.

Case n has sample n // crossed and the crossed choices n % crossed; it is the same whoever runs it.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce.campaign.factors import Choices, Factor, Level, Spread

GRID, MONTE_CARLO, LATIN, SOBOL = "grid", "monte_carlo", "latin_hypercube", "sobol"
# Of sensitivity: elementary effects along paths, and Sobol's indices.
MORRIS, SALTELLI = "morris", "sobol_indices"
METHODS = (GRID, MONTE_CARLO, LATIN, SOBOL, MORRIS, SALTELLI)
MORRIS_LEVELS = 4
POWER_OF_2 = (SOBOL, SALTELLI)  # methods whose count of cases has to be one


@dataclass(frozen=True)
class Case:
    number: int
    seed: int
    levels: tuple[Level, ...]  # of each factor, in the order of the file

    @property
    def labels(self) -> list[Any]:
        return [level.label for level in self.levels]


class Design:
    """count: as the file has it: samples, repeats of a grid, paths of Morris, base samples of
    Sobol's indices."""

    def __init__(self, factors: tuple[Factor, ...], method: str, count: int, seed: int) -> None:
        self.factors = factors
        self.method = method
        self.count = count
        self.seed = seed
        self.sampled = [i for i, one in enumerate(factors) if not _is_crossed(one)]
        self.crossed = [i for i, one in enumerate(factors) if _is_crossed(one)]
        self._shapes = [len(_levels(factors[i])) for i in self.crossed]
        self.shares = shares(method, count, len(self.sampled), seed)

    @property
    def crossings(self) -> int:
        """Cases of a sample."""
        return math.prod(self._shapes)

    @property
    def samples(self) -> int:
        return len(self.shares)

    def __len__(self) -> int:
        return self.samples * self.crossings

    def case(self, number: int) -> Case:
        """All cases of a sample have its seed: what is crossed is compared under the same noise."""
        sample, crossing = divmod(number, self.crossings)
        levels: dict[int, Level] = {}
        for i, share in zip(self.sampled, self.shares[sample], strict=True):
            levels[i] = self.factors[i].at(float(share))
        at = np.unravel_index(crossing, self._shapes) if self._shapes else ()
        for i, index in zip(self.crossed, at, strict=True):
            levels[i] = _levels(self.factors[i])[int(index)]
        ordered = tuple(levels[i] for i in range(len(self.factors)))
        return Case(number, case_seed(self.seed, sample), ordered)

    def crossing_labels(self, crossing: int) -> list[Any]:
        """Of the crossed factors alone."""
        return [self.case(crossing).levels[i].label for i in self.crossed]


def _is_crossed(factor: Factor) -> bool:
    return isinstance(factor, Choices) and factor.is_crossed


def _levels(factor: Factor) -> tuple[Level, ...]:
    return factor.levels if isinstance(factor, Choices) else ()


def case_seed(seed: int, sample: int) -> int:
    """Of the sensors' noise; independent from one sample to the next, 0 .. 2^63 - 1."""
    sequence = np.random.SeedSequence(seed, spawn_key=(sample,))
    return int(sequence.generate_state(1, np.uint64)[0] >> np.uint64(1))


def shares(method: str, count: int, dimensions: int, seed: int) -> np.ndarray:
    """A row a sample, a column a factor, 0 .. 1."""
    if dimensions == 0:
        return np.zeros((count, 0))
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    if method == MORRIS:
        return _morris(count, dimensions, rng)
    from scipy.stats import qmc

    if method == LATIN:
        return np.asarray(qmc.LatinHypercube(dimensions, rng=rng).random(count))
    if method == SOBOL:
        return np.asarray(qmc.Sobol(dimensions, rng=rng).random(count))
    if method == SALTELLI:
        return _saltelli(np.asarray(qmc.Sobol(2 * dimensions, rng=rng).random(count)))
    return rng.random((count, dimensions))


def _saltelli(both: np.ndarray) -> np.ndarray:
    """Of each base sample: a, b, and for each factor a with that one of b."""
    count, dimensions = both.shape[0], both.shape[1] // 2
    a, b = both[:, :dimensions], both[:, dimensions:]
    out = np.repeat(a[:, None, :], dimensions + 2, axis=1)
    out[:, 1] = b
    for i in range(dimensions):
        out[:, 2 + i, i] = b[:, i]
    return out.reshape(count * (dimensions + 2), dimensions)


def _morris(paths: int, dimensions: int, rng: np.random.Generator) -> np.ndarray:
    """Paths on a grid of MORRIS_LEVELS, of which each step moves one factor by more than half
    (Morris 1991)."""
    step = MORRIS_LEVELS / (2 * (MORRIS_LEVELS - 1))
    out = np.empty((paths, dimensions + 1, dimensions))
    for path in out:
        at = rng.integers(0, MORRIS_LEVELS // 2, dimensions) / (MORRIS_LEVELS - 1)
        up = rng.random(dimensions) < 0.5
        path[0] = np.where(up, at, at + step)
        for k, i in enumerate(rng.permutation(dimensions), 1):
            path[k] = path[k - 1]
            path[k, i] += step if up[i] else -step
    return np.clip(out.reshape(-1, dimensions), 0.0, 1.0)


def has_ends(factor: Factor) -> bool:
    """False: levels at the ends of its range would be infinite."""
    return not (isinstance(factor, Spread) and factor.is_normal)
