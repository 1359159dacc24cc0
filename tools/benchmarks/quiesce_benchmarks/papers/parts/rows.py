"""How much of the five papers has a place here: the rows of docs/results/papers.md."""

from collections.abc import Iterator
from pathlib import Path

from quiesce.base.paths import root
from quiesce.base.table import format_table

from quiesce_benchmarks.papers.commands import refused
from quiesce_benchmarks.papers.rows import KINDS, Paper, Row, missing, papers, without_place
from quiesce_benchmarks.part import Effort, Measured

TITLE = "rows of the five papers: places and commands"
FIGURES = (
    ("rows", "1", None, "higher"),
    ("rows_without_place", "1", 0.0, "lower"),  # nor a reason
    ("rows_pending", "1", 0.0, "lower"),  # what they need is to be built
    ("commands_refused", "1", 0.0, "lower"),  # rows whose command cannot be typed
)


def measure(effort: Effort) -> Measured:
    tree, found = root(), papers()
    bare = {name: list(without_place(paper, tree)) for name, paper in found.items()}
    wrong = {name: list(refusals(paper, tree)) for name, paper in found.items()}
    values = {
        "rows": float(sum(len(paper.rows) for paper in found.values())),
        "rows_without_place": float(sum(map(len, bare.values()))),
        "rows_pending": float(sum(bool(row.pending) for one in found.values() for row in one.rows)),
        "commands_refused": float(sum(map(len, wrong.values()))),
    }
    lines = [
        [name, label(row), why]
        for name in found
        for row, why in [*reasons(bare[name], tree), *wrong[name]]
    ]
    reported = {
        "without_place": {name: [label(row) for row in rows] for name, rows in bare.items()}
    }
    tables = (
        (format_table(["paper", "row", "what is wrong"], lines, left=(0, 1, 2)),) if lines else ()
    )
    return Measured(values, reported, tables)


def refusals(paper: Paper, tree: Path) -> Iterator[tuple[Row, str]]:
    for row in paper.rows:
        why = refused(row.typed, tree) if row.typed else ""
        if why:
            yield row, why


def reasons(rows: list[Row], tree: Path) -> Iterator[tuple[Row, str]]:
    for row in rows:
        wrong = [why for place in row.places if (why := missing(place, tree))]
        yield row, "; ".join(wrong) or f"no place{f', comes with {row.part}' if row.part else ''}"


def label(row: Row) -> str:
    return f"{row.kind if row.kind in KINDS else ''} {row.number}"
