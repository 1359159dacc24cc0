"""What the actions share that handle a controller's tables."""

import argparse
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from quiesce.base.progress import say
from quiesce.cli.can.bus_options import bus_of

TELL_S = 0.5


def add_road(parser: argparse.ArgumentParser, roads: Sequence[str]) -> None:
    parser.add_argument("road", choices=roads, metavar="|".join(roads))


def add_json(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print one JSON object")


@contextmanager
def opened(args: argparse.Namespace) -> Iterator[Any]:
    """The tables of the controller on the bus of the options."""
    from quiesce.can.database import load
    from quiesce.can.link import Link
    from quiesce.can.tables import Tables

    with Link(bus_of(args)) as link:
        yield Tables(link, load(), Telling().tell)


def step(text: str) -> None:
    say(f"quiesce: {text}")


class Telling:
    """Bytes of a transfer: a line at its end, and twice a second before."""

    def __init__(self) -> None:
        self._next_s = time.monotonic() + TELL_S

    def tell(self, done: int, total: int) -> None:
        if done < total and time.monotonic() < self._next_s:
            return
        self._next_s = time.monotonic() + TELL_S
        step(f"{done} of {total} bytes, {100 * done // max(total, 1)} %")
