"""`quiesce can restore-learnt [FILE]`: what was learnt before is put back."""

import argparse
from pathlib import Path

from quiesce.base.errors import BenchFailure
from quiesce.can.roads import LEARNT
from quiesce.cli.can.bus_options import add_bus_options
from quiesce.cli.can.table_options import opened, step
from quiesce.loading.sources import table_of

EPILOG = """examples:
  quiesce can restore-learnt --bus socketcan:can0
  quiesce can restore-learnt learnt.table --bus socketcan:can0

From the controller's own record ('save-learnt'), or from a file that 'fetch learnt' wrote. What was
learnt by another law, with another table or setting is refused (exit code 1).
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "restore-learnt",
        help="put back what was learnt",
        description="Put back what the law has learnt before.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, nargs="?", metavar="FILE")
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.refusals import LEARNT_TEXT
    from quiesce.can.tables import Refused
    from quiesce.loading.load import put

    table = table_of(LEARNT, args.file) if args.file else None
    with opened(args) as tables:
        if table:
            put(tables, table, step)
        else:
            try:
                tables.restore()
            except Refused:
                raise BenchFailure(f"refused: {LEARNT_TEXT}; nothing was changed")
    print("what was learnt has been put back")
    return 0
