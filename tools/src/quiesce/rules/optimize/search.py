"""What every search method is here: a generator of populations that is sent their costs.

A method draws all its chance from the one random generator that it is given and sees nothing but
costs, so the same seed and the same costs give the same populations, bit for bit. That is what
resuming rests on (run.py).
"""

from collections.abc import Callable, Generator, Sequence

import numpy as np

from quiesce.rules.optimize.coding import Coding
from quiesce.rules.optimize.genes import Genome
from quiesce.rules.optimize.methods import DE, GA, NSGA2, ROULETTE, Settings

# Shape (population, objectives); every objective is to become small.
Costs = np.ndarray
Search = Generator[list[Genome], Costs, None]


def make_search(
    levels: Sequence[int], first: Genome, settings: Settings, rng: np.random.Generator
) -> Search:
    """Yields populations, takes their costs; it begins at `first` among others that are random."""
    if settings.method in (GA, NSGA2):
        return of_bits(levels, first, settings, rng)
    return of_points(levels, first, settings, rng)


def of_bits(
    levels: Sequence[int], first: Genome, settings: Settings, rng: np.random.Generator
) -> Search:
    from quiesce.base.searches import by_pymoo  # slow to load

    coding = Coding(levels)
    people = rng.random((settings.population, coding.bits)) < 0.5
    people[0] = coding.encode(first)
    if settings.method == GA:
        is_roulette = settings.selection == ROULETTE
        searching = by_pymoo.ga(people, rng, settings.crossover, is_roulette)
    else:
        searching = by_pymoo.nsga2(people, rng, settings.crossover)
    return decoded(searching, coding.decode)


def of_points(
    levels: Sequence[int], first: Genome, settings: Settings, rng: np.random.Generator
) -> Search:
    """Points of the unit cube are rounded to genomes for evaluation only, so what lies between two
    levels is kept."""
    from scipy.stats.qmc import LatinHypercube  # slow to load

    from quiesce.base.searches import by_pymoo
    from quiesce.base.searches.methods import METHODS

    counts = np.array(levels)
    points = LatinHypercube(len(counts), rng=rng).random(settings.population)
    points[0] = middle_point(first, counts)
    method = by_pymoo.de if settings.method == DE else METHODS[settings.method]
    return decoded(method(points, rng), lambda point: nearest_genome(point, counts))


def decoded(
    searching: Generator[np.ndarray, np.ndarray, None], decode: Callable[[np.ndarray], Genome]
) -> Search:
    """A search over rows of numbers as one over the genomes that they stand for."""
    rows = next(searching)
    while True:
        costs = yield [decode(row) for row in rows]
        rows = searching.send(costs[:, 0] if costs.shape[1] == 1 else costs)


def nearest_genome(point: np.ndarray, levels: np.ndarray) -> Genome:
    """The genome of a point in the unit cube: equal shares of it for every level."""
    codes = np.floor(point * levels).astype(int)
    return tuple(int(code) for code in np.clip(codes, 0, levels - 1))


def middle_point(genome: Genome, levels: np.ndarray) -> np.ndarray:
    """The middle of a genome's share of the unit cube."""
    return (np.array(genome) + 0.5) / levels
