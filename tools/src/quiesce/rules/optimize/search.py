"""What every search method is: a generator of populations that is sent their costs.

A method draws all its chance from the one random generator that it is given and sees nothing but
costs, so the same seed and the same costs give the same populations, bit for bit. That is what
resuming rests on (optimize_run.py).
"""

from collections.abc import Generator

import numpy as np

from quiesce.rules.optimize.genes import Genome

# Shape (population, objectives); every objective is to become small.
Costs = np.ndarray
Search = Generator[list[Genome], Costs, None]


def nearest_genome(point: np.ndarray, levels: np.ndarray) -> Genome:
    """The genome of a point in the unit cube: equal shares of it for every level."""
    codes = np.floor(point * levels).astype(int)
    return tuple(int(code) for code in np.clip(codes, 0, levels - 1))


def middle_point(genome: Genome, levels: np.ndarray) -> np.ndarray:
    """The middle of a genome's share of the unit cube."""
    return (np.array(genome) + 0.5) / levels


def latin_hypercube(count: int, size: int, rng: np.random.Generator) -> np.ndarray:
    """Points of the unit cube, shape (count, size), one in each of `count` slices of every axis."""
    slices = np.stack([rng.permutation(count) for _ in range(size)], axis=1)
    return (slices + rng.random((count, size))) / count
