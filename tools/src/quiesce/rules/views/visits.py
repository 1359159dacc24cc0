"""The inputs of a rule base that a run went through, and which rules fired there."""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.engine.trace import Trace, read_trace
from quiesce.rules.views.subject import Subject, strengths
from quiesce.rules.views.surface import input_index
from quiesce.signal.recording import read_columns

# What the controller's own rule base reads, in this order: telemetry, and its scale to Hz, m/s2.
TELEMETRY = (("freq_uHz", 1e-6), ("rms_um_s2", 1e-6))
VALID = "freq_is_valid"
CELLS = 100  # along an axis: visited points are drawn by cell


@dataclass(frozen=True)
class Source:
    """Where an input's values are."""

    column: str
    scale: float


@dataclass(frozen=True)
class Visits:
    name: str  # of the run
    inputs: np.ndarray  # [input, row], in the unit of each
    rows: int  # of the run; fewer are left where only valid ones count
    condition: str  # which rows count, in words; empty: all


@dataclass(frozen=True)
class Fired:
    """How much a rule had to say in a run."""

    share: float  # of the rows in which it fired
    strongest: float  # of the rows in which no rule was stronger
    mean_strength: float  # over the rows in which it fired; 0 where it never did


def read_visits(base: Subject, file: Path, columns: Sequence[str]) -> Visits:
    """From a CSV file with a header line or a trace of the bench.

    columns: `INPUT=COLUMN` or `INPUT=COLUMN*SCALE`. An input without one takes the column of its
    own name; two inputs without any take the controller's telemetry, while its frequency is valid.
    """
    is_trace = starts_like_a_trace(file)
    names = trace_names(file) if is_trace else csv_names(file)
    sources, wants_valid = find_sources(base, file, names, columns)
    needed = [source.column for source in sources] + ([VALID] if wants_valid else [])
    table = read_needed(file, needed, is_trace)
    rows = len(table[needed[0]])
    counted = table[VALID] > 0 if wants_valid else np.ones(rows, dtype=bool)
    if not counted.any():
        raise UsageError(f"{shown(file)}: {VALID} is 0 in every row, so that nothing was visited")
    inputs = np.stack([source.scale * table[source.column][counted] for source in sources])
    return Visits(shown(file), inputs, rows, "frequency valid" if wants_valid else "")


def visits_of_trace(base: Subject, name: str, trace: Trace) -> Visits:
    """Of the controller's telemetry, while its frequency was valid."""
    if len(base.inputs) != len(TELEMETRY):
        raise UsageError(
            f"{base.name} has {len(base.inputs)} inputs; a scenario gives 2, frequency and RMS. "
            "Name a CSV file and --column INPUT=COLUMN*SCALE"
        )
    valid = trace[VALID] > 0
    inputs = np.stack([scale * trace[column][valid] for column, scale in TELEMETRY])
    return Visits(name, inputs, len(valid), "frequency valid")


def starts_like_a_trace(file: Path) -> bool:
    try:
        with file.open("rb") as stream:
            return stream.read(1) == b"{"
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name a CSV file, trace or scenario")


def trace_names(file: Path) -> list[str]:
    try:
        return list(read_trace(file))
    except (ValueError, KeyError, TypeError, IndexError):
        raise UsageError(f"{shown(file)}: starts like a trace of the bench, but is not one")


def csv_names(file: Path) -> list[str]:
    """Of the header line."""
    try:
        with file.open(newline="", encoding="utf-8-sig") as stream:
            return [name.strip() for name in next(csv.reader(stream), [])]
    except (UnicodeDecodeError, csv.Error):
        raise UsageError(f"{shown(file)}: neither a CSV file in UTF-8 nor a trace of the bench")


def read_needed(file: Path, names: Sequence[str], is_trace: bool) -> Trace:
    unique = list(dict.fromkeys(names))
    if is_trace:
        return read_trace(file, unique)
    _, table = read_columns(file, unique)
    return {name: table[:, i] for i, name in enumerate(unique)}


def find_sources(
    base: Subject, file: Path, names: Sequence[str], columns: Sequence[str]
) -> tuple[list[Source], bool]:
    """Of every input, and whether only rows of valid frequency count."""
    given = dict(parse_column(base, text) for text in columns)
    for source in given.values():
        if source.column not in names:
            raise no_column(file, source.column, names)
    by_telemetry = len(base.inputs) == len(TELEMETRY) and not given
    by_telemetry &= all(column in names for column, _ in TELEMETRY)
    by_telemetry &= any(variable.name not in names for variable in base.inputs)
    if by_telemetry:
        return [Source(*pair) for pair in TELEMETRY], VALID in names
    sources = []
    for index, variable in enumerate(base.inputs):
        if index not in given and variable.name not in names:
            hint = f"say which is {variable.name}: --column {variable.name}=COLUMN*SCALE"
            raise no_column(file, variable.name, names, hint)
        sources.append(given.get(index, Source(variable.name, 1.0)))
    return sources, False


def parse_column(base: Subject, text: str) -> tuple[int, Source]:
    name, equals, right = text.partition("=")
    column, star, factor = right.partition("*")
    if not equals or not column:
        raise UsageError(f"--column {text}: expected INPUT=COLUMN or INPUT=COLUMN*SCALE")
    try:
        scale = float(factor) if star else 1.0
    except ValueError:
        raise UsageError(f"--column {text}: '{factor}' is not a number")
    if not np.isfinite(scale) or scale == 0:
        raise UsageError(f"--column {text}: a scale is a finite number other than 0")
    return input_index(base, name), Source(column.strip(), scale)


def no_column(file: Path, column: str, names: Sequence[str], hint: str = "") -> UsageError:
    there = ", ".join(names) or "none"
    return UsageError(
        f"{shown(file)}: no column '{column}'; there are: {there}" + (f"; {hint}" if hint else "")
    )


def fired_rules(base: Subject, visits: Visits) -> list[Fired]:
    """Of every rule."""
    found = strengths(base, visits.inputs)
    greatest = found.max(axis=0, initial=0.0)
    return [
        Fired(
            float((strength > 0).mean()),
            float(((strength > 0) & (strength == greatest)).mean()),
            float(strength[strength > 0].mean()) if (strength > 0).any() else 0.0,
        )
        for strength in found
    ]


def visited_cells(
    base: Subject, visits: Visits, axes: Sequence[int]
) -> tuple[list[np.ndarray], np.ndarray]:
    """Middles of the cells that were visited, along each of the axes, and each cell's share."""
    places = []
    for axis in axes:
        low, high = base.inputs[axis].minimum, base.inputs[axis].maximum
        clamped = np.clip(visits.inputs[axis], low, high)
        places.append(np.minimum((clamped - low) / (high - low) * CELLS, CELLS - 1).astype(int))
    cells, counts = np.unique(np.stack(places), axis=1, return_counts=True)
    middles = [
        base.inputs[axis].minimum
        + (cells[i] + 0.5) / CELLS * (base.inputs[axis].maximum - base.inputs[axis].minimum)
        for i, axis in enumerate(axes)
    ]
    return middles, counts / counts.sum()
