"""`quiesce law show FILE`: what a table says."""

import argparse
from pathlib import Path

from quiesce.law.describe import described
from quiesce.law.tables import read_table

EPILOG = """examples:
  quiesce law show build/laws/skyhook.words

Bodies and dampers are numbered as on the board, from 1. Gains are those of the integers that the
controller works with.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "show",
        help="what a table says, in SI units",
        description="Show a law's table: its signals, gains, poles, limits, patterns.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="words, from `quiesce law make`")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    print(described(read_table(args.file)))
    return 0
