"""`quiesce rules SUB`: fuzzy rule files. One module a subcommand."""

import argparse

from quiesce.rules import (
    cli_check,
    cli_compile,
    cli_convert,
    cli_diff,
    cli_lookup,
    cli_optimize,
    cli_show,
)

# Each has add_parser(subparsers), like the commands; its own parser sets `run`.
SUBCOMMANDS = (
    cli_convert,
    cli_compile,
    cli_check,
    cli_show,
    cli_diff,
    cli_lookup,
    cli_optimize,
)


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "rules",
        help="fuzzy rule files",
        description="Fuzzy rule files: FCL (IEC 61131-7), FLL (FuzzyLite) and FIS (MATLAB).",
    )
    actions = parser.add_subparsers(metavar="ACTION", required=True)
    for subcommand in SUBCOMMANDS:
        subcommand.add_parser(actions)
