"""`./tools/benchmark unseen`: identification where rigs and channels are not as they should be."""

import argparse
from pathlib import Path

from quiesce_benchmarks import part
from quiesce_benchmarks.report import Report
from quiesce_benchmarks.unseen import parts

NAME = "unseen"
HELP = "damper identification: faults of channels and rigs, planted"
DESCRIPTION = """Faults planted into the channels of the measured dampers, as they are in the file
and as whoever exported it may have filtered and thinned them: are they told, and are the untouched
files left alone? Masses and skews planted into the rig of dampers that are known: are they found,
and is nothing found where nothing is?"""


def add_options(parser: argparse.ArgumentParser) -> None:
    part.add_options(parser, parts)


def measure(args: argparse.Namespace, folder: Path) -> Report:
    return part.measure(NAME, parts, args, folder)
