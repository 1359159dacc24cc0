"""What all viewers share: the desk, who holds control, the beat in which they are told."""

import asyncio
import time
from dataclasses import asdict
from typing import Any

from quiesce import __version__
from quiesce.base.errors import UsageError
from quiesce.engine.params import parameters
from quiesce.live.control import Control
from quiesce.live.desk import Desk
from quiesce.live.guide import NAME, Guide
from quiesce.live.protocol import MOST_SERIES, VERSION
from quiesce.live.rig import RigDesk

DRAIN_S = 0.01
BEAT_DRAINS = 4  # 25 messages a second to each viewer
MOST_VIEWERS = 16


class Room:
    """run() for as long as the server does."""

    def __init__(self, desk: Desk, rig: RigDesk | None = None, guide: Guide | None = None) -> None:
        """rig: the one in the computer, where that is what is watched."""
        self.desk = desk
        self.rig = rig
        self.guide = guide
        self._giving_back: asyncio.Task[None] | None = None
        self.control = Control()
        self.viewers: set[int] = set()
        self.is_news = False  # somebody did something: all are told in this beat
        self._is_news_next = False
        self._beat = 0
        self._beaten = asyncio.Condition()
        self._came = 0

    @property
    def hello(self) -> dict[str, Any]:
        """What does not change while the server runs."""
        return {
            "protocol": VERSION,
            "version": __version__,
            "most_series": MOST_SERIES,
            "series": [asdict(one) for one in self.desk.series],
            "parameters": list(parameters()),
            "faults": self.desk.fault_names(),
            "rig": self.rig.hello() if self.rig else None,
            "has_guide": self.guide is not None,
        }

    def come(self) -> int | None:
        """A viewer's number; None where there are enough."""
        if len(self.viewers) == MOST_VIEWERS:
            return None
        self._came += 1
        self.viewers.add(self._came)
        self.tell_now()
        return self._came

    def go(self, viewer: int) -> None:
        self.viewers.discard(viewer)
        self.release(viewer)
        self.tell_now()

    def release(self, viewer: int) -> None:
        if self.guide is not None and self.control.holder == viewer:
            self.guide.let_go()
        self.control.release(viewer)

    def stop(self) -> None:
        """By anybody."""
        self.desk.stop.press()
        if self.guide is not None:
            self.guide.leave()
        self.tell_now()

    def lead(self, order: dict[str, Any]) -> None:
        """An order to the guided session. UsageError where it cannot be."""
        if self.guide is None:
            raise UsageError("there is none: start the server with --commission FOLDER")
        jobs = self.desk.jobs
        if "begin" in order and jobs.name:
            raise UsageError(f"wait: {jobs.name} is under way")
        self.guide.obey(order)
        if "begin" in order:
            jobs.hold(NAME)

    def _end_guide(self) -> None:
        """Its process asks for nothing any more, or is no longer there to stop the controller."""
        if self.guide is not None and self.guide.needs_stop():
            self.desk.stop.press()
        if self.guide is not None and self.desk.jobs.is_held and not self.guide.is_at_work:
            self._giving_back = asyncio.create_task(self.desk.jobs.give_back())

    def tell_now(self) -> None:
        """With the next beat, whatever its turn."""
        self._is_news_next = True

    def told(self) -> dict[str, Any]:
        control = {"holder": self.control.holder, "viewers": len(self.viewers)}
        rig = {"rig": self.rig.told()} if self.rig else {}
        guide = {"guide": self.guide.told()} if self.guide else {}
        return {**self.desk.told(), **control, **rig, **guide}

    async def next_beat(self) -> int:
        """Waits for it; returns its number."""
        async with self._beaten:
            await self._beaten.wait()
        return self._beat

    async def run(self) -> None:
        due_s = time.monotonic()
        drains = 0
        while True:
            due_s = max(due_s + DRAIN_S, time.monotonic() - DRAIN_S)
            await asyncio.sleep(max(0.0, due_s - time.monotonic()))
            stop_was = self.desk.stop.state
            self.desk.drain()
            self._end_guide()
            if self.desk.stop.state != stop_was:
                self.tell_now()
            drains += 1
            if drains % BEAT_DRAINS == 0:
                await self._tell()

    async def _tell(self) -> None:
        self.is_news, self._is_news_next = self._is_news_next, False
        self._beat += 1
        async with self._beaten:
            self._beaten.notify_all()
