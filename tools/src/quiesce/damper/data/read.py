"""Tests of a file: rows told apart, columns in SI units, time checked; nothing filtered yet."""

from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.damper.data.check import MIN_ROWS, Piece, check_constant, check_rows, pieces_of
from quiesce.recording.beside import proposed, stated_beside
from quiesce.recording.columns import Column, ColumnSpec, find_columns
from quiesce.recording.open import open_table
from quiesce.recording.table import Table, at, clipped
from quiesce.recording.units import FREQUENCY, split_name


@dataclass(frozen=True)
class OutputAverage:
    """The moving average that a file's force went through: over `periods` of the frequency in a
    column, or over `seconds`."""

    periods: float = 0.0
    frequency_column: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Columns:
    """How to read a file. A role given as None is not looked for; see columns.ROLES."""

    given: dict[str, ColumnSpec | None] = field(default_factory=dict)
    rate_Hz: float | None = None  # of a file without a time column
    current_A: float | None = None  # of a file without a column of current or voltage
    flip_force: bool = False
    group: tuple[str, ...] = ()
    average: OutputAverage | None = None
    split_gaps: bool = False
    may_be_uneven: bool = False
    skip_lines: int = 0


@dataclass(frozen=True)
class RawTest:
    """One uninterrupted test as measured; `si` by role, in SI units."""

    name: str
    where: str  # FILE:LINE of its first row and what tells it apart, for messages
    period_s: float
    jitter: float
    time_s: np.ndarray
    si: dict[str, np.ndarray]
    average_s: float


@dataclass(frozen=True)
class RawFile:
    file: Path
    columns: dict[str, Column]
    tests: list[RawTest]
    notes: list[str]


def read_file(file: Path, how: Columns) -> RawFile:
    """Every test in the file. UsageError for anything that cannot be fitted."""
    table = open_table(file, how.skip_lines)
    found = table_columns(table, how)
    average = average_column(table, how)
    names = [column.name for column in found.values()] + ([average] if average else [])
    lines, cells = table.numbers(names)
    check_rows(table, lines)
    si = {column.role: column.si(cells[:, i]) for i, column in enumerate(found.values())}
    if how.flip_force:
        si["force"] = -si["force"]
    if "time" not in si:
        si["time"] = np.arange(len(lines)) / how.rate_Hz
    tests: list[RawTest] = []
    notes = file_notes(table, found, how)
    for label, first, end in group_spans(table, how.group, lines):
        part = {role: values[first:end] for role, values in si.items()}
        spans = time_pieces(table, lines[first:end], part["time"], how)
        for number, piece in enumerate(spans):
            rows = slice(first + piece.first, first + piece.end)
            seconds = average_seconds(table, lines[rows], cells[rows, -1], how)
            name = shown(file) + label + (f" part {number + 1}" if len(spans) > 1 else "")
            tests.append(raw_test(table, found, lines, si, rows, piece, name, seconds))
    dropped = len(lines) - sum(len(test.time_s) for test in tests)
    if dropped:
        notes.append(f"{dropped} rows left out: stretches of fewer than {MIN_ROWS} between gaps")
    return RawFile(file, found, tests, notes)


def table_columns(table: Table, how: Columns) -> dict[str, Column]:
    given = {**stated_beside(table.file), **how.given}
    if how.rate_Hz is not None:
        if how.given.get("time"):
            raise UsageError(
                "a time column and --rate-hz exclude each other; --work-rate-hz sets the rate "
                "of the records"
            )
        given["time"] = None
    elif "time" in given and given["time"] is None:
        raise UsageError("--time none needs --rate-hz, the sampling rate")
    if how.current_A is not None:
        if how.given.get("current") or how.given.get("command"):
            raise UsageError("a column for the command and --current-a exclude each other")
        given |= {"current": None, "command": None}
    try:
        return find_columns(table, given)
    except UsageError as error:
        hint = "; without a time column, state the sampling rate with --rate-hz"
        told = UsageError(f"{error}{hint}") if "the time;" in str(error) else error
        raise told if how.given else proposed(table, told)


