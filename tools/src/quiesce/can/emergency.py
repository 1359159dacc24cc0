"""Frames of EmergencyStop, one after the other, until the controller says that it has stopped."""

import threading
import time

from quiesce.can.database import Database
from quiesce.can.e2e import ALIVE_PERIOD, protect
from quiesce.can.link import Link
from quiesce.can.traffic import Traffic

MESSAGE = "EmergencyStop"


class StopFrames:
    """Repeated by the caller until the controller reports fault ESTOP."""

    def __init__(self, database: Database) -> None:
        message = database.by_name[MESSAGE]
        assert message.protection is not None
        self.frame_id = message.frame_id
        self.cycle_s = message.cycle_ms / 1000.0
        self._layout = message.protection
        self._data = database.encode(MESSAGE, code=database.number(MESSAGE, "code", "STOP"))
        self._alive = 0

    def next(self) -> bytes:
        data = protect(self._layout, self._alive, self._data)
        self._alive = (self._alive + 1) % ALIVE_PERIOD
        return data


def press(
    link: Link, database: Database, timeout_s: float, given_up: threading.Event | None = None
) -> str | None:
    """Presses, paced by the message's cycle, until fault ESTOP is reported. Returns the state that
    is reported with it, None: not in time, or given up."""
    frames = StopFrames(database)
    start_s = time.monotonic()
    while time.monotonic() - start_s < timeout_s and not (given_up and given_up.is_set()):
        # A new look each time: only a report from after the press counts.
        traffic = Traffic(database)
        link.send(frames.frame_id, frames.next())
        end_s = time.monotonic() + frames.cycle_s
        while (left_s := end_s - time.monotonic()) > 0.0:
            event = link.receive(left_s)
            if hasattr(event, "arbitration_id"):
                traffic.take(event)
            status = traffic.values("Status")
            if status and str(status["fault"]) == "ESTOP":
                return str(status["state"])
    return None
