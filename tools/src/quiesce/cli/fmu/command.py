"""`quiesce fmu SUB`: parts of the loop for co-simulation. One module a subcommand."""

import argparse

from quiesce.cli.fmu import controller, damper, plant, run

# Each has add_parser(subparsers), like the commands; its own parser sets `run`.
SUBCOMMANDS = (controller, plant, damper, run)


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "fmu",
        description="The firmware, the simulated plant and dampers as FMUs (FMI 2.0 and 3.0,\n"
        "co-simulation, Linux x86-64) for Simulink, Dymola, OpenModelica; and somebody else's\n"
        "plant, as an FMU, under the firmware.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    actions = parser.add_subparsers(metavar="ACTION", required=True)
    for subcommand in SUBCOMMANDS:
        subcommand.add_parser(actions)
