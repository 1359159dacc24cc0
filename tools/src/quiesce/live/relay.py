"""A bus that only one program can have, such as a serial adapter's, lent to a second one: what
comes on it is told there, what is said there is sent on it. Nobody else hears or says anything."""

import socket
import threading
from contextlib import suppress
from typing import Any

from quiesce.can.buses import Bus
from quiesce.can.lent import MOST_BYTES, packed, pair, unpacked
from quiesce.can.link import Link

SHARED = ("socketcan", "udp_multicast", "virtual")  # any number of programs join these


class Relay:
    """Entered, it is at work; theirs: for the other program. pass_on() is told all that comes on
    the link."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self._ours, self.theirs = pair()
        self._thread = threading.Thread(target=self._send, daemon=True)

    def __enter__(self) -> "Relay":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        with suppress(OSError):
            self._ours.shutdown(socket.SHUT_RDWR)
        self._thread.join()
        self._ours.close()
        self.theirs.close()

    def pass_on(self, event: Any) -> None:
        """An event of the link. Who does not read misses frames."""
        packet = packed(event) if hasattr(event, "arbitration_id") else None
        if packet is not None:
            with suppress(OSError):
                self._ours.send(packet, socket.MSG_DONTWAIT)

    def _send(self) -> None:
        with suppress(OSError):
            while packet := self._ours.recv(MOST_BYTES):
                with suppress(ValueError):
                    message = unpacked(packet)
                    self._link.send(message.arbitration_id, bytes(message.data))


def is_shared(bus: Bus) -> bool:
    return bus.interface in SHARED
