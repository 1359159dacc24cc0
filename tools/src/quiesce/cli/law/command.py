"""`quiesce law SUB`: control laws as tables. One module a subcommand."""

import argparse

from quiesce.cli.law import fit, list, make, rules

# Each has add_parser(subparsers), like the commands; its own parser sets `run`.
SUBCOMMANDS = (list, make, rules, fit)


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "law",
        description="Published control laws as tables for a controller: made for a board, "
        "run with quiesce_bench run --law-table FILE.",
    )
    actions = parser.add_subparsers(metavar="ACTION", required=True)
    for subcommand in SUBCOMMANDS:
        subcommand.add_parser(actions)
