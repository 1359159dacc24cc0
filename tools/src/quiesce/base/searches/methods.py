"""Searches over the unit cube by the names that papers give them.

Each is a generator of points [any, dimensions] that is sent their costs [any], for ever; it draws
all its chance from the generator of random numbers that it is given, so that the same costs give
the same points.
"""

from collections.abc import Callable, Generator

import numpy as np

from quiesce.base.searches import by_pymoo
from quiesce.base.searches.bees import bees
from quiesce.base.searches.cuckoo import cuckoo
from quiesce.base.searches.names import NAMES

Points = Generator[np.ndarray, np.ndarray, None]
# First points [population, dimensions], and where chance comes from.
Method = Callable[[np.ndarray, np.random.Generator], Points]

# In the order of NAMES.
_SEARCHES: tuple[Method, ...] = (by_pymoo.pso, by_pymoo.cmaes, by_pymoo.es, cuckoo, bees)
METHODS: dict[str, Method] = dict(zip(NAMES, _SEARCHES, strict=True))


def require(method: str) -> None:
    """UsageError where what a method of that name needs is not there."""
    if METHODS.get(method) in (by_pymoo.pso, by_pymoo.cmaes, by_pymoo.es):
        by_pymoo.require_pymoo()