def file_notes(table: Table, found: dict[str, Column], how: Columns) -> list[str]:
    notes = ["columns: " + ", ".join(str(column) for column in found.values())]
    if "time" not in found:
        notes.append(f"no time column: rows at {how.rate_Hz:g} Hz as stated")
    if how.flip_force:
        notes.append("the sign of the force is turned, as asked")
    if how.current_A is not None:
        notes.append(f"current stated: {how.current_A:g} A throughout")
    elif "current" not in found and "command" not in found:
        notes.append(
            "no column of current or voltage: the command is taken as 0 A throughout (--current, "
            "--command or --current-a state it)"
        )
    return [*notes, *([table.note] if table.note else [])]


def group_spans(
    table: Table, group: tuple[str, ...], lines: np.ndarray
) -> list[tuple[str, int, int]]:
    """Label, first and end of each run of rows with the same cells in the group's columns."""
    if not group:
        return [("", 0, len(lines))]
    spans, first = [], 0
    for key, run in groupby(table.texts(list(group))):
        end = first + sum(1 for _ in run)
        if end - first < MIN_ROWS:
            raise at(
                table.file, int(lines[first]),
                f"--group {','.join(group)}: only {end - first} rows here have the same value, "
                f"at least {MIN_ROWS} are needed; name columns that are constant within a test",
            )  # fmt: skip
        cells = (f"{clipped(n)}={clipped(v)}" for n, v in zip(group, key, strict=True))
        spans.append((" " + " ".join(cells), first, end))
        first = end
    return numbered(spans)


def numbered(spans: list[tuple[str, int, int]]) -> list[tuple[str, int, int]]:
    """A label that comes again gets a number, so that names are unique."""
    seen: dict[str, int] = {}
    out = []
    for label, first, end in spans:
        seen[label] = seen.get(label, 0) + 1
        out.append((label if seen[label] == 1 else f"{label} #{seen[label]}", first, end))
    return out


def time_pieces(table: Table, lines: np.ndarray, time_s: np.ndarray, how: Columns) -> list[Piece]:
    if how.rate_Hz is not None:
        return [Piece(0, len(lines), 1.0 / how.rate_Hz, 0.0)]
    return pieces_of(table, lines, time_s, how.split_gaps, how.may_be_uneven)


def raw_test(
    table: Table, found: dict[str, Column], lines: np.ndarray, si: dict[str, np.ndarray],
    rows: slice, piece: Piece, name: str, average_s: float,
) -> RawTest:  # fmt: skip
    values = {role: column[rows] for role, column in si.items() if role != "time"}
    for role in ("displacement", "velocity", "force"):
        if role in values:
            check_constant(table, int(lines[rows][0]), role, found[role].name, values[role])
    return RawTest(
        where=f"{shown(table.file)}:{lines[rows][0]}{name.removeprefix(shown(table.file))}",
        name=name, period_s=piece.period_s, jitter=piece.jitter,
        time_s=si["time"][rows], si=values, average_s=average_s,
    )  # fmt: skip


# The moving average


def average_column(table: Table, how: Columns) -> str | None:
    if how.average is None or not how.average.frequency_column:
        return None
    name = how.average.frequency_column
    table.index(name)
    if split_name(name, FREQUENCY)[1] is None:
        raise at(
            table.file, table.head_line,
            f"column '{clipped(name)}' of output_average does not end in _Hz; its values are "
            "taken in Hz: rename it",
        )  # fmt: skip
    return name


def average_seconds(table: Table, lines: np.ndarray, cells: np.ndarray, how: Columns) -> float:
    """Length of the moving average in one test; 0 for none."""
    if how.average is None:
        return 0.0
    if not how.average.frequency_column:
        return how.average.seconds
    if np.ptp(cells) > 0.0 or cells[0] <= 0.0:
        raise at(
            table.file, int(lines[0]),
            f"column '{how.average.frequency_column}' has to hold one frequency above 0 Hz in "
            "each test; name it in --group, too",
        )  # fmt: skip
    return how.average.periods / float(cells[0])
