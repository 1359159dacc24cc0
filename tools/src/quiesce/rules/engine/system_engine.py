"""The firmware's engine for any fuzzy system over numpy arrays: its own C, built here."""

import ctypes
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.rules.engine.engine import at_points, pointer
from quiesce.rules.engine.native_build import SYSTEM_SOURCES, build, firmware_sources
from quiesce.rules.system.compile import CompiledSystem

SOURCE = Path(__file__).parent / "native/many_system.c"


class SystemEngine:
    def __init__(self, compiled: CompiledSystem) -> None:
        self._outputs = len(compiled.system.outputs)
        library = build([*firmware_sources(SYSTEM_SOURCES), SOURCE], {}, ())
        self._library = ctypes.CDLL(str(library))
        self._table = np.array(compiled.words, dtype=np.uint32)
        verdict = self._library.fuzzy_system_check(pointer(self._table), len(self._table))
        if verdict != 0:
            raise UsageError(f"the firmware refuses the table of this system, reason {verdict}")

    def evaluate(self, inputs: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """inputs: int32 of one length n each. Returns int32 [outputs, n] and the uint32 mask [n]
        of outputs that have their default."""
        call = partial(self._library.many_system, pointer(self._table))
        return at_points(inputs, self._outputs, call)
