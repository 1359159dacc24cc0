"""`quiesce board check FILE...`: are these boards right?"""

import argparse
import sys
from typing import Any

from quiesce.base.errors import EXIT_BAD_INPUT, UsageError
from quiesce.engine.bench import Bench

EPILOG = """examples:
  quiesce board check sim_hil/data/boards/two_storeys.toml
  quiesce board check boards/*.toml

One line each: what the board has, or, on stderr, file, line, key, what is wrong and what is
allowed. Exit code 2 where one is refused.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "check",
        help="validate board files",
        description="Validate board files against this build of the controller.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("files", metavar="FILE", nargs="+", help="board, TOML")
    parser.set_defaults(run=run)


def counted(count: int, one: str, many: str) -> str:
    return f"{count} {one if count == 1 else many}"


def summary(board: dict[str, Any]) -> str:
    return ", ".join(
        (
            counted(len(board["sensors"]), "sensor", "sensors"),
            counted(len(board["bodies"]), "body", "bodies"),
            counted(len(board["dampers"]), "damper", "dampers"),
        )
    )


def is_good(bench: Bench, file: str) -> bool:
    """Says what it has, or what is wrong."""
    try:
        board = bench.json("board-check", file)
    except UsageError as error:
        print(f"quiesce: {error}", file=sys.stderr)
        return False
    print(f"{file}: ok: {board['name']}, {summary(board)}")
    return True


def run(args: argparse.Namespace) -> int:
    bench = Bench()
    results = [is_good(bench, file) for file in args.files]
    return 0 if all(results) else EXIT_BAD_INPUT
