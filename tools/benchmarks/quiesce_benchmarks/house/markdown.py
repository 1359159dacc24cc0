"""Tables and numbers as pages show them."""

from collections.abc import Sequence


def markdown(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [line_of(head), "|" + "---|" * len(head), *map(line_of, rows)]
    return "".join(f"{line}\n" for line in lines)


def line_of(cells: Sequence[str]) -> str:
    return "|" + "".join(f" {cell} |" if cell else " |" for cell in cells)


def number(value: float | None, digits: int = 1) -> str:
    # + 0.0: no minus sign on a value that rounds to zero.
    return "" if value is None else f"{round(value, digits) + 0.0:.{digits}f}"


def count(value: float) -> str:
    return f"{value:,.0f}"
