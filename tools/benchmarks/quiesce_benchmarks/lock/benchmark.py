"""`./tools/benchmark lock`: motion that nothing was tuned on."""

import argparse
from pathlib import Path

from quiesce_benchmarks import part
from quiesce_benchmarks.lock import parts
from quiesce_benchmarks.report import Report

NAME = "lock"
HELP = "motion that nothing was tuned on: what the lock does there"
DESCRIPTION = """Earthquakes and random forces through the closed loop on the published plant:
the phase law, which locks on to components, against the best constant current of each input. A
lock on motion that has no component costs more than it gives."""


def add_options(parser: argparse.ArgumentParser) -> None:
    part.add_options(parser, parts)


def measure(args: argparse.Namespace, folder: Path) -> Report:
    return part.measure(NAME, parts, args, folder)
