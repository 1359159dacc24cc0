"""Searches that papers name (quiesce.base.searches.methods), over genomes: each point of the unit
cube is rounded to one for evaluation only."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.base.searches.methods import METHODS
from quiesce.rules.optimize.genes import Genome
from quiesce.rules.optimize.search import Search, latin_hypercube, middle_point, nearest_genome


@dataclass(frozen=True)
class NamedSettings:
    search: str  # of METHODS
    population: int = 24


def search(
    levels: Sequence[int], first: Genome, settings: NamedSettings, rng: np.random.Generator
) -> Search:
    """Yields populations, takes their costs; it begins at `first` and a Latin hypercube."""
    counts = np.array(levels)
    points = latin_hypercube(settings.population, len(counts), rng)
    points[0] = middle_point(first, counts)
    searching = METHODS[settings.search](points, rng)
    points = next(searching)
    while True:
        costs = yield [nearest_genome(point, counts) for point in points]
        points = searching.send(costs[:, 0])
