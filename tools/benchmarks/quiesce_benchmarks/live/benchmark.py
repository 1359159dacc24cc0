"""`./tools/benchmark live`: the page of a controller at work, in a real browser."""

import argparse
from pathlib import Path

from quiesce_benchmarks import part
from quiesce_benchmarks.live import parts
from quiesce_benchmarks.report import Report

NAME = "live"
HELP = "the page of a controller at work: samples, age, STOP, strangers"
DESCRIPTION = """Runs `quiesce live` beside the firmware's node, on UDP multicast and on a pty, and
looks at it with Chromium: what it draws and how old that is, what the server costs, how long STOP
takes, the loss of the bus, strangers, accessibility. Each part can be had by itself."""


def add_options(parser: argparse.ArgumentParser) -> None:
    part.add_options(parser, parts)


def measure(args: argparse.Namespace, folder: Path) -> Report:
    return part.measure(NAME, parts, args, folder)
