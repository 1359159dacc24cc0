"""`quiesce table diff A B`: what differs, in the terms of their kind."""

import argparse
import json
import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from difflib import SequenceMatcher
from itertools import zip_longest
from pathlib import Path

from quiesce.base.errors import EXIT_FAILED
from quiesce.base.paths import shown
from quiesce.cli.table.contents import board_text, contents_of, kind_of, kind_text
from quiesce.cli.terminal import show
from quiesce.table.file import TableFile, read_file

EPILOG = """examples:
  quiesce table diff build/laws/skyhook.table build/laws/tuned.table
  quiesce table diff shipped.phase.table mine.phase.table --json

Lines of `quiesce table show` that are in one of them only, under the line that their part begins
with; where those are the same, words by their place, from 0.

Exit codes: 0 the same table for the same board; 1 they differ; 2 one cannot be read.
"""
MOST_WORDS_TOLD = 8
FOLLOWING = (1, 2)  # words that follow from the others: CRC and size


@dataclass(frozen=True)
class Part:
    """Of what they say: its first line, and what only one of them has."""

    heading: str
    removed: list[str]
    added: list[str]


@dataclass(frozen=True)
class Difference:
    kinds: tuple[str, str]
    boards: tuple[str, str]
    sizes: tuple[int, int]  # words
    places: list[int]  # of words that differ
    parts: list[Part]

    @property
    def is_same(self) -> bool:
        return not self.places and self.boards[0] == self.boards[1]


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "diff",
        help="what differs between two",
        description="Compare two table files.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("a", type=Path, metavar="A", help="table file")
    parser.add_argument("b", type=Path, metavar="B", help="another one")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


def lines_of(text: str) -> list[tuple[str, str]]:
    """Each line with the first one of its paragraph; the width of columns does not count."""
    out = []
    heading = ""
    for line in text.splitlines():
        cells = re.sub(" {2,}", "  ", line.strip())
        heading = (heading or cells) if cells else ""
        if cells.strip("- "):
            out.append((heading, cells))
    return out


def parts_of(a: str, b: str) -> Iterator[Part]:
    old, new = lines_of(a), lines_of(b)
    for what, i, k, m, n in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        if what != "equal":
            heading = (old[i:k] or new[m:n])[0][0]
            yield Part(heading, [one[1] for one in old[i:k]], [one[1] for one in new[m:n]])


def difference(files: tuple[Path, Path], tables: tuple[TableFile, TableFile]) -> Difference:
    """UsageError where one is damaged."""
    texts = [contents_of(file, table) for file, table in zip(files, tables, strict=True)]
    one, other = (table.words for table in tables)
    same_kind = kind_of(one) == kind_of(other)
    return Difference(
        (kind_text(one), kind_text(other)),
        (board_text(tables[0].board), board_text(tables[1].board)),
        (len(one), len(other)),
        [i for i, (x, y) in enumerate(zip_longest(one, other)) if x != y and i not in FOLLOWING],
        list(parts_of(*texts)) if same_kind else [],
    )


def text(args: argparse.Namespace, found: Difference, tables: tuple[TableFile, TableFile]) -> str:
    names = f"{shown(args.a)}, {shown(args.b)}"
    if found.is_same:
        return f"{names}: the same, {found.kinds[0]}"
    lines = [f"{names}: {_both(found.kinds)}; {_counted(len(found.places))}"]
    if found.boards[0] != found.boards[1]:
        lines.append(f"board {_both(found.boards)}")
    if found.sizes[0] != found.sizes[1]:
        lines.append(f"words {_both(found.sizes)}")
    heading = ""
    for part in found.parts:
        if part.heading != heading:
            heading = part.heading
            lines += ["", heading]
        lines += [f"- {one}" for one in part.removed] + [f"+ {one}" for one in part.added]
    if not found.parts and found.kinds[0] == found.kinds[1]:
        lines += _word_lines(found, tables)
    return "\n".join(lines)


def _counted(count: int) -> str:
    return f"{count} words differ" if count != 1 else "1 word differs"


def _both(pair: tuple[object, object]) -> str:
    return str(pair[0]) if pair[0] == pair[1] else f"{pair[0]} and {pair[1]}"


def _word_lines(found: Difference, tables: tuple[TableFile, TableFile]) -> list[str]:
    lines = [
        f"word {place}: " + ", ".join(_word(table, place) for table in tables)
        for place in found.places[:MOST_WORDS_TOLD]
    ]
    left = len(found.places) - len(lines)
    return lines + ([f"and {left} more"] if left else [])


def _word(table: TableFile, place: int) -> str:
    return f"0x{table.words[place]:08x}" if place < len(table.words) else "none"


def run(args: argparse.Namespace) -> int:
    tables = (read_file(args.a), read_file(args.b))
    found = difference((args.a, args.b), tables)
    if args.json:
        print(json.dumps({"same": found.is_same, **asdict(found)}, indent=1))
    else:
        show(text(args, found, tables))
    return 0 if found.is_same else EXIT_FAILED
