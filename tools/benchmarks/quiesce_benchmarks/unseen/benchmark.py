"""`./tools/benchmark unseen`: identification of dampers that nobody has seen. Rigs and channels
that are not as they should be, currents and motions left out, and how long it takes."""

import argparse
from pathlib import Path

from quiesce_benchmarks import part
from quiesce_benchmarks.report import Report
from quiesce_benchmarks.unseen import parts

NAME = "unseen"
HELP = "damper identification: planted faults, ranking and bands on tests left out, waiting times"
DESCRIPTION = """Faults planted into the channels of the measured dampers, as they are in the file
and as whoever exported it may have filtered and thinned them: are they told, and are the untouched
files left alone? Masses and skews planted into the rig of dampers that are known: are they found,
and is nothing found where nothing is? Whole currents, motions and amplitudes of measured dampers
left out: how far is the chosen model from the best one there, and does the 95 % band hold? How long
does a user wait? All models on all cases are hours; --quick takes the default models, and one case
of a kind of one damper."""


def add_options(parser: argparse.ArgumentParser) -> None:
    part.add_options(parser, parts)


def measure(args: argparse.Namespace, folder: Path) -> Report:
    return part.measure(NAME, parts, args, folder)
