"""`./tools/benchmark install`: Quiesce in other people's projects and environments."""

import argparse
from pathlib import Path

from quiesce_benchmarks import part
from quiesce_benchmarks.install import parts
from quiesce_benchmarks.report import Report

NAME = "install"
HELP = "the library in outside projects, its size by choice"
DESCRIPTION = """Builds the projects of examples/embed, each as somebody would who has Quiesce
beside it, runs what they made, and measures what a choice of laws costs in flash and memory."""


def add_options(parser: argparse.ArgumentParser) -> None:
    part.add_options(parser, parts)


def measure(args: argparse.Namespace, folder: Path) -> Report:
    return part.measure(NAME, parts, args, folder)
