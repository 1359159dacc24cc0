"""`./tools/benchmark laws`: control laws on structures with published results."""

import argparse
from pathlib import Path

from quiesce_benchmarks import part
from quiesce_benchmarks.laws import parts
from quiesce_benchmarks.report import Report

NAME = "laws"
HELP = "published laws on structures with published results; integers beside float64"
DESCRIPTION = """Runs the laws that `quiesce law make` knows on the building of 1996 and a quarter
of a car, beside what was published, and their integers beside float64."""


def add_options(parser: argparse.ArgumentParser) -> None:
    part.add_options(parser, parts)


def measure(args: argparse.Namespace, folder: Path) -> Report:
    return part.measure(NAME, parts, args, folder)
