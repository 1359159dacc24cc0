"""The bus between a controller and its tools: serial lines with SLCAN, joined by a thread that is
the operator as well, and looks at every demand; sensor_node.py is at the controller's end.

Time is the controller's: a tick is a demand frame, so that an emulator may be slow.
"""

import contextlib
import os
import re
import select
import socket
import subprocess
import sys
import termios
import threading
import time
import tty
from collections.abc import Callable, Iterable
from queue import SimpleQueue

from quiesce.base.errors import BenchFailure
from quiesce.can.database import load
from quiesce.can.e2e import protect

from quiesce_benchmarks.tables import sensor_node
from quiesce_benchmarks.tables.bus import Bus
from quiesce_benchmarks.tables.sensor_node import takes_more

DEMAND_ID, REPLY_ID, FLOW_ID = 0x010, 0x408, 0x418
DEMAND = b"t0104"
FRAME = re.compile(rb"t[0-9A-F]{3}([0-8])([0-9A-F]*)")
INIT, IDLE, RUN, SAFE, FAULT, ARMED, DEGRADED, SELF_TEST = range(8)
RUNNING = (RUN, DEGRADED)
HELD = (RUN, DEGRADED, SAFE, ARMED)  # an enable that is held keeps it armed
COMMAND_TICKS = 100
LET_GO, PRESSED = 4, 12  # commands
SAMPLES = 4000  # of the vibration, in a circle
COUNTS, PERIOD_ticks = 40_000, 100
READ_S = 0.0005
QUIET_S = 0.05  # after what a controller that has ended left behind
SILENT_S = 60.0  # a controller on a busy machine


def slcan(identifier: int, data: bytes) -> bytes:
    return b"t%03X%d%s\r" % (identifier, len(data), data.hex().upper().encode())


def is_frame(line: bytes) -> bool:
    """Not where a program was killed in the middle of one."""
    found = FRAME.fullmatch(line)
    return found is not None and len(found[2]) == 2 * int(found[1])


def sample_lines() -> list[bytes]:
    """A steady vibration with a little noise, frames as a sensor node sends them."""
    import math

    database = load()
    layout = database.by_name["AccelSample"].protection
    assert layout is not None
    lines = []
    for number in range(SAMPLES):
        counts = round(COUNTS * math.sin(2.0 * math.pi * number / PERIOD_ticks))
        data = (counts + number * 7919 % 101 & 0xFFFFFF).to_bytes(3, "little") + b"\0\0"
        lines.append(slcan(layout.frame_id, protect(layout, number % 16, data)))
    return lines


def node_socket() -> tuple[int, int]:
    """The bench's end and the sensor node's."""
    ours, its = socket.socketpair()
    for one in (ours, its):
        one.setblocking(False)
    return ours.detach(), its.detach()


def raw_pty() -> tuple[int, int, str]:
    """Master, slave and the slave's name."""
    master, slave = os.openpty()
    tty.setraw(master)
    tty.setraw(slave)
    os.set_blocking(master, False)
    return master, slave, os.ttyname(slave)


