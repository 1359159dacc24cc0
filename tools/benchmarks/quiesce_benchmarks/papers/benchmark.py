"""`./tools/benchmark papers`: what the five papers published, beside what comes out here."""

import argparse
from pathlib import Path

from quiesce_benchmarks import part
from quiesce_benchmarks.papers import parts
from quiesce_benchmarks.report import Report

NAME = "papers"
HELP = "equations, tables and figures of five papers: published beside ours"
DESCRIPTION = """Makes again what the five papers published, on their protocols, and prints it
beside what they printed. Each part can be had by itself."""


def add_options(parser: argparse.ArgumentParser) -> None:
    part.add_options(parser, parts)


def measure(args: argparse.Namespace, folder: Path) -> Report:
    return part.measure(NAME, parts, args, folder)
