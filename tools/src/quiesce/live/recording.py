"""One recording: a thread that writes what it is fed with the recorder of `quiesce can record`."""

import queue
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.can.database import Database
from quiesce.can.recorder import Known, Plan, Recorder, open_first

TELL_S = 3600.0  # nothing is told meanwhile: the page asks


class Feed:
    """What a recorder takes for a link: first what was before, then what is fed."""

    def __init__(self, before: Sequence[Any]) -> None:
        self._before = iter(before)
        self._events: queue.SimpleQueue[Any] = queue.SimpleQueue()

    def put(self, event: Any) -> None:
        self._events.put(event)

    def receive(self, timeout_s: float) -> Any:
        event = next(self._before, None)
        if event is not None:
            return event
        try:
            return self._events.get(timeout=timeout_s)
        except queue.Empty:
            return None

    def receive_now(self) -> Any:
        event = next(self._before, None)
        if event is not None:
            return event
        try:
            return self._events.get_nowait()
        except queue.Empty:
            return None


class Recording:
    """Written from its making on. UsageError, and nothing is written, where it cannot begin."""

    def __init__(
        self,
        path: Path,
        database: Database,
        known: Known,
        before: Sequence[Any],
        most_s: float,
    ) -> None:
        self.path = path
        self.markers = 0
        self.failure = ""  # of the thread; valid once it is over
        self._feed = Feed(before)
        self._stop = threading.Event()
        self._most_s = most_s
        self._started_s = time.monotonic() - (time.time() - time_of(before[0]) if before else 0.0)
        self._ended_s: float | None = None
        plan = Plan(path, None, None, asks=False)
        self._recorder = Recorder(self._feed, database, plan, lambda _: None, known)
        open_first(self._recorder)
        self._thread = threading.Thread(target=self._run, name="recording")
        self._thread.start()

    @property
    def is_over(self) -> bool:
        """The file is complete."""
        return not self._thread.is_alive()

    @property
    def is_ending(self) -> bool:
        return self._stop.is_set() or self._recorder.file.is_closed

    @property
    def size(self) -> int:
        """Bytes of what is written so far; of the file once it is there."""
        result = self._recorder.file.result
        return (
            result.stat().st_size if self.is_over and result.exists() else self._recorder.file.size
        )

    @property
    def result(self) -> Path:
        """The file that is there in the end."""
        return self._recorder.file.result

    @property
    def frames(self) -> int:
        return self._recorder.file.frames

    @property
    def duration_s(self) -> float:
        """With what was before the start."""
        end_s = time.monotonic() if self._ended_s is None else self._ended_s
        return end_s - self._started_s

    def feed(self, event: Any) -> None:
        if not self.is_ending:
            self._feed.put(event)

    def end(self) -> None:
        """Returns at once; an MDF4 file is made now."""
        self._ended_s = self._ended_s or time.monotonic()
        self._stop.set()

    def wait(self) -> None:
        self._thread.join()

    def _run(self) -> None:
        try:
            self._recorder.run(self._stop, self._most_s, TELL_S, lambda: None)
            self.failure = self._recorder.file.failure
        except (BenchFailure, UsageError, OSError) as error:
            self.failure = one_line(error)
        finally:
            self._ended_s = self._ended_s or time.monotonic()


def time_of(event: Any) -> float:
    """Of a frame, a loss or return of the bus, a marker."""
    return event.timestamp if hasattr(event, "timestamp") else event.time_s
