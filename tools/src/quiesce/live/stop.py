"""STOP: pressed once, repeated on the bus until the controller reports fault ESTOP."""

import time
from dataclasses import dataclass
from typing import Any

from quiesce.can.database import Database
from quiesce.can.emergency import StopFrames
from quiesce.can.link import Link

IDLE, PRESSED, CONFIRMED = "idle", "pressed", "confirmed"
ESTOP = "ESTOP"
LEAST_S = 0.01  # from one frame to the next


@dataclass(frozen=True)
class Pressed:
    """Among the events of a link: what follows came after that press was sent."""

    number: int


class Stop:
    """Never given up: a bus that comes back gets it, too. Reports that had come before it was
    pressed confirm nothing, though they are read after it."""

    def __init__(self, link: Link, database: Database) -> None:
        self._link = link
        self._frames = StopFrames(database)
        self._pressed_s = 0.0
        self._sent_s = 0.0
        self._is_sent = False  # since then
        self._presses = 0
        self._is_passed = False  # what is reported now came after the last press
        self.state = IDLE

    def press(self) -> None:
        """Sends at once; a storm of presses is no storm on the bus."""
        now_s = time.monotonic()
        if self.state == PRESSED and now_s < self._sent_s + LEAST_S:
            return
        if self.state != PRESSED:  # pressed again it has waited since the first time
            self._pressed_s = now_s
            self._presses += 1
            self._is_sent = self._is_passed = False
        self.state = PRESSED
        self._send(now_s)

    def poll(self) -> None:
        """Sends again where it is time to. Called more often than frames are due."""
        now_s = time.monotonic()
        if self.state == PRESSED and now_s >= self._sent_s + self._frames.cycle_s:
            self._send(now_s)

    def passed(self, mark: Pressed) -> None:
        """Of each mark that the link gives back."""
        self._is_passed = mark.number == self._presses

    def reported(self, fault: str) -> None:
        """Of each Status that can be trusted."""
        if self.state == PRESSED and self._is_passed and fault == ESTOP:
            self.state = CONFIRMED
        elif self.state == CONFIRMED and fault != ESTOP:
            self.state = IDLE

    def told(self) -> dict[str, Any]:
        waited_s = time.monotonic() - self._pressed_s if self.state == PRESSED else 0.0
        return {"state": self.state, "is_sent": self._is_sent, "waited_s": round(waited_s, 1)}

    def _send(self, now_s: float) -> None:
        self._sent_s = now_s
        message = self._link.send(self._frames.frame_id, self._frames.next())
        if message is not None and not self._is_sent:
            self._is_sent = True
            self._link.mark(Pressed(self._presses))
