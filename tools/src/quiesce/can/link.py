"""A bus that may go away: frames in the order of their arrival, loss and return between them.

A thread of its own reads, so that nobody's writing or drawing makes a driver's buffer overflow.
"""

import queue
import threading
import time
from collections import deque
from dataclasses import dataclass
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.can.buses import Bus, reason_of

REOPEN_S = 0.5
READ_S = 0.1
# Packets in a row that are no frames: the driver is broken, not the bus noisy.
MAX_NOISE = 100
# A driver's clock that is further off counts from its own start.
CLOCK_S = 60.0


@dataclass(frozen=True)
class Lost:
    """The bus is gone since then."""

    time_s: float
    reason: str


@dataclass(frozen=True)
class Back:
    """The bus is there again after a gap."""

    time_s: float
    gap_s: float


@dataclass(frozen=True)
class Sent:
    """A frame of our own, in its place among those that arrive."""

    message: Any


class Link:
    """Opened by entering it, UsageError where that fails; later losses are events and it opens
    again by itself.

    echoes: what is sent, by any thread, comes back as Sent. The thread that reads puts it where its
    time belongs: frames that arrived before may wait, in the driver or here, to be read.
    """

    def __init__(self, bus: Bus, echoes: bool = False) -> None:
        self.bus = bus
        self._echoes = echoes
        self._sent: deque[Any] = deque()  # by time, not told yet
        self._telling = threading.Lock()  # of that
        self._driver: Any = None
        self._events: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._stop = threading.Event()
        self._sending = threading.Lock()
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._malformed = 0
        self._shift_s: float | None = None

    def __enter__(self) -> "Link":
        try:
            self._driver = self.bus.open()
        except Exception as error:  # every driver has its own classes
            raise UsageError(
                f"cannot open {self.bus.name}: {reason_of(error)}; 'quiesce can list' shows what "
                "there is"
            )
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()
        self._close()

    @property
    def is_up(self) -> bool:
        return self._driver is not None

    @property
    def malformed(self) -> int:
        """Lines or packets that were no frames."""
        return self._malformed + getattr(self._driver, "malformed", 0)

    def receive(self, timeout_s: float) -> Any:
        """The next can.Message, Lost, Back or Sent; None where nothing comes in time."""
        try:
            return self._events.get(timeout=max(timeout_s, 0.0))
        except queue.Empty:
            return None

    def receive_now(self) -> Any:
        """As receive, without waiting."""
        try:
            return self._events.get_nowait()
        except queue.Empty:
            return None

    def mark(self, event: Any) -> None:
        """Puts it behind what has come so far: what is received after it came later."""
        self._events.put(event)

    def untold(self) -> list[Any]:
        """What was sent last and is no event yet, as nothing arrived after it; it is none later."""
        with self._telling:
            found = list(self._sent)
            self._sent.clear()
        return found

    def send(self, frame_id: int, data: bytes) -> Any:
        """Returns the message that was sent, None where the bus did not take it."""
        from quiesce.can.python_can import can

        message = can.Message(
            arbitration_id=frame_id, is_extended_id=False, data=data, is_rx=False
        )  # fmt: skip
        with self._telling:  # in the order of their times
            message.timestamp = time.time()
            if self._echoes:
                self._sent.append(message)  # before an answer to it can be read
        is_sent = self.send_message(message)
        if not is_sent:
            with self._telling:  # where it is told already it went to a bus that broke under it
                self._sent = deque(one for one in self._sent if one is not message)
        return message if is_sent else None

    def send_message(self, message: Any) -> bool:
        with self._sending:
            driver = self._driver
            if driver is None:
                return False
            try:
                driver.send(message)
            except Exception:  # the reader meets the same fault and tells it
                return False
        return True

    def _read(self) -> None:
        noise = 0
        while not self._stop.is_set():
            began_s = time.time()
            try:
                message = self._driver.recv(READ_S)
            except Exception as error:
                noise += 1
                if is_noise(error) and noise < MAX_NOISE:
                    self._malformed += 1
                else:
                    self._lose(error)
                    noise = 0
                continue
            if message is None:
                self._tell_sent(began_s)
            else:
                noise = 0
                self._stamp(message)
                self._tell_sent(message.timestamp)
                self._events.put(message)

    def _tell_sent(self, until_s: float) -> None:
        """Nothing older is to be read any more."""
        with self._telling:
            while self._sent and self._sent[0].timestamp <= until_s:
                self._events.put(Sent(self._sent.popleft()))

    def _stamp(self, message: Any) -> None:
        """Some adapters count from their own start: the first frame ties that to the clock."""
        if self._shift_s is None:
            off_s = time.time() - message.timestamp
            self._shift_s = off_s if abs(off_s) > CLOCK_S else 0.0
        message.timestamp += self._shift_s

    def _lose(self, error: Exception) -> None:
        lost_s = time.time()
        self._tell_sent(lost_s)
        self._events.put(Lost(lost_s, reason_of(error)))
        self._close()
        while not self._stop.wait(REOPEN_S):
            try:
                driver = self.bus.open()
            except Exception:
                continue
            self._driver = driver
            self._shift_s = None
            now_s = time.time()
            self._events.put(Back(now_s, now_s - lost_s))
            return

    def _close(self) -> None:
        with self._sending:
            driver, self._driver = self._driver, None
        if driver is None:
            return
        self._malformed += getattr(driver, "malformed", 0)
        try:
            driver.shutdown()
        except Exception:  # it is gone, and cannot even say goodbye
            close_line(driver)


def is_noise(error: Exception) -> bool:
    """A packet that is no frame, on a bus that goes on."""
    return isinstance(error, ValueError) or "unpack" in str(error)


def close_line(driver: Any) -> None:
    """python-can's SLCAN writes before it closes; where that fails, the line stays open."""
    line = getattr(driver, "serialPortOrig", None)
    if line is not None:
        line.close()
