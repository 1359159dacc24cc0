"""Recorded columns of a file: read, checked, against uniform time."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.nearest import listed
from quiesce.base.paths import shown
from quiesce.recording.beside import proposed, stated_beside
from quiesce.recording.columns import ROLES, ColumnSpec, column_of
from quiesce.recording.open import open_table
from quiesce.recording.table import Table, at
from quiesce.recording.units import Unit, split_name

M_S2_PER_UNIT = {"g": 9.80665, "m_s2": 1.0, "mm_s2": 1e-3}
# What a column may be in, by the unit of its sensor: how many of that unit it is.
COLUMN_UNITS = {
    "um/s2": {unit: 1e6 * m_s2 for unit, m_s2 in M_S2_PER_UNIT.items()},
    "um/s": {"m_s": 1e6, "mm_s": 1e3},
    "nm": {"m": 1e9, "mm": 1e6, "um": 1e3},
    "mN": {"N": 1e3},
    "mV": {"V": 1e3},
    "mdegC": {"degC": 1e3},
}
MIN_ROWS = 3
# Largest distance of a time stamp from the uniform grid, in sample periods: covers stamps rounded
# to 1 ms at 400 Hz, refuses gaps and drifting clocks.
MAX_JITTER = 0.25


@dataclass(frozen=True)
class Recording:
    """Samples at start_s + n / rate_Hz; one array a column, as it stands in the file."""

    start_s: float
    rate_Hz: float
    columns: dict[str, np.ndarray]
    jitter: float  # largest distance of a time stamp from that grid, in sample periods

    @property
    def rows(self) -> int:
        return len(next(iter(self.columns.values())))

    @property
    def duration_s(self) -> float:
        return self.rows / self.rate_Hz

    def accel_m_s2(self, column: str, unit: str) -> np.ndarray:
        return self.columns[column] * M_S2_PER_UNIT[unit]


def read_recording(file: Path, columns: list[str], time_column: str) -> Recording:
    """UsageError, naming the line where there is one, for anything that is not a recording."""
    lines, table = read_columns(file, [time_column, *columns])
    time_s = table[:, 0]
    check_time(file, time_column, lines, time_s)
    period_s = (time_s[-1] - time_s[0]) / (len(time_s) - 1)
    return Recording(
        start_s=float(time_s[0]),
        rate_Hz=float(1.0 / period_s),
        columns={name: table[:, 1 + i] for i, name in enumerate(columns)},
        jitter=check_uniform(file, time_column, lines, time_s, period_s),
    )


def read_columns(file: Path, names: list[str]) -> tuple[list[int], np.ndarray]:
    """Lines (rows, of binary files) and values of the named columns.

    A name that the file does not have, and that is a quantity with its unit, such as accel_m_s2, is
    the column that the file beside it states for that quantity, or that can only be meant.
    """
    table = open_table(file, least=min(len(set(names)), 2))
    stated = stated_beside(file)
    sources = [_source(table, name, stated) for name in names]
    lines, cells = table.numbers([source for source, _ in sources])
    if len(lines) < MIN_ROWS:
        raise UsageError(
            f"{shown(file)}: {len(lines)} rows of data; at least {MIN_ROWS} are needed"
        )
    values = [scale(cells[:, i]) for i, (_, scale) in enumerate(sources)]
    return lines.tolist(), np.stack(values, axis=1)


def _source(
    table: Table, name: str, stated: dict[str, ColumnSpec | None]
) -> tuple[str, Callable[[np.ndarray], np.ndarray]]:
    """The column in the file, and what makes its cells what `name` says."""
    if name in table.head:
        table.index(name)  # once
        return name, lambda cells: cells
    meant = _quantity(name)
    try:
        column = column_of(table, meant[0], stated, needed=True) if meant else None
    except UsageError as error:
        if meant and meant[0] in stated:
            raise error
        column = None
    if meant is None or column is None:
        problem = UsageError(f"{shown(table.file)}: no column '{name}'; {listed(name, table.head)}")
        raise proposed(table, problem, meant[0]) if meant else problem
    unit = meant[1]
    return column.name, lambda cells: (column.si(cells) - unit.offset) / unit.scale


def _quantity(name: str) -> tuple[str, Unit] | None:
    """Role and unit of a name such as accel_m_s2."""
    for role, one in ROLES.items():
        stem, unit = split_name(name, one.units)
        if unit is not None and stem in one.stems:
            return role, unit
    return None


def check_time(file: Path, name: str, lines: list[int], time_s: np.ndarray) -> None:
    bad = np.flatnonzero(np.diff(time_s) <= 0)
    if bad.size == 0:
        return
    row = int(bad[0]) + 1
    problem = "repeats the time before" if time_s[row] == time_s[row - 1] else "goes back in time"
    raise at(
        file, lines[row],
        f"'{name}' = {time_s[row]:g} s {problem} ({time_s[row - 1]:g} s); sort the rows and drop "
        "duplicates",
    )  # fmt: skip


def check_uniform(
    file: Path, name: str, lines: list[int], time_s: np.ndarray, period_s: float
) -> float:
    """Largest deviation from uniform sampling, in periods."""
    off = np.abs((time_s - time_s[0]) / period_s - np.arange(len(time_s)))
    if off.max() <= MAX_JITTER:
        return float(off.max())
    row = int(np.argmax(np.abs(np.diff(time_s) - period_s))) + 1
    raise at(
        file, lines[row],
        f"sampling is irregular, '{name}' advances by {time_s[row] - time_s[row - 1]:.6g} s where "
        f"the mean is {period_s:.6g} s; cut the recording at the gap or resample it evenly",
    )  # fmt: skip
