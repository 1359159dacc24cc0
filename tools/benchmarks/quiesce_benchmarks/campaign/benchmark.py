"""`./tools/benchmark campaign`: what a second worker is worth, and what killing costs."""

import argparse
from pathlib import Path

from quiesce_benchmarks import part
from quiesce_benchmarks.campaign import parts
from quiesce_benchmarks.report import Report

NAME = "campaign"
HELP = "campaigns: a second worker's worth, rows after kills; FMUs; formats of recordings"
DESCRIPTION = """Short cases on one worker and on two, by turns, on processes and on Dask: how much
of twice the rate two workers reach. Commands, workers and benches killed at random moments: is a
row lost, does one come twice, are all rows the same bits? What a million cases cost, from that.
FMUs of every kind: what fmpy finds wrong with them, words that differ from the bench's, the cost of
a step. Recordings that other programs' libraries wrote: which formats are read as what they are."""


def add_options(parser: argparse.ArgumentParser) -> None:
    part.add_options(parser, parts)


def measure(args: argparse.Namespace, folder: Path) -> Report:
    return part.measure(NAME, parts, args, folder)
