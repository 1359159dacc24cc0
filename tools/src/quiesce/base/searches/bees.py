"""Artificial bee colony (Karaboga 2005): food sources, tried by employed bees, by onlookers that
prefer good ones, and left to scouts where nothing better was found for long.

A bee at x tries x_j + phi (x_j - y_j) in one coordinate j, y another source and phi in -1 .. 1; the
better of both stays. All bees of a kind fly at once. Ours, because pymoo and scipy have none.
"""

from collections.abc import Generator

import numpy as np

PATIENCE = 1.0  # trials of a source, in sources times dimensions, before it is left


def bees(first: np.ndarray, rng: np.random.Generator) -> Generator[np.ndarray, np.ndarray, None]:
    """first: [sources, dimensions], 2 sources or more."""
    sources = first.copy()
    costs = (yield sources).copy()
    count, dimensions = sources.shape
    tried = np.zeros(count)
    while True:
        for is_onlooker in (False, True):
            at = rng.choice(count, count, p=shares(costs)) if is_onlooker else np.arange(count)
            trials = neighbours(sources, at, rng)
            found = yield trials
            for bee, source in enumerate(at):
                is_better = found[bee] < costs[source]
                if is_better:
                    sources[source], costs[source] = trials[bee], found[bee]
                tried[source] = 0.0 if is_better else tried[source] + 1.0
        worn = tried > PATIENCE * count * dimensions
        worn[np.argmin(costs)] = False  # the best is remembered
        if np.any(worn):
            sources[worn] = rng.random((int(worn.sum()), dimensions))
            costs[worn] = yield sources[worn]
            tried[worn] = 0.0


def shares(costs: np.ndarray) -> np.ndarray:
    """How many onlookers go to each source: 1 / (1 + cost above the best, in medians of it)."""
    above = costs - costs.min()
    finite = above[np.isfinite(above)]
    fitness = 1.0 / (1.0 + above / max(float(np.median(finite)), 1e-300))
    return fitness / fitness.sum()


def neighbours(sources: np.ndarray, at: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    count, dimensions = sources.shape
    trials = sources[at].copy()
    other = (at + rng.integers(1, count, len(at))) % count
    bee, j = np.arange(len(at)), rng.integers(dimensions, size=len(at))
    phi = rng.uniform(-1.0, 1.0, len(at))
    trials[bee, j] += phi * (sources[at, j] - sources[other, j])
    return np.clip(trials, 0.0, 1.0)
