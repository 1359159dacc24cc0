"""`quiesce firmware SUB`: images of boards. One module a subcommand."""

import argparse

from quiesce.cli.firmware import build, flash, info, key, verify

# Each has add_parser(subparsers), like the commands; its own parser sets `run`.
SUBCOMMANDS = (build, info, verify, flash, key)


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "firmware",
        description="Images of boards (docs/howto/stm32f4.md): compiled, sealed and signed; what\n"
        "is in one; whether it may be flashed; onto the board. Untested on hardware.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    actions = parser.add_subparsers(metavar="ACTION", required=True)
    for subcommand in SUBCOMMANDS:
        subcommand.add_parser(actions)
