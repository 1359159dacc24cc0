"""Columns under names, of delimited text or any format of quiesce.recording; a unit ends a name."""

from collections import Counter
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.before_after.files.source import Origin, Source
from quiesce.before_after.motion import Scale, scale_in_name, scale_of
from quiesce.recording.beside import proposed, stated_beside
from quiesce.recording.columns import Column, ColumnSpec, find_column, named_column, parse_spec
from quiesce.recording.open import open_table
from quiesce.recording.table import Table

TIME = "time"


class TableFile(Source):
    """time: NAME or NAME:UNIT, found by its name without it; rate_Hz: of a file without such a
    column. UsageError for what is no table."""

    def __init__(
        self, file: Path, time: str | None = None, rate_Hz: float | None = None, skip_lines: int = 0
    ) -> None:
        self.file = file
        self._table = open_table(file, skip_lines)
        self._rate_Hz = rate_Hz
        stated = stated_beside(file)
        self._time = None if rate_Hz is not None else _time_column(self._table, time, stated)
        used = self._time.name if self._time else ""
        named = {head: scale_in_name(head) for head in self._table.head if head not in ("", used)}
        stems = Counter(stem for stem, _ in named.values())
        # What two columns are called without their unit tells neither of them apart.
        self._heads = {
            stem if stems[stem] == 1 else head: head for head, (stem, _) in named.items()
        }
        beside = _stated_scales(stated)
        self.scales = {name: beside.get(head, named[head][1]) for name, head in self._heads.items()}
        text = f"every {1.0 / rate_Hz:g} s, as stated" if rate_Hz else f"column {used}"
        self.origin = Origin(file.suffix.lstrip(".").upper(), {"time": text})

    def known(self, name: str) -> str:
        """By its whole header, too."""
        of_head = {head: one for one, head in self._heads.items()}
        return super().known(of_head.get(name, name))

    def samples(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        head = self._heads[name]
        if self._time is None:
            _, cells = self._table.numbers([head])
            return np.arange(len(cells)) / self._rate_Hz, cells[:, 0]
        _, cells = self._table.numbers([self._time.name, head])
        return self._time.si(cells[:, 0]), cells[:, 1]


def _time_column(table: Table, time: str | None, stated: Mapping[str, ColumnSpec | None]) -> Column:
    spec = parse_spec(TIME, time) if time is not None else stated.get(TIME)
    if spec is not None:
        return named_column(table, TIME, spec)
    try:
        column = find_column(table, TIME, needed=True)
    except UsageError as error:
        raise proposed(table, error, TIME)
    assert column is not None
    return column


def _stated_scales(stated: Mapping[str, ColumnSpec | None]) -> dict[str, Scale]:
    """Of the channels of motion that the file beside the recording has, by their headers."""
    specs = {one.name: one for one in filter(None, stated.values()) if one.unit is not None}
    scales = {name: (one.factor, scale_of(one.unit or "")) for name, one in specs.items()}
    return {
        name: Scale(scale.motion, factor * scale.per_one, scale.unit)
        for name, (factor, scale) in scales.items()
        if scale is not None
    }
