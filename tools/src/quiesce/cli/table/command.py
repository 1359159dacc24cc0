"""`quiesce table SUB`: table files. One module a subcommand."""

import argparse

from quiesce.cli.table import check, diff, pack, show, stamp

# Each has add_parser(subparsers), like the commands; its own parser sets `run`.
SUBCOMMANDS = (show, check, diff, stamp, pack)


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "table",
        description="Table files (.table): what a controller's laws and trackers work with, and "
        "what was learnt. They are written by quiesce rules compile, law, tune, identify inverse.",
    )
    actions = parser.add_subparsers(metavar="ACTION", required=True)
    for subcommand in SUBCOMMANDS:
        subcommand.add_parser(actions)
