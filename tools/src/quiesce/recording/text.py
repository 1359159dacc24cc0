"""A delimited text file: its separator and decimal mark found, every cell that is used checked.

Errors name the file's line (1-based), say what is there and what to do.
"""

import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.base.progress import reading
from quiesce.recording.table import MAX_VALUE, Table, at, clipped

MAX_BYTES = 400_000_000
SEPARATORS = {"\t": "tabs", ";": "semicolons", ",": "commas"}
_KINDS = {
    b"\x89PNG": "a PNG image",
    b"\xff\xd8\xff": "a JPEG image",
    b"GIF8": "a GIF image",
    b"%PDF": "a PDF document",
    b"PK\x03\x04": "a spreadsheet or ZIP archive",
    b"\xd0\xcf\x11\xe0": "an old Excel or Office file",
    b"\x1f\x8b": "a gzip archive",
    b"MATLAB 5.0": "a MATLAB file",
    b"\x89HDF": "an HDF5 file (MATLAB 7.3?)",
    b"TDSm": "a TDMS file",
    b"\xff\xfe": "text in UTF-16",
    b"\xfe\xff": "text in UTF-16",
}
_NUMBER = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eEdD][+-]?\d+)?")
_EXPORT = "export it as CSV: one header line with names and units, numbers below, UTF-8"


