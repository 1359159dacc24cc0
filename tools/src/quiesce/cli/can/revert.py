"""`quiesce can revert law|tracker`: the table before, or the one that ships."""

import argparse
import json

from quiesce.can.roads import ROADS
from quiesce.cli.can.bus_options import add_bus_options
from quiesce.cli.can.table_options import add_json, add_road, opened

EPILOG = """examples:
  quiesce can revert law --bus socketcan:can0
  quiesce can revert tracker --shipped --save --bus socketcan:can0

Back to the table that was in use before the last one was loaded; --shipped: to the one that is
compiled in, or to none where none is. The next start keeps what is stored; --save stores what is
then in use, and forgets the record where that ships. Exit code 1 where there is no earlier one.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "revert",
        help="the table before, or the one that ships",
        description="Go back to the table before, or to the one that ships.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_road(parser, ROADS[:2])
    parser.add_argument("--shipped", action="store_true", help="to the one that ships")
    parser.add_argument("--save", action="store_true", help="for the next start, too")
    add_json(parser)
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.table.kinds import kind_name

    with opened(args) as tables:
        before = tables.state(args.road)
        (tables.ship if args.shipped else tables.revert)(args.road)
        if args.save:
            tables.save(args.road)
        after = tables.state(args.road)
    if args.json:
        report = {
            "road": args.road,
            "before": f"{before.crc:08x}",
            "crc": f"{after.crc:08x}",
            "kind": kind_name(after.magic),
            "source": after.source,
            "stored_crc": f"{after.stored_crc:08x}",
        }
        print(json.dumps(report, indent=1))
    else:
        stored = f"{after.stored_crc:08x}" if after.stored_crc else "nothing"
        print(
            f"road {args.road}: {kind_name(before.magic)} {before.crc:08x} -> "
            f"{kind_name(after.magic)} {after.crc:08x} ({after.source}); stored for the next "
            f"start: {stored}"
        )
    return 0
