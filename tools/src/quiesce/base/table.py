"""Text tables, the same on a terminal and in a log.

Laid out here and not by rich, which takes 150 us a cell; a list of rules has thousands.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import zip_longest
from typing import Any


def format_table(
    head: Sequence[str],
    rows: Iterable[Sequence[Any] | str],
    left: Collection[int] = (0,),
    gap: int = 2,
) -> str:
    """Columns `gap` blanks apart; those in `left` flush left, the others flush right.

    A head may have lines, and end in how its cells are written: "speed m/s||.3f", or, with the unit
    in each cell, "speed||.3f m/s". A cell that is a text stays as it is, None is a dash. A row that
    is a text is the heading of a group.
    """
    names, specs = zip(*(title.partition("||")[::2] for title in head), strict=True)
    body = [row if isinstance(row, str) else _cells(row, specs) for row in rows]
    titles = _stacked(names)
    columns = zip(*titles, *(row for row in body if not isinstance(row, str)), strict=True)
    widths = [max(map(len, column)) for column in columns]

    def line(cells: Sequence[str] | str) -> str:
        if isinstance(cells, str):
            return cells
        padded = (
            cell.ljust(width) if i in left else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(cells, widths, strict=True))
        )
        return (" " * gap).join(padded).rstrip()

    return "\n".join(map(line, [*titles, ["-" * width for width in widths], *body]))


def _stacked(names: Sequence[str]) -> list[Sequence[str]]:
    """Their lines, the last ones side by side."""
    upward = zip_longest(*(name.split("\n")[::-1] for name in names), fillvalue="")
    return list(upward)[::-1]


def _cells(row: Sequence[Any], specs: Sequence[str]) -> list[str]:
    return [_cell(value, *spec.partition(" ")) for value, spec in zip(row, specs, strict=True)]


def _cell(value: Any, spec: str, blank: str, unit: str) -> str:
    if value is None:
        return "-"
    return value if isinstance(value, str) else f"{value:{spec}}{blank}{unit}"


def format_pairs(pairs: Mapping[str, Any]) -> str:
    """A line each: the name, and two blanks after the longest of them what it is."""
    width = max(map(len, pairs), default=0)
    return "\n".join(f"{name:{width}}  {value}" for name, value in pairs.items())
