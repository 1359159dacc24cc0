"""`quiesce params`: every parameter of the controller, as the firmware itself knows them."""

import argparse
import json

from quiesce.base.errors import UsageError
from quiesce.base.table import format_table
from quiesce.cli.terminal import show
from quiesce.engine.bench import Bench
from quiesce.engine.params import allowed, default

EPILOG = """examples:
  quiesce params                    all of them
  quiesce params selftune           those with 'selftune' in their name
  quiesce params --json

Set one on any command that runs the controller: --set NAME=VALUE. docs/reference/parameters.md
explains each.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "params",
        description="Parameters of the controller with unit, range and default.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("word", nargs="?", default="", help="only names that contain it")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    params = [p for p in Bench().json("params") if args.word in p["name"]]
    if not params:
        raise UsageError(f"no parameter has '{args.word}' in its name; 'quiesce params' lists all")
    if args.json:
        print(json.dumps(params, indent=1))
        return 0
    rows = [[p["name"], p["unit"], allowed(p), default(p)] for p in params]
    show(format_table(["name", "unit", "allowed", "default"], rows, left=(0, 1, 2)))
    return 0
