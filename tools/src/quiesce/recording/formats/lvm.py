"""LabVIEW measurement files: text with a head for the file, one for each segment, and rows."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.recording.arrays import ArrayTable, with_unit
from quiesce.recording.table import Table, at, clipped
from quiesce.recording.text import read_text

KIND = "LabVIEW measurement file"
MAGIC = "LabVIEW Measurement"
END = "***End_of_Header***"
SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";"}


@dataclass(frozen=True)
class _Text:
    """Lines of the file, in cells, and how its head says they are written."""

    file: Path
    lines: list[str]
    separator: str
    decimal: str

    def cells(self, line: int) -> list[str]:
        """line: from 1."""
        return [cell.strip() for cell in self.lines[line - 1].split(self.separator)]

    def number(self, line: int, name: str, cell: str) -> float:
        try:
            return float(cell.replace(self.decimal, "."))
        except ValueError:
            what = f"'{clipped(cell)}' is not a number" if cell else "an empty cell"
            raise at(self.file, line, f"column '{clipped(name)}': {what}; repair or drop this line")


def read(file: Path) -> Table:
    """Channels by their names and the units of the segment's head, and time in s: the column of X,
    or X0 and Delta_X where there is none. Of several segments with the same channels the rows
    follow each other."""
    text, first = _opened(file)
    heads: list[list[str]] = []
    rows: list[list[float]] = []
    line = first
    while (start := _next_head(text, line)) is not None:
        names, found, line = _segment(text, start)
        heads.append(names)
        rows += found
    if not rows:
        raise at(file, len(text.lines), "no rows of data after the heads; export it again")
    if any(names != heads[0] for names in heads):
        raise UsageError(f"{file.name}: its segments have different channels; export one of them")
    return ArrayTable(file, heads[0], list(np.array(rows).T), KIND)


def _opened(file: Path) -> tuple[_Text, int]:
    """And the line after the file's head."""
    lines = read_text(file).splitlines()
    if not lines[0].startswith(MAGIC):
        raise at(file, 1, f"no {KIND}: it does not begin with '{MAGIC}'; export it again")
    if END not in (line.strip() for line in lines):
        raise at(file, len(lines), "the head has no end; is the file cut short?")
    words = lines[0][len(MAGIC) :]
    separator = words[:1] if words[:1] in ("\t", ",", ";") else "\t"
    text = _Text(file, lines, separator, ".")
    end = next(i for i, line in enumerate(lines, 1) if line.strip().startswith(END))
    head = {cells[0]: cells[1] for i in range(1, end) if len(cells := text.cells(i)) > 1}
    separator = SEPARATORS.get(head.get("Separator", "").lower(), separator)
    return _Text(file, lines, separator, head.get("Decimal_Separator", ".")[:1] or "."), end + 1


def _next_head(text: _Text, line: int) -> int | None:
    """Where a segment's head begins."""
    for i in range(line, len(text.lines) + 1):
        if text.cells(i)[0] == "Channels":
            return i
    return None


def _segment(text: _Text, start: int) -> tuple[list[str], list[list[float]], int]:
    """Names with units, rows with time first, and the line after them."""
    head: dict[str, list[str]] = {}
    line = start
    while line <= len(text.lines) and not text.cells(line)[0].startswith(END):
        key, *values = text.cells(line)
        head[key] = values
        line += 1
    if line >= len(text.lines):
        raise at(text.file, len(text.lines), "a segment without rows; is the file cut short?")
    names_line = line + 1
    titles = text.cells(names_line)
    has_x = bool(titles) and titles[0].startswith("X_Value")
    count = _count(text, start, head)
    names = titles[1 : count + 1] if has_x or titles[0] == "" else titles[:count]
    if len(names) < count or not all(names):
        raise at(text.file, names_line, f"{count} channels and not as many names; export it again")
    units = head.get("Y_Unit_Label", [])
    labels = [with_unit(n, u) for n, u in zip(names, units + [""] * count, strict=False)]
    rows, line = _rows(text, names_line + 1, head, names)
    return ["time [s]", *labels], rows, line


def _count(text: _Text, line: int, head: dict[str, list[str]]) -> int:
    word = next(iter(head.get("Channels", [])), "")
    if not word.isdecimal() or not 1 <= int(word) <= 10_000:
        raise at(text.file, line, f"Channels '{clipped(word)}': expected a number from 1 on")
    return int(word)


def _rows(
    text: _Text, line: int, head: dict[str, list[str]], names: list[str]
) -> tuple[list[list[float]], int]:
    rows: list[list[float]] = []
    x_of_head: tuple[float, float] | None = None
    while line <= len(text.lines):
        cells = text.cells(line)
        if cells[0].startswith(("***", "Channels")) or not any(cells):
            break
        # One column of X before the channels, empty where the head has X0 and Delta_X.
        if len(cells) < len(names) + 1:
            raise at(
                text.file, line,
                f"{len(cells)} cells for time and {len(names)} channels; is the file cut short?",
            )  # fmt: skip
        if cells[0]:
            x_s = text.number(line, "X_Value", cells[0])
        else:
            x_of_head = x_of_head or _start_and_step_s(text, head)
            x_s = x_of_head[0] + len(rows) * x_of_head[1]
        values = [text.number(line, n, c) for n, c in zip(names, cells[1:], strict=False)]
        rows.append([x_s, *values])
        line += 1
    return rows, line


def _start_and_step_s(text: _Text, head: dict[str, list[str]]) -> tuple[float, float]:
    start, step = (next(iter(head.get(key, [])), "") for key in ("X0", "Delta_X"))
    line = next(i for i in range(1, len(text.lines) + 1) if text.cells(i)[0] == "Channels")
    return text.number(line, "X0", start or "0"), text.number(line, "Delta_X", step)
