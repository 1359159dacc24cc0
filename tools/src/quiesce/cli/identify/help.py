"""What the actions of `quiesce identify` share on the command line."""

import argparse
import math
from collections.abc import Callable


def number(low: float, high: float, what: str) -> Callable[[str], float]:
    """A type for argparse: a finite number within low .. high."""

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(
                f"'{text}': expected {what}, a number from {low:g} to {high:g}"
            )
        return value

    return read


def fill(parser: argparse.ArgumentParser, epilog: str) -> None:
    parser.epilog = epilog
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
