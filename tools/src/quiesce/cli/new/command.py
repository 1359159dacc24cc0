"""`quiesce new SUB`: files to begin with. One module a subcommand."""

import argparse

from quiesce.cli.new import plant


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser("new", description="Files to begin with.")
    actions = parser.add_subparsers(metavar="WHAT", required=True)
    plant.add_parser(actions)
