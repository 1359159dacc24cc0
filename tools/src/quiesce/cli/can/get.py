"""`quiesce can get [WORD]`: parameters in effect on the controller."""

import argparse
import json

from quiesce.base.errors import UsageError
from quiesce.base.table import format_table
from quiesce.cli.can.bus_options import add_bus_options, bus_of
from quiesce.cli.terminal import show
from quiesce.engine.params import allowed, default

EPILOG = """examples:
  quiesce can get --bus socketcan:can0
  quiesce can get phase --bus slcan:/dev/ttyACM0
  quiesce can get --bus socketcan:can0 --json > before.json

docs/reference/parameters.md explains each. '*' marks values that are not the default.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "get",
        help="parameters in effect",
        description="Read the parameters in effect on the controller.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("word", nargs="?", default="", help="only names that contain it")
    add_bus_options(parser)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.database import load
    from quiesce.can.link import Link
    from quiesce.can.parameters import parameters, text_of
    from quiesce.can.services import Services

    chosen = [one for one in parameters() if args.word in one["name"]]
    if not chosen:
        raise UsageError(f"no parameter has '{args.word}' in its name; 'quiesce params' lists all")
    with Link(bus_of(args)) as link:
        values = Services(link, load()).read_all()
    chosen = [one for one in chosen if one["index"] < len(values)]
    if args.json:
        shown = {one["name"]: values[one["index"]] for one in chosen}
        print(json.dumps(shown, indent=1))
        return 0
    rows = []
    for one in chosen:
        value = text_of(one, values[one["index"]])
        mark = "" if value == default(one) else "*"
        rows.append([one["name"], one["unit"], value, mark, allowed(one)])
    show(format_table(["name", "unit", "value", "", "allowed"], rows, left=(0, 1, 3, 4)))
    return 0
