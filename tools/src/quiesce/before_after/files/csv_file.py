"""Delimited text: columns by their header, a unit at a header's end."""

from collections import Counter
from pathlib import Path

import numpy as np

from quiesce.before_after.files.source import Origin, Source
from quiesce.before_after.motion import scale_in_name
from quiesce.damper.data.columns import Column, find_column, named_column, parse_spec
from quiesce.damper.data.table import Table, open_table

TIME = "time"


class CsvFile(Source):
    """time: NAME or NAME:UNIT, found by its name without it; rate_Hz: of a file without such a
    column. UsageError for what is no table."""

    def __init__(
        self, file: Path, time: str | None = None, rate_Hz: float | None = None, skip_lines: int = 0
    ) -> None:
        self.file = file
        self._table = open_table(file, skip_lines)
        self._rate_Hz = rate_Hz
        self._time = None if rate_Hz is not None else _time_column(self._table, time)
        used = self._time.name if self._time else ""
        named = {head: scale_in_name(head) for head in self._table.head if head not in ("", used)}
        stems = Counter(stem for stem, _ in named.values())
        # What two columns are called without their unit tells neither of them apart.
        self._heads = {
            stem if stems[stem] == 1 else head: head for head, (stem, _) in named.items()
        }
        self.scales = {name: named[head][1] for name, head in self._heads.items()}
        text = f"every {1.0 / rate_Hz:g} s, as stated" if rate_Hz else f"column {used}"
        self.origin = Origin("CSV", {"time": text})

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


def _time_column(table: Table, time: str | None) -> Column:
    if time is not None:
        return named_column(table, TIME, parse_spec(TIME, time))
    column = find_column(table, TIME, needed=True)
    assert column is not None
    return column