class Line:
    """Entered: runs. `target` and `client` are the names of the two lines' ends; a frame of an id
    that somebody listens to goes there, too. bus: what a frame takes on a real one, None: no
    time."""

    def __init__(self, bus: Bus | None = None) -> None:
        self._pty, self._target_end, self.target = raw_pty()
        self._client, self._client_end, self.client = raw_pty()
        self.bus = bus
        self.forwards: frozenset[int] | None = None  # to the client; None: all
        self.is_to_arm = False
        self.patience_ticks = 0  # of its target, for an effect
        self.demands: list[tuple[int, int, int]] = []  # current_mA, state, alive
        self.ticks = 0  # by the demands' counter: those that were lost count
        self.missed = 0  # of them
        self._listeners: dict[int, SimpleQueue[bytes]] = {}
        self._samples = sample_lines()
        self._target, self._node_end = (self._pty, -1) if bus else node_socket()
        self._node: subprocess.Popen[bytes] | None = None
        layout = load().by_name["OperatorCommand"].protection
        assert layout is not None
        self._operator = layout
        self._commands = 0
        self._changed = threading.Condition()
        self._is_over = False
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> "Line":
        if self.bus is None:
            self._start_node()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._is_over = True
        self._thread.join()
        if self._node is not None:
            os.close(self._target)  # which ends it
            self._node.wait()
        for end in (self._pty, self._target_end, self._client, self._client_end):
            os.close(end)

    def _start_node(self) -> None:
        files = (self._pty, self._target_end, self._node_end)
        words = [sys.executable, "-I", sensor_node.__file__, *map(str, files)]
        self._node = subprocess.Popen(words, stdin=subprocess.PIPE, pass_fds=files)
        os.close(self._node_end)
        assert self._node.stdin is not None
        with self._node.stdin as samples:
            samples.write(b"".join(self._samples))

    # What a client of the bench's own does

    def listen(self, identifiers: Iterable[int]) -> SimpleQueue[bytes]:
        """Frames of these ids from now on, as lines without their ends."""
        found: SimpleQueue[bytes] = SimpleQueue()
        for identifier in identifiers:
            self._listeners[identifier] = found
        return found

    def send(self, identifier: int, data: bytes) -> None:
        self._to_target(slcan(identifier, data))

    # What happens

    @property
    def state(self) -> int:
        return self.demands[-1][1] if self.demands else INIT

    def largest_mA(self, ticks: int) -> int:
        """Of the last ticks."""
        return max((one[0] for one in self.demands[-ticks:]), default=0)

    def restarted(self) -> None:
        """The controller has ended, and the next one is to begin with an empty line."""
        termios.tcflush(self._target_end, termios.TCIOFLUSH)
        last = -1
        while self.ticks != last:
            last = self.ticks
            time.sleep(QUIET_S)
        with self._changed:
            self.demands.clear()

    def wait(self, holds: Callable[[], bool], ticks: int, what: str) -> None:
        """BenchFailure where it does not hold within so many ticks, or the line is silent."""
        end = self.ticks + ticks
        with self._changed:
            last, silent_s = self.ticks, time.monotonic() + SILENT_S
            while not holds():
                self._changed.wait(0.1)
                if self.ticks != last:
                    last, silent_s = self.ticks, time.monotonic() + SILENT_S
                if self.ticks > end:
                    raise BenchFailure(f"not within {ticks} ticks: {what}")
                if time.monotonic() > silent_s:
                    raise BenchFailure(f"the controller is silent: {what}")

    # The thread

    def _run(self) -> None:
        rests: dict[int, bytes] = {}
        while not self._is_over:
            # An emulator writes byte by byte, and would wake this thread each time.
            time.sleep(READ_S)
            with contextlib.suppress(OSError):  # it has just been closed
                for end in select.select([self._target, self._client], [], [], 0.05)[0]:
                    data = os.read(end, 65536)
                    if not data:
                        time.sleep(0.01)  # it has hung up
                    *lines, rests[end] = (rests.get(end, b"") + data).split(b"\r")
                    for line in lines:
                        (self._from_target if end == self._target else self._from_client)(line)
            with self._changed:
                self._changed.notify_all()

    def _from_target(self, line: bytes) -> None:
        if not is_frame(line):
            return
        if line[:5] == DEMAND:
            self._on_demand(line)
        if self.bus is not None:
            self.bus.put(line, self._to_tools)
        else:
            self._to_tools(line)

    def _to_tools(self, line: bytes) -> None:
        identifier = int(line[1:4], 16)
        if identifier in self._listeners:
            self._listeners[identifier].put(line)
        if self.forwards is None or identifier in self.forwards:
            self._write(self._client, line + b"\r")

    def _from_client(self, line: bytes) -> None:
        if is_frame(line):
            self._to_target(line + b"\r")

    def _to_target(self, line: bytes) -> None:
        if self.bus is not None:
            self.bus.put(line, lambda one: self._write(self._target, one))
        else:
            self._write(self._target, line)

    @staticmethod
    def _write(end: int, line: bytes) -> None:
        """A line that nobody reads loses frames."""
        with contextlib.suppress(OSError):
            os.write(end, line)

    def _on_demand(self, line: bytes) -> None:
        word = int.from_bytes(bytes.fromhex(line[5:11].decode()), "little")
        alive = word >> 20 & 15
        step = (alive - self.demands[-1][2] - 1) % 16 + 1 if self.demands else 1
        self.ticks += step
        self.missed += step - 1
        self.demands.append((word & 0xFFFF, word >> 17 & 7, alive))
        if self.bus is not None and takes_more(self._target_end):
            self._to_target(self._samples[self.ticks % SAMPLES])
        if self.ticks >= self._commands * COMMAND_TICKS:
            self._commands = self.ticks // COMMAND_TICKS + 1
            self._command()
        if self.bus is not None:
            self.bus.pass_tick()

    def _command(self) -> None:
        """Lets go and presses by turns until it is armed, and holds then."""
        number = self._commands
        presses = number % (LET_GO + PRESSED) >= LET_GO or self.state in HELD
        enable = int(self.is_to_arm and presses)
        reset = int(self.state == FAULT and number // 2 % 2)
        data = protect(self._operator, number % 16, bytes([enable | reset << 1, 0]))
        self._to_target(slcan(self._operator.frame_id, data))
