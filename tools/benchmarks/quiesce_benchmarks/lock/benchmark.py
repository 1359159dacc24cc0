"""`./tools/benchmark lock`: motion that nothing was tuned on."""

import argparse
from pathlib import Path

from quiesce_benchmarks import part
from quiesce_benchmarks.lock import parts
from quiesce_benchmarks.report import Report

NAME = "lock"
HELP = "motion that nothing was tuned on: what the lock does there"
DESCRIPTION = """The phase law, which locks on to components, through the closed loop on the
published plant: earthquakes and random forces against the best constant current of each input,
since a lock on motion that has no component costs more than it gives; and a component beside a
second tone, lost ticks and lost samples against the same undisturbed."""


def add_options(parser: argparse.ArgumentParser) -> None:
    part.add_options(parser, parts)


def measure(args: argparse.Namespace, folder: Path) -> Report:
    return part.measure(NAME, parts, args, folder)
