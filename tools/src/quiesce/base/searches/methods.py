"""Searches over the unit cube by the names that papers give them.

Each is a generator of points [any, dimensions] that is sent their costs [any], for ever; it draws
all its chance from the generator of random numbers that it is given, so that the same costs give
the same points. pymoo comes with this module: load it when a search begins.
"""

from collections.abc import Callable

import numpy as np

from quiesce.base.searches import by_pymoo
from quiesce.base.searches.bees import bees
from quiesce.base.searches.by_pymoo import Points
from quiesce.base.searches.cuckoo import cuckoo
from quiesce.base.searches.names import NAMES

# First points [population, dimensions], and where chance comes from.
Method = Callable[[np.ndarray, np.random.Generator], Points]

# In the order of NAMES.
_SEARCHES: tuple[Method, ...] = (by_pymoo.pso, by_pymoo.cmaes, by_pymoo.es, cuckoo, bees)
METHODS: dict[str, Method] = dict(zip(NAMES, _SEARCHES, strict=True))
