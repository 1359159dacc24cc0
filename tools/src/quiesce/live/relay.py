"""A bus that only one program can have, such as a serial adapter's, for a second one: what comes on
it is told on a bus of this computer alone, what tools send there is sent on it."""

import threading
from contextlib import suppress
from typing import Any

from quiesce.can.buses import Bus
from quiesce.can.database import Database
from quiesce.can.link import Link
from quiesce.rig.simulation import own_bus

LOOK_S = 0.1
SHARED = ("socketcan", "udp_multicast", "virtual")  # any number of programs join these
ON_RIG = ("Controller", "Driver", "Sensor")


class Relay:
    """Entered, it is at work. pass_on() is told all that comes on the link."""

    def __init__(self, link: Link, database: Database) -> None:
        self.bus: Bus = own_bus()
        self._link = link
        # Who sends on a multicast hears himself.
        self._of_rig = {one.frame_id for one in database.messages if one.sender in ON_RIG}
        self._driver: Any = None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._send, daemon=True)

    def __enter__(self) -> "Relay":
        self._driver = self.bus.open()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()
        self._driver.shutdown()

    def pass_on(self, event: Any) -> None:
        """An event of the link: frames."""
        if hasattr(event, "arbitration_id"):
            with suppress(Exception):  # every driver has its own; who listens sees that it is lost
                self._driver.send(event)

    def _send(self) -> None:
        while not self._stop.is_set():
            message = self._driver.recv(LOOK_S)
            if message is not None and message.arbitration_id not in self._of_rig:
                self._link.send(message.arbitration_id, bytes(message.data))


def is_shared(bus: Bus) -> bool:
    return bus.interface in SHARED
