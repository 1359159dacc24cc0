"""`quiesce board SUB`: board files. One module a subcommand."""

import argparse

from quiesce.cli.board import check, compile, show

# Each has add_parser(subparsers), like the commands; its own parser sets `run`.
SUBCOMMANDS = (check, show, compile)


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "board",
        description="Board files: which sensors and dampers there are, where, with what limits.",
    )
    actions = parser.add_subparsers(metavar="ACTION", required=True)
    for subcommand in SUBCOMMANDS:
        subcommand.add_parser(actions)
