"""The rows of docs/results/papers.md: a file a paper in rows/, a table [[row]] each.

The head of a file says `paper` and, under `equations`, `tables` and `figures`, which numbers the
paper has ("1-24", "I-XI", "2.1-2.20"); every one of them has a row, and a row may hold several.
Keys of a row:

    kind       equation, table or figure
    number     as the paper has it, or a range of them
    what       what it is, in a few words
    places     files, each alone or with `:symbol`; may be left out, see `reason`
    command    what a user types to run it
    part       the part of `./tools/benchmark papers` that makes it; its command is the default
    published  text, a number or a list of numbers
    ours       text; {key} or {key:format} is replaced by what the committed results say (page.py)
    note       where the paper is in error, or its numbers are lost
    reason     why there can be no place
    pending    what has to be built before there is one
"""

import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown

FOLDER = Path(__file__).parent / "rows"
KINDS = {"equation": "equations", "table": "tables", "figure": "figures"}
TEXTS = ("kind", "number", "what", "command", "part", "ours", "note", "reason", "pending")
NEEDED = ("kind", "number", "what")
NUMBER = re.compile(r"(?:(?P<chapter>\d+)\.)?(?P<index>\d+)|(?P<roman>[IVX]+)")
ROMAN = ("I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX", "X", "XI", "XII", "XIII", "XIV")

Published = str | float | tuple[float, ...]
Position = tuple[int, int]  # chapter (0 without), number


@dataclass(frozen=True)
class Row:
    kind: str
    number: str
    what: str
    places: tuple[str, ...] = ()
    command: str = ""
    part: str = ""
    published: Published = ""
    ours: str = ""
    note: str = ""
    reason: str = ""
    pending: str = ""

    @property
    def typed(self) -> str:
        """The command, that of the part where there is no other."""
        return self.command or (f"./tools/benchmark papers --part {self.part}" if self.part else "")

    def is_placed(self, root: Path) -> bool:
        return bool(self.places) and not any(missing(place, root) for place in self.places)


@dataclass(frozen=True)
class Paper:
    name: str  # of its file
    title: str
    ranges: Mapping[str, tuple[str, ...]]  # of numbers, by kind
    rows: tuple[Row, ...]


def papers(folder: Path = FOLDER) -> dict[str, Paper]:
    """All of them by name, sorted; UsageError names file and row where one is wrong."""
    return {file.stem: read(file) for file in sorted(folder.glob("*.toml"))}


def read(file: Path) -> Paper:
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise UsageError(f"{shown(file)}: {one_line(error)}")
    where = shown(file)
    expect(set(table) <= {"paper", "row", *KINDS.values()}, where, "unknown key in the head")
    expect(is_text(table.get("paper")), where, "paper: expected a text")
    ranges = {kind: texts(table.get(key, []), f"{where}: {key}") for kind, key in KINDS.items()}
    tables = table.get("row")
    expect(isinstance(tables, list) and bool(tables), where, "expected tables [[row]]")
    rows = tuple(read_row(one, f"{where}: row {i}") for i, one in enumerate(tables, start=1))
    paper = Paper(file.stem, table["paper"], ranges, rows)
    for kind in KINDS:
        check_numbers(paper, kind, where)
    return paper


def read_row(table: Any, where: str) -> Row:
    expect(isinstance(table, dict), where, "expected a table")
    named = f"{where} ({table.get('kind')} {table.get('number')})"
    for key, value in table.items():
        if key in TEXTS:
            expect(is_text(value), named, f"{key}: expected a text, found {value!r}")
        elif key not in ("places", "published"):
            raise UsageError(f"{named}: {key}: no such key")
    for key in NEEDED:
        expect(key in table, named, f"{key} is missing")
    expect(table["kind"] in KINDS, named, f"kind: expected one of {', '.join(KINDS)}")
    positions(table["number"], named)
    places = texts(table.get("places", []), f"{named}: places")
    published = read_published(table.get("published", ""), f"{named}: published")
    rest = {key: table[key] for key in TEXTS if key in table}
    return Row(places=places, published=published, **rest)


def read_published(value: Any, where: str) -> Published:
    if isinstance(value, list):
        expect(bool(value) and all(map(is_number, value)), where, "expected numbers")
        return tuple(float(one) for one in value)
    expect(isinstance(value, str) or is_number(value), where, "expected a text or numbers")
    return value if isinstance(value, str) else float(value)


def texts(value: Any, where: str) -> tuple[str, ...]:
    good = isinstance(value, list) and all(map(is_text, value))
    expect(good, where, f"expected a list of texts, found {value!r}")
    return tuple(value)


def is_text(value: Any) -> bool:
    return isinstance(value, str) and bool(value) and "\n" not in value


def is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def expect(is_good: bool, where: str, words: str) -> None:
    if not is_good:
        raise UsageError(f"{where}: {words}")


def positions(text: str, where: str) -> list[Position]:
    """The numbers of "7", "VII", "2.7" or a range of them, "2.7-2.9"."""
    ends = [position(one, where) for one in text.split("-")]
    first, last = ends[0], ends[-1]
    if len(ends) > 2 or first[0] != last[0] or first[1] > last[1]:
        raise UsageError(f"{where}: number: {text} is no number and no range of them")
    return [(first[0], index) for index in range(first[1], last[1] + 1)]


def position(text: str, where: str) -> Position:
    found = NUMBER.fullmatch(text)
    if found is None or (found["roman"] and text not in ROMAN):
        raise UsageError(f"{where}: number: {text!r} is none")
    if found["roman"]:
        return 0, ROMAN.index(text) + 1
    return int(found["chapter"] or 0), int(found["index"])


def check_numbers(paper: Paper, kind: str, where: str) -> None:
    """Every number that the head declares has a row, and no other has one."""
    declared = {one for text in paper.ranges[kind] for one in positions(text, f"{where}: {kind}s")}
    rows = [row for row in paper.rows if row.kind == kind]
    held = {one for row in rows for one in positions(row.number, where)}
    for words, numbers in (
        ("has no row", declared - held),
        ("is not in the head", held - declared),
    ):
        if numbers:
            chapter, index = min(numbers)
            shown_number = f"{chapter}.{index}" if chapter else f"{index}"
            raise UsageError(f"{where}: {kind} {shown_number} {words}")
    for (number, _), times in Counter((row.number, row.what) for row in rows).items():
        expect(times == 1, where, f"{kind} {number} is there {times} times with the same words")


def missing(place: str, root: Path) -> str:
    """Why a place is none, in a few words; empty where it is one."""
    path, _, symbol = place.partition(":")
    file = root / path
    if not file.exists():
        return f"{path}: no such file"
    if not symbol:
        return ""
    if not file.is_file():
        return f"{path}: is a folder, it holds no {symbol}"
    is_there = re.search(rf"(?<!\w){re.escape(symbol)}(?!\w)", file.read_text(errors="replace"))
    return "" if is_there else f"{path}: holds no {symbol}"


def without_place(paper: Paper, root: Path) -> Iterator[Row]:
    """Rows with neither a place in this tree nor a reason, nor a word of what they wait for."""
    known = (row for row in paper.rows if not row.reason and not row.pending)
    return (row for row in known if not row.is_placed(root))
