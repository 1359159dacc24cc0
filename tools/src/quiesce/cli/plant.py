"""`quiesce plant check FILE`: validates a plant file and shows what it describes."""

import argparse

from quiesce.engine.bench import Bench

EPILOG = """examples:
  quiesce plant check sim_hil/data/plants/squeeze_2012.toml
  cp sim_hil/data/plants/squeeze_2012.toml my_plant.toml   # start from the published one

Exit code 2 where the file is wrong: one line names the file, the key and what is allowed.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser("plant", description="Plant files.")
    actions = parser.add_subparsers(metavar="ACTION", required=True)
    check = actions.add_parser(
        "check",
        help="validate a plant file and show what it describes",
        description="Validate a plant file and show modes, damper, coil, sensor and step.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    check.add_argument("file", metavar="FILE", help="plant, TOML")
    check.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    print(Bench().call("plant-check", args.file), end="")
    return 0
