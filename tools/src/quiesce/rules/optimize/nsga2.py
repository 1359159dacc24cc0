"""NSGA-II (Deb, Pratap, Agarwal, Meyarivan): several objectives at once, a front of the best.

A population of bit strings (the coding and the operators of optimize_ga.py) is sorted into fronts:
of two in one front neither is at least as good in every objective. Parents win tournaments by
front, then by distance to their neighbours in the front; of parents and children together the best
fronts survive, the last of them by distance.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.rules.optimize.ga import Coding, cross
from quiesce.rules.optimize.genes import Genome
from quiesce.rules.optimize.search import Costs, Search


@dataclass(frozen=True)
class NsgaSettings:
    population: int = 40
    crossover: float = 0.9


def search(
    levels: Sequence[int], first: Genome, settings: NsgaSettings, rng: np.random.Generator
) -> Search:
    """Yields populations, takes their costs; the first one holds `first` and random others."""
    coding = Coding(levels)
    people = rng.integers(0, 2, (settings.population, coding.bits), dtype=np.uint8)
    people[0] = coding.encode(first)
    costs = yield [coding.decode(one) for one in people]
    while True:
        rank, distance = standing(costs)
        mothers, fathers = (people[tournament(rank, distance, rng)] for _ in range(2))
        children = cross(mothers, fathers, settings.crossover, rng)
        children = children ^ (rng.random(children.shape) < 1.0 / coding.bits).astype(np.uint8)
        child_costs = yield [coding.decode(one) for one in children]
        people, costs = survivors(
            np.concatenate([people, children]),
            np.concatenate([costs, child_costs]),
            settings.population,
        )


def dominates(costs: Costs) -> np.ndarray:
    """[i, j]: i is nowhere worse than j and somewhere better. Shape (n, n)."""
    one, other = costs[:, None, :], costs[None, :, :]
    return (one <= other).all(axis=2) & (one < other).any(axis=2)


def fronts(costs: Costs) -> list[np.ndarray]:
    """Indices, best front first."""
    above = dominates(costs)
    left = np.ones(len(costs), dtype=bool)
    found = []
    while left.any():
        front = np.flatnonzero(left & ~(above & left[:, None]).any(axis=0))
        found.append(front)
        left[front] = False
    return found


def crowding(costs: Costs) -> np.ndarray:
    """Of every point of one front, how far apart its neighbours are; infinite at the ends."""
    total = np.zeros(len(costs))
    for values in costs.T:
        order = np.argsort(values, kind="stable")
        span = values[order[-1]] - values[order[0]]
        total[order[[0, -1]]] = np.inf
        if span > 0:
            total[order[1:-1]] += (values[order[2:]] - values[order[:-2]]) / span
    return total


def standing(costs: Costs) -> tuple[np.ndarray, np.ndarray]:
    """Number of the front and crowding distance of every point."""
    rank, distance = np.zeros(len(costs), dtype=int), np.zeros(len(costs))
    for number, front in enumerate(fronts(costs)):
        rank[front] = number
        distance[front] = crowding(costs[front])
    return rank, distance


def tournament(rank: np.ndarray, distance: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Winners of as many pairs as there are points: by front, then by distance."""
    one, other = rng.integers(0, len(rank), (2, len(rank)))
    is_better = (rank[other] < rank[one]) | (
        (rank[other] == rank[one]) & (distance[other] > distance[one])
    )
    return np.where(is_better, other, one)


def survivors(people: np.ndarray, costs: Costs, count: int) -> tuple[np.ndarray, Costs]:
    """The best `count`; equal bit strings count once while there are enough others."""
    _, unique = np.unique(people, axis=0, return_index=True)
    repeated = np.ones(len(people), dtype=int)
    repeated[unique] = 0
    rank, distance = standing(costs)
    chosen = np.lexsort((np.arange(len(people)), -distance, rank, repeated))[:count]
    return people[chosen], costs[chosen]
