"""Recorded columns from a CSV file: read, checked, against uniform time."""

import csv
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.nearest import listed
from quiesce.base.paths import shown
from quiesce.base.progress import reading

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
    """Line numbers and values of the named columns."""
    try:
        with file.open(newline="", encoding="utf-8-sig") as stream:
            lines = stream.readlines()
        rows = csv.reader(reading(shown(file), lines, len(lines)))
        indices = find_columns(file, next(rows, []), names)
        numbered = list(parse_rows(file, rows, names, indices))
    except UnicodeDecodeError:
        raise UsageError(f"{shown(file)}: not a text file; a CSV in UTF-8 is expected")
    except csv.Error as error:
        raise UsageError(f"{shown(file)}: not a CSV file: {error}")
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name a CSV file")
    if len(numbered) < MIN_ROWS:
        raise UsageError(
            f"{shown(file)}: {len(numbered)} rows of data; at least {MIN_ROWS} are needed"
        )
    return [line for line, _ in numbered], np.array([values for _, values in numbered])


def find_columns(file: Path, head: list[str], names: list[str]) -> list[int]:
    head = [name.strip() for name in head]
    if not any(head):
        raise UsageError(f"{shown(file)}: the file is empty; expected a header line and rows")
    for name in names:
        if head.count(name) != 1:
            problem = "no column" if name not in head else "more than one column"
            raise UsageError(f"{shown(file)}: {problem} '{name}'; {listed(name, head)}")
    return [head.index(name) for name in names]


def parse_rows(
    file: Path, rows: Iterator[list[str]], names: list[str], indices: list[int]
) -> Iterator[tuple[int, list[float]]]:
    for row in rows:
        if not any(cell.strip() for cell in row):
            continue
        line = rows.line_num  # type: ignore[attr-defined]
        if len(row) <= max(indices):
            raise UsageError(
                f"{shown(file)} line {line}: {len(row)} cells, too few for column "
                f"'{names[indices.index(max(indices))]}'; every row needs one"
            )
        cells = zip(names, (row[i] for i in indices), strict=True)
        yield line, [parse_number(file, line, name, text) for name, text in cells]


def parse_number(file: Path, line: int, name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        what = f"'{text.strip()}' is not a number" if text.strip() else "an empty cell"
        raise UsageError(f"{shown(file)} line {line}, column '{name}': {what}")
    if not math.isfinite(value):
        raise UsageError(
            f"{shown(file)} line {line}, column '{name}': {text.strip()} is not a finite number; "
            "cut or repair the recording"
        )
    return value


def check_time(file: Path, name: str, lines: list[int], time_s: np.ndarray) -> None:
    bad = np.flatnonzero(np.diff(time_s) <= 0)
    if bad.size == 0:
        return
    at = int(bad[0]) + 1
    problem = "repeats the time before" if time_s[at] == time_s[at - 1] else "goes back in time"
    raise UsageError(
        f"{shown(file)} line {lines[at]}: '{name}' = {time_s[at]:g} s {problem} "
        f"({time_s[at - 1]:g} s); sort the rows and drop duplicates"
    )


def check_uniform(
    file: Path, name: str, lines: list[int], time_s: np.ndarray, period_s: float
) -> float:
    """Largest deviation from uniform sampling, in periods."""
    off = np.abs((time_s - time_s[0]) / period_s - np.arange(len(time_s)))
    if off.max() <= MAX_JITTER:
        return float(off.max())
    at = int(np.argmax(np.abs(np.diff(time_s) - period_s))) + 1
    raise UsageError(
        f"{shown(file)} line {lines[at]}: sampling is irregular, '{name}' advances by "
        f"{time_s[at] - time_s[at - 1]:.6g} s where the mean is {period_s:.6g} s; "
        "cut the recording at the gap or resample it evenly"
    )
