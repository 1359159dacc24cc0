"""What is asked of the controller and takes a while: in a thread of its own, one at a time.

The thread works with the services that the command line has, on a copy of the frames.
"""

import asyncio
import queue
import time
from collections.abc import Callable
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.can.buses import Bus
from quiesce.can.changes import apply, save, verify
from quiesce.can.database import Database
from quiesce.can.link import Link
from quiesce.can.parameters import settings_of
from quiesce.can.recorder import Preamble
from quiesce.can.services import Services

READ_S = 5.0
LOOK_S = 0.02


class Tap:
    """Of a link: sends through it, receives what feed() is given while it is open."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self._events: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self.is_open = False

    @property
    def bus(self) -> Bus:
        return self._link.bus

    @property
    def is_up(self) -> bool:
        return self._link.is_up

    def send(self, frame_id: int, data: bytes) -> Any:
        return self._link.send(frame_id, data)

    def receive(self, timeout_s: float) -> Any:
        try:
            return self._events.get(timeout=max(timeout_s, 0.0))
        except queue.Empty:
            return None

    def receive_now(self) -> Any:
        try:
            return self._events.get_nowait()
        except queue.Empty:
            return None

    def feed(self, event: Any) -> None:
        if self.is_open:
            self._events.put(event)

    def open(self) -> None:
        self._events = queue.SimpleQueue()
        self.is_open = True

    def close(self) -> None:
        self.is_open = False


class Jobs:
    """run() says how it went; `name` is what is under way, empty: nothing."""

    def __init__(self, link: Link, database: Database, preamble: Preamble) -> None:
        self.tap = Tap(link)
        self.name = ""
        self.is_held = False
        self._database = database
        self._preamble = preamble

    @property
    def is_asking(self) -> bool:
        """Nobody else asks the controller for anything then."""
        return self.tap.is_open or self.is_held

    def hold(self, name: str) -> None:
        """For somebody who asks by himself, until give_back(); where nothing is under way."""
        self.name, self.is_held = name, True

    async def give_back(self) -> None:
        self.is_held = False
        await self._read_again()
        self.name = ""

    async def run(self, name: str, work: Callable[[Services], str]) -> tuple[bool, str]:
        """Whether it came about, and a line for the viewer. Over when the parameters are known
        again."""
        if self.name:
            return False, f"wait: {self.name} is under way"
        self.name = name
        self.tap.open()
        try:
            # Understands the controller anew: it may be another one now.
            return True, await asyncio.to_thread(work, Services(self.tap, self._database))
        except (BenchFailure, UsageError) as error:
            return False, str(error)
        finally:
            self.tap.close()
            await self._read_again()
            self.name = ""

    async def _read_again(self) -> None:
        """The preamble is polled by whoever takes the frames."""
        self._preamble.read_again()
        end_s = time.monotonic() + READ_S
        while not self._preamble.is_over and time.monotonic() < end_s:
            await asyncio.sleep(LOOK_S)


def change(values: list[int], settings: dict[int, int]) -> Callable[[Services], str]:
    """All of the settings or none, read back. values: in effect, in index order."""

    def work(services: Services) -> str:
        apply(services, settings)
        verify(services, values, settings)
        return f"{len(settings)} changed and read back"

    return work


def store(services: Services) -> str:
    save(services)
    return "stored for the next start"


def wanted(words: tuple[str, ...], values: list[int]) -> dict[int, int]:
    """Those of NAME=VALUE that differ, and what this firmware has not: it says so. UsageError where
    one is not allowed."""
    have = dict(enumerate(values))
    return {i: value for i, value in settings_of(words).items() if have.get(i) != value}
