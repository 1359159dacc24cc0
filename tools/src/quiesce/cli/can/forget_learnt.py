"""`quiesce can forget-learnt`: the law begins to learn anew."""

import argparse

from quiesce.cli.can.bus_options import add_bus_options
from quiesce.cli.can.table_options import opened

EPILOG = """examples:
  quiesce can forget-learnt --bus socketcan:can0

The law forgets what it has learnt. What is stored stays until the next 'save-learnt', and
'restore-learnt' brings it back.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "forget-learnt",
        help="learn anew",
        description="Have the law forget what it has learnt.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    with opened(args) as tables:
        tables.forget()
    print("forgotten; what is stored stays until 'quiesce can save-learnt'")
    return 0
