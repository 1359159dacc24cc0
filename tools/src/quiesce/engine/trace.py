"""Reads the bench's trace files: one JSON line, then float64 rows."""

import json
from pathlib import Path

import numpy as np

Trace = dict[str, np.ndarray]


def read_trace(file: Path, columns: list[str] | None = None) -> Trace:
    """Columns of a trace by name; all of them without `columns`."""
    with file.open("rb") as stream:
        head = json.loads(stream.readline())
        rows = np.frombuffer(stream.read(), dtype="<f8").reshape(head["rows"], -1)
    names = head["columns"]
    return {name: rows[:, names.index(name)].copy() for name in columns or names}
