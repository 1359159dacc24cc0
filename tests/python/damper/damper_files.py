"""Damper recordings that the tests of the data side write, and how they read them."""

import argparse
import math
from collections.abc import Callable, Sequence
from pathlib import Path

from quiesce.cli.identify.data_options import add_data_options, records_of
from quiesce.damper.data.records import Conditioned

ROOT = Path(__file__).resolve().parents[3]

HEAD = ("t_s", "x_mm", "force_n", "current_a")
RATE_Hz = 200.0
FREQ_Hz = 2.0
AMPLITUDE_mm = 5.0
ROWS = 400

Row = tuple[float, ...]


def sample(n: int) -> Row:
    """Time in s, displacement in mm, force in N, current in A of a sine test."""
    t_s = n / RATE_Hz
    angle = 2.0 * math.pi * FREQ_Hz * t_s
    force_N = 300.0 * math.tanh(3.0 * math.cos(angle)) + 20.0 * math.sin(angle)
    return (t_s, AMPLITUDE_mm * math.sin(angle), force_N, 0.5)


def samples(count: int = ROWS) -> list[Row]:
    return [sample(n) for n in range(count)]


def text_of(
    rows: Sequence[Sequence[object]], head: Sequence[str] = HEAD, separator: str = ",",
    end: str = "\n",
) -> str:  # fmt: skip
    lines = [separator.join(head)]
    lines += [separator.join(cell_text(cell) for cell in row) for row in rows]
    return end.join([*lines, ""])


def cell_text(cell: object) -> str:
    return f"{cell:.6f}" if isinstance(cell, float) else str(cell)


def mapped(change: Callable[[int, Row], Sequence[object]], count: int = ROWS) -> str:
    """The text of a recording with each row changed."""
    return text_of([change(n, row) for n, row in enumerate(samples(count))])


def read(files: Path | Sequence[Path], *options: str) -> Conditioned:
    """What `quiesce identify FILES OPTIONS` would fit."""
    parser = argparse.ArgumentParser()
    parser.add_argument("files", nargs="+", type=Path)
    add_data_options(parser.add_argument_group("data"))
    names = [files] if isinstance(files, Path) else list(files)
    return records_of(parser.parse_args([*map(str, names), *options]))
