"""The guest's serial line as a pseudo-terminal, for programs that open one by its name.

Such a program waits by the clock, and the guest's time is its own: what comes from the guest is
passed on no faster than a real controller would send it, so that the guest is not ahead of it.
"""

import fcntl
import os
import select
import socket
import struct
import termios
import threading
import time
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from quiesce.base.errors import BenchFailure

TICK_S = 0.002  # as in tests/system/vm/guest/tables.sh
SLACK_S = 0.05  # that the guest may make up for where it was late
DEMAND = b"t010"  # once a tick
READ_BYTES = 256  # a dozen frames
WAITING_BYTES = 1024  # that nobody has read yet, at the most
POLL_S = 0.01


class LinePty:
    """path: the Unix socket of the guest's serial line."""

    def __init__(self, path: Path) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        try:
            self._socket.connect(str(path))
        except OSError as error:
            raise BenchFailure(f"the guest's serial line does not answer: {error.strerror}")
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self._is_used = threading.Event()
        self._is_over = threading.Event()
        self._due_s = 0.0
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    @contextmanager
    def in_use(self) -> Iterator[str]:
        """Its name, for one program; what the guest says at other times is dropped."""
        termios.tcflush(self._slave, termios.TCIOFLUSH)
        self._is_used.set()
        try:
            yield os.ttyname(self._slave)
        finally:
            self._is_used.clear()

    def send(self, line: bytes) -> None:
        self._socket.sendall(line + b"\r")

    def close(self) -> None:
        self._is_over.set()
        self._thread.join()
        self._socket.close()
        os.close(self._master)
        os.close(self._slave)

    def _serve(self) -> None:
        while not self._is_over.is_set():
            sources = [self._master, self._socket] if self._has_room() else [self._master]
            ready, _, _ = select.select(sources, [], [], POLL_S)
            if self._master in ready:
                self._socket.sendall(os.read(self._master, READ_BYTES))
            if self._socket in ready:
                data = self._socket.recv(READ_BYTES)
                if not data:
                    return  # the guest is off
                self._pass_on(data)

    def _has_room(self) -> bool:
        if not self._is_used.is_set():
            return True
        waiting = fcntl.ioctl(self._slave, termios.FIONREAD, struct.pack("i", 0))
        return struct.unpack("i", waiting)[0] < WAITING_BYTES

    def _pass_on(self, data: bytes) -> None:
        now_s = time.monotonic()
        self._due_s = max(self._due_s, now_s - SLACK_S) + TICK_S * data.count(DEMAND)
        time.sleep(max(0.0, self._due_s - now_s))
        if self._is_used.is_set():
            os.write(self._master, data)
