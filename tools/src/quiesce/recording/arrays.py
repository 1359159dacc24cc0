"""Tables of arrays, as binary files have them. An array is looked at when it is used, so that one
that is of no use does not keep the others from being used."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.recording.table import MAX_VALUE, NO_LINE, Table, at, clipped

MOST_COLUMNS = 256  # of a matrix
MOST_DEPTH = 8  # of structs in structs


@dataclass(frozen=True)
class ArrayTable(Table):
    """arrays: by the names in `head`, of whatever shape and type. Rows count from 1."""

    file: Path
    head: list[str]
    arrays: list[np.ndarray]
    kind: str
    remark: str = ""
    head_line: int = NO_LINE

    @property
    def note(self) -> str:
        return self.remark or f"columns of a {self.kind}"

    def index(self, name: str) -> int:
        """By the name without its unit, too."""
        bare = [head.partition(" [")[0] for head in self.head]
        if name not in self.head and bare.count(name) == 1:
            return bare.index(name)
        return super().index(name)

    def texts(self, names: list[str]) -> list[tuple[str, ...]]:
        _, values = self.numbers(names)
        return [tuple(f"{value:.9g}" for value in row) for row in values]

    def numbers(self, names: list[str]) -> tuple[np.ndarray, np.ndarray]:
        columns = [self._checked(name, self.arrays[self.index(name)]) for name in names]
        for name, column in zip(names, columns, strict=True):
            if len(column) != len(columns[0]):
                raise self._refusal(
                    name,
                    f"{len(column)} values where {clipped(names[0])} has {len(columns[0])}; "
                    "columns of one recording are of one length",
                )
        values = np.stack(columns, axis=1)
        return np.arange(1, len(values) + 1), values

    def _checked(self, name: str, array: np.ndarray) -> np.ndarray:
        """As float64 [n]."""
        if array.dtype.kind == "c":
            raise self._refusal(name, "complex numbers; export real samples against time")
        if array.dtype.kind not in "fiub":
            raise self._refusal(name, "no numbers; leave it out or export them as numbers")
        if array.ndim != 1:
            sizes = " x ".join(map(str, array.shape))
            raise self._refusal(name, f"an array of {sizes}; one column is needed, export it so")
        values = array.astype(np.float64)
        bad = np.flatnonzero(~(np.abs(values) <= MAX_VALUE))
        if bad.size:
            row = int(bad[0])
            value = values[row]
            problem = (
                f"{value:g} is no measured value; drop this row"
                if np.isfinite(value)
                else f"'{value:g}'; cut these rows or repair the recording"
            )
            raise at(self.file, row + 1, f"column '{clipped(name)}': {problem}")
        return values

    def _refusal(self, name: str, problem: str) -> UsageError:
        return at(self.file, NO_LINE, f"column '{clipped(name)}': {problem}")


def table_of(file: Path, kind: str, found: Mapping[str, Any], remark: str = "") -> ArrayTable:
    """From values by name, structs in structs among them: 'struct.name'. What all names begin with
    is dropped. Single numbers and texts are no columns. UsageError where nothing else is there."""
    columns = dict(_columns(found))
    prefixes = {name.rpartition(".")[0] for name in columns}
    if len(prefixes) == 1:
        columns = {name.rpartition(".")[2]: array for name, array in columns.items()}
    if not columns:
        raise UsageError(f"{shown(file)}: no columns of numbers in this {kind}; export a recording")
    return ArrayTable(file, list(columns), list(columns.values()), kind, remark)


def _columns(found: Mapping[str, Any], start: str = "", depth: int = 0) -> Iterator[Any]:
    for key, value in found.items():
        name = f"{start}{key}"
        if isinstance(value, Mapping):
            if depth < MOST_DEPTH:
                yield from _columns(value, f"{name}.", depth + 1)
            continue
        array = np.asarray(value) if not isinstance(value, str | bytes) else np.empty(0)
        if array.size > 1 and array.dtype.kind != "O":
            yield from _split(name, array)


def _split(name: str, array: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """A row or a column is one; a matrix has one for each column, the longer side being time."""
    if array.ndim == 2 and 1 in array.shape:
        yield name, array.ravel()
    elif array.ndim == 2 and min(array.shape) <= MOST_COLUMNS:
        long = array if array.shape[0] >= array.shape[1] else array.T
        for number, column in enumerate(long.T, 1):
            yield f"{name}_{number}", column
    else:
        yield name, array


def with_unit(name: str, unit: Any) -> str:
    """'name [unit]' where there is a unit."""
    text = unit.decode(errors="replace") if isinstance(unit, bytes) else str(unit or "")
    return f"{name} [{text.strip()}]" if text.strip() not in ("", "-", "NONE") else name
