"""SLCAN on the Unix socket that is the far end of the guest's serial line.

A Unix socket holds some 280 bytes of an emulated UART that writes them one by one: a dozen frames.
The UART waits while it is full, and the guest's time with it, so the guest is never further ahead
of its peer than that.
"""

import select
import socket
from collections import deque
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.can.slcan import frame_of

READ_BYTES = 4096


class SerialLine:
    """Frames in, frames out; `malformed` counts lines that are no frames."""

    def __init__(self, path: Path) -> None:
        self.malformed = 0
        self.is_over = False  # the far end has closed it
        self._frames: deque[Any] = deque()
        self._rest = b""
        self._socket = socket.socket(socket.AF_UNIX)
        try:
            self._socket.connect(str(path))
        except OSError as error:
            raise BenchFailure(f"the guest's serial line does not answer: {error.strerror}")

    def send(self, frame_id: int, data: bytes) -> None:
        try:
            self._socket.sendall(f"t{frame_id:03X}{len(data)}{data.hex()}\r".encode())
        except OSError as error:
            raise BenchFailure(f"the guest's serial line is gone: {error.strerror}")

    def receive(self, timeout_s: float) -> Any:
        """The next frame; None where none comes in time, or the line is over."""
        while not self._frames and not self.is_over:
            if not select.select([self._socket], [], [], timeout_s)[0]:
                return None
            self._take(self._read())
        return self._frames.popleft() if self._frames else None

    def close(self) -> None:
        self._socket.close()

    def _read(self) -> bytes:
        try:
            data = self._socket.recv(READ_BYTES)
        except ConnectionError:
            data = b""
        self.is_over = not data
        return data

    def _take(self, data: bytes) -> None:
        *lines, self._rest = (self._rest + data).split(b"\r")
        for line in lines:
            frame = frame_of(line, 0.0)
            if frame is None:
                self.malformed += 1
            else:
                self._frames.append(frame)
