"""`./tools/benchmark board`: the same bits on every processor, and what a board has to have."""

import argparse
from pathlib import Path

from quiesce_benchmarks import part
from quiesce_benchmarks.board import parts
from quiesce_benchmarks.report import Report

NAME = "board"
HELP = "the same bits on nine targets; flash, memory, stack and instructions of an image"
DESCRIPTION = """The golden traces on nine targets, one hash of them; flash, memory, stack and
instructions of the image for one sensor and one damper with the fuzzy and the phase laws
(preset `budget`); what its tick calls of the compiler's library; bytes of every law on every
processor, against those that were recorded. Images run under QEMU: instructions, not cycles."""


def add_options(parser: argparse.ArgumentParser) -> None:
    part.add_options(parser, parts)


def measure(args: argparse.Namespace, folder: Path) -> Report:
    return part.measure(NAME, parts, args, folder)
