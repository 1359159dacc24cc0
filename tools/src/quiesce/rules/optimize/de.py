"""Differential evolution (Storn and Price), best/1/bin, over the unit cube.

Every generation each point x_i meets a trial: in a random choice of coordinates (at least one)
x_best + F (x_a - x_b), elsewhere x_i itself; the better of both stays. F is drawn anew each
generation (dither). A coordinate that leaves the cube is drawn anew. Points are rounded to genomes
for evaluation only, so differences keep their fractions.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.rules.optimize.genes import Genome
from quiesce.rules.optimize.search import Search, latin_hypercube, middle_point, nearest_genome


@dataclass(frozen=True)
class DeSettings:
    population: int = 24
    crossover: float = 0.7
    scale_low: float = 0.5
    scale_high: float = 1.0


def search(
    levels: Sequence[int], first: Genome, settings: DeSettings, rng: np.random.Generator
) -> Search:
    """Yields populations, takes their costs; the first one holds `first` and a Latin hypercube."""
    counts = np.array(levels)
    points = latin_hypercube(settings.population, len(counts), rng)
    points[0] = middle_point(first, counts)
    costs = yield [nearest_genome(point, counts) for point in points]
    cost = costs[:, 0].copy()
    while True:
        trials = make_trials(points, int(np.argmin(cost)), settings, rng)
        costs = yield [nearest_genome(point, counts) for point in trials]
        better = costs[:, 0] <= cost
        points[better] = trials[better]
        cost[better] = costs[better, 0]


def make_trials(
    points: np.ndarray, best: int, settings: DeSettings, rng: np.random.Generator
) -> np.ndarray:
    """One trial for every point, shape (population, coordinates)."""
    count, size = points.shape
    scale = rng.uniform(settings.scale_low, settings.scale_high)
    trials = points.copy()
    for i in range(count):
        others = [j for j in range(count) if j not in (i, best)]
        a, b = rng.choice(others, 2, replace=False)
        mutant = points[best] + scale * (points[a] - points[b])
        mutant = np.where((mutant < 0) | (mutant > 1), rng.random(size), mutant)
        crossed = rng.random(size) < settings.crossover
        crossed[rng.integers(size)] = True
        trials[i] = np.where(crossed, mutant, points[i])
    return trials
