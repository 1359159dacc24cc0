"""A bus that another program of this computer has, lent over a pair of sockets: a frame a packet,
its time (f64, seconds since 1970), its id (u32) and its data, little-endian. Standard data frames
only.

Who lends it is at one end; at the other a driver as python-can has them.
"""

import os
import select
import socket
import struct
import time
from dataclasses import dataclass
from typing import Any

from quiesce.can.buses import Bus

HEAD = struct.Struct("<dI")
MOST_BYTES = HEAD.size + 64


def pair() -> tuple[socket.socket, socket.socket]:
    return socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)


def packed(message: Any) -> bytes | None:
    """None for a frame that is not lent."""
    if message.is_extended_id or message.is_remote_frame or message.is_error_frame:
        return None
    return HEAD.pack(message.timestamp, message.arbitration_id) + bytes(message.data)


def unpacked(packet: bytes) -> Any:
    """ValueError where it is no frame."""
    from quiesce.can.python_can import can

    if not HEAD.size <= len(packet) <= MOST_BYTES:
        raise ValueError(f"{len(packet)} bytes are no frame")
    time_s, frame_id = HEAD.unpack_from(packet)
    return can.Message(
        timestamp=time_s,
        arbitration_id=frame_id,
        is_extended_id=False,
        data=packet[HEAD.size :],
        is_fd=len(packet) - HEAD.size > 8,
        check=True,
    )


@dataclass(frozen=True)
class LentBus(Bus):
    """fd: of this program's end, which stays open."""

    fd: int = -1

    def open(self) -> "LentDriver":
        return LentDriver(self.fd)


def lent_bus(fd: int) -> LentBus:
    return LentBus("lent", str(fd), None, (), fd)


class LentDriver:
    """What came before it was opened is old, and left out. The descriptor is not its own."""

    def __init__(self, fd: int) -> None:
        self._fd = fd
        while self.recv(0.0) is not None:
            pass

    def recv(self, timeout_s: float) -> Any:
        """OSError where who lends it is gone."""
        if not select.select([self._fd], [], [], timeout_s)[0]:
            return None
        packet = os.read(self._fd, MOST_BYTES)
        if not packet:
            raise OSError("who lent the bus is gone")
        return unpacked(packet)

    def send(self, message: Any) -> None:
        message.timestamp = message.timestamp or time.time()
        packet = packed(message)
        if packet is None:
            raise ValueError("only standard data frames can be sent")
        os.write(self._fd, packet)

    def shutdown(self) -> None:
        """The descriptor stays."""
