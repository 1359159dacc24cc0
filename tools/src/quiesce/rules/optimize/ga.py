"""Genetic algorithm over binary codes, as the squeeze-mode paper names it.

A chromosome is one string of bits: a Gray code of N bits for every gene. Each generation keeps its
best individuals (elitism, constant size of the population) and fills the rest with children of
selected parents: crossover at one point with a probability, then each bit flips with 1 / number of
bits. The paper gives no figures; the defaults are ours.

A code of N bits names level floor(code * levels / 2^N): equal shares whatever the number of levels
is, and every level itself where it is a power of two.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.rules.optimize.genes import Genome
from quiesce.rules.optimize.search import Costs, Search

ROULETTE, TOURNAMENT = "roulette", "tournament"
SELECTIONS = (TOURNAMENT, ROULETTE)
SPARE_BITS = 2  # more than the levels need, so that shares of unequal numbers differ little


@dataclass(frozen=True)
class GaSettings:
    population: int = 24
    selection: str = TOURNAMENT
    crossover: float = 0.8
    elite: int = 2
    rivals: int = 2  # of a tournament


class Coding:
    """Bits of genomes: Gray codes one after the other, the highest bit first."""

    def __init__(self, levels: Sequence[int]) -> None:
        self._levels = levels
        self._widths = [width(count) for count in levels]

    @property
    def bits(self) -> int:
        return sum(self._widths)

    def decode(self, bits: np.ndarray) -> Genome:
        """bits: 0 or 1, shape (bits,)."""
        genes, first = [], 0
        for count, wide in zip(self._levels, self._widths, strict=True):
            code = 0
            for bit in np.bitwise_xor.accumulate(bits[first : first + wide]):
                code = 2 * code + int(bit)
            genes.append(code * count >> wide)
            first += wide
        return tuple(genes)

    def encode(self, genome: Genome) -> np.ndarray:
        """The lowest code of each gene's level."""
        bits: list[int] = []
        for gene, count, wide in zip(genome, self._levels, self._widths, strict=True):
            code = -(-(gene << wide) // count)
            gray = code ^ (code >> 1)
            bits += [gray >> i & 1 for i in reversed(range(wide))]
        return np.array(bits, dtype=np.uint8)


def width(count: int) -> int:
    exact = max(count - 1, 1).bit_length()
    return exact if count == 1 << exact else exact + SPARE_BITS


def search(
    levels: Sequence[int], first: Genome, settings: GaSettings, rng: np.random.Generator
) -> Search:
    """Yields populations, takes their costs; the first one holds `first` and random others."""
    coding = Coding(levels)
    people = rng.integers(0, 2, (settings.population, coding.bits), dtype=np.uint8)
    people[0] = coding.encode(first)
    while True:
        costs = yield [coding.decode(one) for one in people]
        people = next_generation(people, costs[:, 0], settings, rng)


def next_generation(
    people: np.ndarray, cost: np.ndarray, settings: GaSettings, rng: np.random.Generator
) -> np.ndarray:
    """people: bits, shape (population, bits). cost: shape (population,)."""
    elite = people[np.argsort(cost, kind="stable")[: settings.elite]]
    count = settings.population - len(elite)
    mothers, fathers = (people[select(cost, count, settings, rng)] for _ in range(2))
    children = cross(mothers, fathers, settings.crossover, rng)
    flips = rng.random(children.shape) < 1.0 / people.shape[1]
    return np.concatenate([elite, children ^ flips.astype(np.uint8)])


def select(
    cost: np.ndarray, count: int, settings: GaSettings, rng: np.random.Generator
) -> np.ndarray:
    """Indices of parents, shape (count,)."""
    if settings.selection == ROULETTE:
        return rng.choice(len(cost), count, p=roulette_shares(cost))
    rivals = rng.integers(0, len(cost), (count, settings.rivals))
    return rivals[np.arange(count), np.argmin(cost[rivals], axis=1)]


def roulette_shares(cost: Costs) -> np.ndarray:
    """Chances in proportion to what each is better than the worst; equal where all are."""
    fitness = cost.max() - cost
    total = fitness.sum()
    return fitness / total if total > 0 else np.full(len(cost), 1.0 / len(cost))


def cross(
    mothers: np.ndarray, fathers: np.ndarray, chance: float, rng: np.random.Generator
) -> np.ndarray:
    """One child of each pair: its mother up to a random bit, from there its father."""
    count, bits = mothers.shape
    cut = rng.integers(1, bits, count) if bits > 1 else np.ones(count, dtype=int)
    cut = np.where(rng.random(count) < chance, cut, bits)
    return np.where(np.arange(bits) < cut[:, None], mothers, fathers)
