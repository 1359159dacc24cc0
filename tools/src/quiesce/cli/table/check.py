"""`quiesce table check FILE`: does a controller take it?"""

import argparse
import json
from pathlib import Path
from typing import Any

from quiesce.base.errors import EXIT_FAILED
from quiesce.base.paths import shown
from quiesce.cli.table.contents import board_text
from quiesce.engine.bench import Bench

EPILOG = """examples:
  quiesce table check build/laws/skyhook.table
  quiesce table check build/laws/skyhook.table --board my_board.toml

The controller's own verdict, as it would give it to the table on CAN. Without --board it is about
the table alone; with it, also whether the board has the signals and dampers that the table needs,
and whether the file is made for that board.

Exit codes: 0 accepted; 1 refused; 2 the file cannot be read or is not one whole table file.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "check",
        help="whether a controller takes it",
        description="Check a table file: head, CRC, then the controller's verdict. One line.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="table file")
    parser.add_argument("--board", type=Path, metavar="FILE", help="of the controller, TOML")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


def why_refused(found: dict[str, Any]) -> str:
    """Empty where it is accepted."""
    if found["verdict"] != 0:
        return str(found["reason"])
    if not found["is_for_board"]:
        return f"made for board {board_text(found['board'])}, and this is another one"
    return ""


def text(args: argparse.Namespace, found: dict[str, Any], why: str) -> str:
    on = f" on {shown(args.board)}" if args.board else ""
    if why:
        return f"{shown(args.file)}: refused{on}: {why}"
    takers = [f"law {one}" for one in found["laws"]]
    takers += [f"tracker {one}" for one in found["trackers"]]
    return f"{shown(args.file)}: accepted{on}" + (f" by {', '.join(takers)}" if takers else "")


def run(args: argparse.Namespace) -> int:
    board = ("--board", str(args.board)) if args.board else ()
    found = Bench().json("table-check", "--file", str(args.file), *board)
    why = why_refused(found)
    if args.json:
        print(json.dumps({"accepted": not why, "why": why or None, **found}, indent=1))
    else:
        print(text(args, found, why))
    return EXIT_FAILED if why else 0
