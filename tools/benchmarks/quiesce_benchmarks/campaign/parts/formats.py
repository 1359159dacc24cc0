"""Formats that a recording may come in: how many are read as what they are."""

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from quiesce.base.errors import UsageError, one_line
from quiesce.base.table import format_table
from quiesce.recording.beside import proposed, stated_beside
from quiesce.recording.columns import find_columns
from quiesce.recording.open import open_table
from quiesce.recording.units import LENGTH

from quiesce_benchmarks.campaign.written import WRITERS, recording
from quiesce_benchmarks.part import Effort, Measured

TITLE = "recordings of other programs"
FIGURES = (("formats_ok", "1", float(len(WRITERS)), "higher"),)
TOLERANCE = 1e-9  # of the largest value of a column


@dataclass(frozen=True)
class Verdict:
    """trouble: empty where every column came back with its unit."""

    format: str
    trouble: str

    @property
    def is_ok(self) -> bool:
        return not self.trouble


def measure(_: Effort) -> Measured:
    count, verdicts = formats_ok()
    rows = [[one.format, one.trouble or "read as it is"] for one in verdicts]
    table = format_table(["format", "every column with its unit"], rows, left=(0, 1))
    return Measured({"formats_ok": float(count)}, {"formats": len(verdicts)}, (table,))


def formats_ok() -> tuple[int, list[Verdict]]:
    """How many formats are read, and what each came to: written into a folder of its own, its
    columns found by their names (or as quiesce itself proposes), compared in SI units."""
    verdicts = []
    with tempfile.TemporaryDirectory(prefix="quiesce-formats-") as folder:
        for name, (file, write) in WRITERS.items():
            write(Path(folder) / file, recording())
            verdicts.append(Verdict(name, trouble_with(Path(folder) / file)))
    return sum(one.is_ok for one in verdicts), verdicts


def trouble_with(file: Path) -> str:
    wanted = recording()
    wanted["displacement"] = wanted["displacement"] * LENGTH["mm"].scale
    try:
        found = read(file)
    except UsageError as error:
        return one_line(error)
    for role, values in wanted.items():
        if role not in found:
            return f"no {role}"
        off = np.abs(found[role] - values).max() if len(found[role]) == len(values) else np.inf
        if not off <= TOLERANCE * np.abs(values).max():
            return f"{role} is off by {off:.3g}"
    return ""


def read(file: Path) -> dict[str, np.ndarray]:
    """SI values by role; with quiesce's own proposal where names alone do not tell."""
    table = open_table(file)
    try:
        columns = find_columns(table, stated_beside(file))
    except UsageError as error:
        proposed(table, error)
        columns = find_columns(table, stated_beside(file))
    _, cells = table.numbers([column.name for column in columns.values()])
    return {role: column.si(cells[:, i]) for i, (role, column) in enumerate(columns.items())}
