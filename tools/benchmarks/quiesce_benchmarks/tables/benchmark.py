"""`./tools/benchmark tables`: tables into controllers at work, whatever goes wrong on the way."""

import argparse
from pathlib import Path

from quiesce_benchmarks import part
from quiesce_benchmarks.report import Report
from quiesce_benchmarks.tables import parts

NAME = "tables"
HELP = "tables into a controller at work, its memory, and back"
DESCRIPTION = """Loads tables of every kind into the node as a program of this machine, the image in
the emulator and the Linux controller, over a line with SLCAN; cuts transfers and power; measures
what it takes of the bus, of a tick and of the current. Each part can be had by itself."""


def add_options(parser: argparse.ArgumentParser) -> None:
    part.add_options(parser, parts)


def measure(args: argparse.Namespace, folder: Path) -> Report:
    return part.measure(NAME, parts, args, folder)
