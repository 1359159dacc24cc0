"""Both engines of the firmware over numpy arrays: its own C, built for this machine."""

import ctypes
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.rules.engine.native_build import build, firmware_sources
from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.integers.emit import straight_line_c
from quiesce.rules.integers.table import table_words

SOURCE = Path(__file__).parent / "native/many.c"
TABLE = "table"
STRAIGHT = "straight"
FUNCTION = "quiesce_rules_straight"


class TableEngine:
    """A table of rules or a surface: words as a controller gets them."""

    def __init__(self, words: Sequence[int], texts: Mapping[str, str] | None = None) -> None:
        """texts: more sources, by their files' names. UsageError where the firmware refuses it."""
        library = build([*firmware_sources(), SOURCE], texts or {}, ())
        self._library = ctypes.CDLL(str(library))
        self._outputs = words[3] >> 8 & 0xFF
        self._table = np.array(words, dtype=np.uint32)
        verdict = self._library.fuzzy_table_check(pointer(self._table), len(self._table))
        if verdict != 0:
            raise UsageError(f"the firmware refuses the table of this rule base, reason {verdict}")

    def evaluate(self, inputs: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """inputs: int32 of one length n each. Returns int32 [outputs, n] and the uint32 mask [n]
        of outputs that have their default."""
        call = partial(self._library.many_table, pointer(self._table))
        return at_points(inputs, self._outputs, call)

    def fired(self, inputs: Sequence[np.ndarray]) -> np.ndarray:
        """uint64 [n]: bit i is rule i, for the first 64 rules."""
        points = np.ascontiguousarray(np.stack([np.asarray(x, np.int32).ravel() for x in inputs]))
        fired = np.empty(points.shape[1], dtype=np.uint64)
        self._library.many_fired(
            pointer(self._table), points.shape[1], pointer(points), pointer(fired)
        )
        return fired


class Engine(TableEngine):
    """kind: TABLE, or STRAIGHT where the base has a straight-line form (NotStraight else)."""

    def __init__(self, compiled: CompiledBase, kind: str = TABLE) -> None:
        texts = {"straight.c": straight_source(compiled)} if kind == STRAIGHT else {}
        super().__init__(table_words(compiled), texts)
        self._inputs = len(compiled.axes)
        self._function = getattr(self._library, FUNCTION) if kind == STRAIGHT else None

    def evaluate(self, inputs: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        if self._function is None:
            return super().evaluate(inputs)
        call = partial(self._library.many_function, self._function, self._inputs, self._outputs)
        return at_points(inputs, self._outputs, call)


def straight_source(compiled: CompiledBase) -> str:
    """FUNCTION, complete for a compiler."""
    declaration = f"uint32_t {FUNCTION}(const int32_t *input, int32_t *output);"
    return f'#include "fuzzy_math.h"\n{declaration}\n{straight_line_c(compiled, FUNCTION)}'


def at_points(
    inputs: Sequence[np.ndarray], outputs: int, call: Callable
) -> tuple[np.ndarray, np.ndarray]:
    """call: of C, for the number of points, the inputs, the outputs and the mask of defaults. As
    Engine.evaluate()."""
    points = np.ascontiguousarray(np.stack([np.asarray(x, np.int32).ravel() for x in inputs]))
    count = points.shape[1]
    out = np.empty((outputs, count), dtype=np.int32)
    defaults = np.empty(count, dtype=np.uint32)
    call(count, pointer(points), pointer(out), pointer(defaults))
    return out, defaults


def pointer(array: np.ndarray) -> ctypes.c_void_p:
    return array.ctypes.data_as(ctypes.c_void_p)
