"""Arguments that the searching commands share."""

import argparse

from quiesce.base.command import whole_number
from quiesce.base.errors import UsageError
from quiesce.rules.optimize.scenarios import MAX_SETTLE_s, MEASURE_s, SETTLE_s

MAX_VALUES = 100
FREQ_LOW_Hz, FREQ_HIGH_Hz = 0.1, 100.0
DRIVE_HIGH_V = 1e6


def numbers(text: str, option: str, low: float, high: float) -> list[float]:
    """'5,10,15' as numbers in low .. high."""
    try:
        values = [float(word) for word in text.split(",")]
    except ValueError:
        values = []
    if not 0 < len(values) <= MAX_VALUES or not all(low <= value <= high for value in values):
        raise UsageError(
            f"{option} {text}: expected up to {MAX_VALUES} numbers in {low:g} .. {high:g}, with "
            "commas between them"
        )
    return list(dict.fromkeys(values))


def freqs_Hz(text: str) -> list[float]:
    return numbers(text, "--freq", FREQ_LOW_Hz, FREQ_HIGH_Hz)


def drives_V(text: str) -> list[float]:
    return numbers(text, "--drive", 0.0, DRIVE_HIGH_V)


def add_settle(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--settle", type=whole_number(1, MAX_SETTLE_s), default=SETTLE_s, metavar="S",
        help=f"of each --freq, before {MEASURE_s} s are measured: longer for a structure that "
        "rings longer (%(default)s)",
    )  # fmt: skip
