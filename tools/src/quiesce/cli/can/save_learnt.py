"""`quiesce can save-learnt [FILE]`: what the law has learnt is kept by the controller."""

import argparse
from pathlib import Path

from quiesce.can.roads import LEARNT
from quiesce.cli.can.bus_options import add_bus_options
from quiesce.cli.can.fetch import check_out, fetched, text
from quiesce.cli.can.table_options import opened

EPILOG = """examples:
  quiesce can save-learnt --bus socketcan:can0
  quiesce can save-learnt learnt.table --bus socketcan:can0

The controller stores what its law has learnt by now, for 'restore-learnt' and the next start. With
FILE it is fetched, too.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "save-learnt",
        help="store what was learnt",
        description="Have the controller store what its law has learnt.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, nargs="?", metavar="FILE")
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.tables import STORED

    if args.file:
        check_out(args.file)
    with opened(args) as tables:
        tables.save(LEARNT)
        print(f"stored in the controller: CRC {tables.info(LEARNT, STORED):08x}")
        if args.file:
            print(text(fetched(tables, LEARNT, args.file)))
    return 0
