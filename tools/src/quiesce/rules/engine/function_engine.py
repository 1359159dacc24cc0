"""Straight-line C of a fuzzy system over numpy arrays, built for this machine."""

import ctypes
from collections.abc import Sequence
from functools import partial

import numpy as np

from quiesce.rules.engine.engine import FUNCTION, SOURCE, at_points
from quiesce.rules.engine.native_build import build, firmware_sources
from quiesce.rules.straight.compile import StraightSystem
from quiesce.rules.straight.emit import straight_line


class FunctionEngine:
    def __init__(self, compiled: StraightSystem) -> None:
        self._outputs = len(compiled.system.outputs)
        declaration = f"uint32_t {FUNCTION}(const int32_t *input, int32_t *output);"
        text = straight_line(compiled).text(FUNCTION)
        source = f'#include "fuzzy_polynomial.h"\n{declaration}\n{text}'
        library = build([*firmware_sources(), SOURCE], {"straight.c": source}, ())
        self._library = ctypes.CDLL(str(library))
        self._function = getattr(self._library, FUNCTION)

    def evaluate(self, inputs: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """inputs: int32 of one length n each. Returns int32 [outputs, n] and the uint32 mask [n]
        of outputs that have their default."""
        shape = (len(inputs), self._outputs)
        call = partial(self._library.many_function, self._function, *shape)
        return at_points(inputs, self._outputs, call)
