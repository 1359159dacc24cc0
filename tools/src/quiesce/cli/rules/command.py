"""`quiesce rules SUB`: fuzzy rule files. One module a subcommand."""

import argparse

from quiesce.cli.rules import check, compile, convert, diff, lookup, optimize, show

# Each has add_parser(subparsers), like the commands; its own parser sets `run`.
SUBCOMMANDS = (
    convert,
    compile,
    check,
    show,
    diff,
    lookup,
    optimize,
)


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "rules",
        description="Fuzzy rule files: FCL (IEC 61131-7), FLL (FuzzyLite) and FIS (MATLAB).",
    )
    actions = parser.add_subparsers(metavar="ACTION", required=True)
    for subcommand in SUBCOMMANDS:
        subcommand.add_parser(actions)
