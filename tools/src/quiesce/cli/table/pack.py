"""`quiesce table pack FILE -o OUT`: bare words as a table file."""

import argparse
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.cli.table.contents import kind_text
from quiesce.table.file import MAGIC, table_bytes
from quiesce.table.kinds import KINDS
from quiesce.table.words import WORD, WORD_BYTES, opened, size_text, unpacked

EPILOG = """examples:
  quiesce table pack old/map.words -o map.table
  quiesce table pack words.bin -o law.table

FILE has the words of one table, head and all: as text, hexadecimal numbers with blanks or ends of
lines between them, or as bytes, little-endian. The file is for any board; `quiesce table stamp`
says for which.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "pack",
        help="make a table file of bare words",
        description="Make a table file of the bare words of a table.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="words, as text or as bytes")
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="FILE", help="table file")
    parser.set_defaults(run=run)


def words_of(data: bytes) -> list[int]:
    """ValueError, in one line, where they are not the words of a whole table."""
    words = unpacked(data)
    if words and words[0] == MAGIC:
        raise ValueError("it is a table file already")
    is_binary = bool(words) and words[0] in KINDS
    if is_binary and len(data) % WORD_BYTES:
        raise ValueError(f"{len(data)} bytes are no whole 32-bit words")
    found = words if is_binary else _numbers(data)
    opened(found)
    return found


def _numbers(data: bytes) -> list[int]:
    try:
        words = [int(text, 16) for text in data.decode("ascii").split()]
    except ValueError:
        words = []
    if not words or not all(0 <= word < WORD for word in words):
        raise ValueError("expected the words of a table: hexadecimal numbers, or its bytes")
    return words


def run(args: argparse.Namespace) -> int:
    try:
        words = words_of(args.file.read_bytes())
    except OSError as error:
        raise UsageError(f"{shown(args.file)}: {error.strerror}; name a file of words")
    except ValueError as error:
        raise UsageError(f"{shown(args.file)}: {error}")
    with output_files(args.out.parent) as folder:
        (folder / args.out.name).write_bytes(table_bytes(words))
    print(f"{shown(args.out)}: {kind_text(words)}, {size_text(len(words))}")
    return 0
