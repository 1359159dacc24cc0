"""Traces of the bench (quiesce_bench run --trace)."""

from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.before_after.files.source import Origin, Source
from quiesce.before_after.motion import scale_in_name
from quiesce.engine.trace import read_trace

TIME = "t_s"
# Words of columns that the controller estimates, and that are no vibration by themselves.
ESTIMATES = {"amp", "rms"}


class TraceFile(Source):
    """Channels are its columns by their whole name, which ends in the unit."""

    def __init__(self, file: Path) -> None:
        self.file = file
        try:
            self._trace = read_trace(file)
        except (ValueError, KeyError, TypeError):
            raise UsageError(f"{shown(file)}: a bench's trace that is cut off; run the bench again")
        if TIME not in self._trace:
            raise UsageError(f"{shown(file)}: a trace without column {TIME}; run the bench again")
        names = [name for name in self._trace if name != TIME]
        self.scales = {
            name: None if ESTIMATES & set(name.split("_")) else scale_in_name(name)[1]
            for name in names
        }
        self.origin = Origin("trace of the bench")

    def samples(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        return self._trace[TIME], self._trace[name]


def is_trace(start: bytes) -> bool:
    return start.lstrip().startswith(b'{"columns"')