@dataclass(frozen=True)
class TextTable(Table):
    file: Path
    separator: str
    head: list[str]
    head_line: int  # of the header in the file
    body: list[str]  # the lines below the header

    @property
    def note(self) -> str:
        return "" if self.separator == "," else f"columns separated by {SEPARATORS[self.separator]}"

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Line in the file and cells, blank lines left out."""
        lines = reading(shown(self.file), self.body, len(self.body))
        reader = csv.reader(lines, delimiter=self.separator, skipinitialspace=True)
        line = self.head_line
        while True:
            try:
                cells = next(reader)
            except StopIteration:
                return
            except csv.Error as error:
                line = self.head_line + reader.line_num
                raise at(self.file, line, f"not a line of CSV ({error}); {_EXPORT}")
            line = self.head_line + reader.line_num
            if any(cell.strip() for cell in cells):
                yield line, self.checked(line, cells)

    def checked(self, line: int, cells: list[str]) -> list[str]:
        width = len(self.head)
        while len(cells) > width and not cells[-1].strip():
            cells = cells[:-1]
        if len(cells) == width:
            return cells
        hint = "repair or drop this line; is the file cut short?"
        if len(cells) > width and self.separator == ",":
            hint = "decimal commas need semicolons between the columns"
        raise at(
            self.file, line,
            f"{len(cells)} cells where the header has {width} columns; {hint}",
        )  # fmt: skip

    def texts(self, names: list[str]) -> list[tuple[str, ...]]:
        indices = [self.index(name) for name in names]
        return [tuple(cells[i].strip() for i in indices) for _, cells in self.rows()]

    def numbers(self, names: list[str]) -> tuple[np.ndarray, np.ndarray]:
        """Lines [n] and values [n, columns] of the named columns; finite numbers only."""
        indices = [self.index(name) for name in names]
        rows = [(line, [cells[i] for i in indices]) for line, cells in self.rows()]
        lines = np.array([line for line, _ in rows], dtype=int)
        values = plain_numbers([cells for _, cells in rows], len(names))
        if values is not None:
            return lines, values
        marks: set[str] = set()
        checked = [
            [
                self.number(line, name, text.strip(), marks)
                for name, text in zip(names, cells, strict=True)
            ]
            for line, cells in rows
        ]
        return lines, np.array(checked, dtype=float).reshape(-1, len(names))

    def number(self, line: int, name: str, text: str, marks: set[str]) -> float:
        if not _NUMBER.fullmatch(text):
            raise self.not_a_number(line, name, text)
        for mark in ",.":
            if mark in text:
                marks.add(mark)
        if len(marks) == 2:
            raise at(
                self.file, line,
                f"column '{clipped(name)}': '{clipped(text)}' mixes decimal commas and decimal "
                "points in one file; export it with one of them and without thousands marks",
            )  # fmt: skip
        value = float(text.replace(",", ".").replace("d", "e").replace("D", "e"))
        if abs(value) > MAX_VALUE:
            raise at(
                self.file,
                line,
                f"column '{clipped(name)}': {clipped(text)} is no measured value; drop this line",
            )
        return value

    def not_a_number(self, line: int, name: str, text: str) -> UsageError:
        if not text:
            what, hint = "an empty cell", "fill it or drop the rows around it"
        elif text.lower().lstrip("+-") in ("nan", "inf", "infinity", "na", "n/a", "null", "none"):
            what, hint = f"'{clipped(text)}'", "cut these rows or repair the recording"
        elif line == self.head_line + 1:
            what = f"'{clipped(text)}' is not a number"
            hint = "is this a line of units? Delete it and write them as NAME:UNIT or in the header"
        else:
            what, hint = f"'{clipped(text)}' is not a number", "repair or drop this line"
        return at(self.file, line, f"column '{clipped(name)}': {what}; {hint}")


def plain_numbers(rows: list[list[str]], width: int) -> np.ndarray | None:
    """All cells at once where none needs a closer look, else None: one cell at a time then."""
    if any("_" in text for cells in rows for text in cells):
        return None
    try:
        values = np.array(rows, dtype=float).reshape(-1, width)
    except ValueError:
        return None
    return values if np.all(np.abs(values) <= MAX_VALUE) else None


def open_text(file: Path, skip_lines: int = 0, least: int = 2) -> TextTable:
    """Header and lines of a text file. UsageError for anything that is no table.

    `skip_lines` lines come before the header; blank ones and those that begin with # or % are
    passed over there. least: columns that it must have; with fewer the separator is another one.
    """
    lines = re.split(r"\r\n|\n|\r", read_text(file))
    first = skip_lines
    while first < len(lines) and (not lines[first].strip() or lines[first].lstrip()[0] in "#%"):
        first += 1
    if first >= len(lines):
        raise at(file, 1, f"no header line; {_EXPORT}")
    head = lines[first]
    if head.lstrip()[0] in "{[<":
        raise at(file, first + 1, f"this is JSON or markup, not CSV; {_EXPORT}")
    separator = max(SEPARATORS, key=head.count)
    names = header_names(file, first + 1, head, separator, least)
    return TextTable(file, separator, names, first + 1, lines[first + 1 :])


def header_names(file: Path, line: int, head: str, separator: str, least: int) -> list[str]:
    try:
        names = [name.strip() for name in next(csv.reader([head], delimiter=separator))]
    except (csv.Error, StopIteration):
        raise at(file, line, f"not a header line; {_EXPORT}")
    while len(names) > 1 and not names[-1]:
        names.pop()
    if len([name for name in names if name]) < least:
        raise at(
            file, line,
            f"one column only, '{clipped(head)}'; expected a header line with at least two names "
            "between commas, semicolons or tabs (--skip-lines N passes over lines above it)",
        )  # fmt: skip
    if any(_NUMBER.fullmatch(name) for name in names):
        raise at(
            file, line,
            f"no header line: '{clipped(head)}' has numbers; put one line of names above it "
            "(such as t_s,x_mm,force_N)",
        )  # fmt: skip
    return names


def read_text(file: Path) -> str:
    try:
        size = file.stat().st_size
        if size > MAX_BYTES:
            raise UsageError(
                f"{shown(file)}: {size / 1e6:.0f} MB; at most {MAX_BYTES / 1e6:.0f} MB are read; "
                "cut the recording or lower its rate"
            )
        data = file.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UsageError(f"{clipped(shown(file), 200)}: {reason}; name a CSV file")
    if not data.strip():
        raise at(file, 1, f"the file is empty; {_EXPORT}")
    for magic, kind in _KINDS.items():
        if data.startswith(magic):
            raise at(file, 1, f"this is {kind}, not CSV; {_EXPORT}")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise at(file, line, f"not text in UTF-8; {_EXPORT}")
    if "\0" in text:
        raise at(file, text.count("\n", 0, text.index("\0")) + 1, f"a binary file; {_EXPORT}")
    return text
