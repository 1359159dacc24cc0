"""Cuckoo search (Yang and Deb 2009): nests, eggs laid by Levy flights, and nests found out.

In a generation every nest is tried a flight away, x + 0.01 L (x - best) g with L of Levy's law
(Mantegna's algorithm, exponent 1.5) and g Gaussian, then a quarter of all coordinates a random part
of the way between two other nests; each time the better of old and new stays. Ours, because pymoo
and scipy have none.
"""

from collections.abc import Generator
from math import gamma, pi, sin

import numpy as np

FOUND_OUT = 0.25  # part of the coordinates that are laid anew
LEVY = 1.5
STEP = 0.01


def cuckoo(first: np.ndarray, rng: np.random.Generator) -> Generator[np.ndarray, np.ndarray, None]:
    """first: [nests, dimensions], 3 nests or more."""
    nests = first.copy()
    costs = (yield nests).copy()
    while True:
        best = nests[np.argmin(costs)]
        flown = nests + STEP * levy(nests.shape, rng) * (nests - best) * rng.standard_normal(
            nests.shape
        )
        yield from keep_better(nests, costs, np.clip(flown, 0.0, 1.0))
        one, other = rng.permutation(len(nests)), rng.permutation(len(nests))
        moved = nests + rng.random() * (nests[one] - nests[other])
        is_new = rng.random(nests.shape) < FOUND_OUT
        yield from keep_better(nests, costs, np.clip(np.where(is_new, moved, nests), 0.0, 1.0))


def keep_better(
    nests: np.ndarray, costs: np.ndarray, trials: np.ndarray
) -> Generator[np.ndarray, np.ndarray, None]:
    found = yield trials
    is_better = found <= costs
    nests[is_better] = trials[is_better]
    costs[is_better] = found[is_better]


def levy(shape: tuple[int, ...], rng: np.random.Generator) -> np.ndarray:
    top = gamma(1.0 + LEVY) * sin(0.5 * pi * LEVY)
    bottom = gamma(0.5 + 0.5 * LEVY) * LEVY * 2.0 ** (0.5 * LEVY - 0.5)
    size = (top / bottom) ** (1.0 / LEVY)
    return size * rng.standard_normal(shape) / np.abs(rng.standard_normal(shape)) ** (1.0 / LEVY)
