"""`quiesce table stamp FILE`: which board a table file is for."""

import argparse
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.cli.table.contents import board_text
from quiesce.engine.bench import Bench
from quiesce.table.file import ANY_BOARD, read_file, table_bytes
from quiesce.table.words import opened

EPILOG = """examples:
  quiesce table stamp map.table --board my_board.toml
  quiesce table stamp build/laws/skyhook.table --any

A controller refuses a table that is made for another board than its own. Every number of a board
counts. What is made with --board (quiesce law, quiesce tune law) is stamped already.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "stamp",
        help="say which board it is for",
        description="Write the CRC-32 of a board into the head of a table file.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="table file, which is changed")
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument("--board", type=Path, metavar="FILE", help="for this board only, TOML")
    which.add_argument("--any", action="store_true", help="for any board")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    words = read_file(args.file).words
    try:
        opened(words)
    except ValueError as error:
        raise UsageError(f"{shown(args.file)}: {error}")
    board = ANY_BOARD
    if args.board:
        board = Bench().json("board-check", str(args.board))["crc32"]
    with output_files(args.file.parent) as folder:
        (folder / args.file.name).write_bytes(table_bytes(words, board))
    print(f"{shown(args.file)}: for board {board_text(board)}")
    return 0
