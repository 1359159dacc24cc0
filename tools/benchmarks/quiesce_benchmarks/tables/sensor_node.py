"""A sensor node as a process of its own, between a controller's line and the bench's end of it:
every demand is answered with the next sample, all else passes.

    sensor_node TARGET TARGET_END BENCH <SAMPLES

Three open files by their numbers; lines, which are sent in a circle. It goes before the rest of
the machine where it may: samples that come in bursts are refused by a controller, and a thread of
the bench waits for the others.
"""

import contextlib
import fcntl
import os
import select
import sys
import termios
import time

DEMAND, DEMAND_BYTES, ALIVE_AT = b"t0104", 13, 9
READ_S = 0.0003  # an emulator writes byte by byte, and would wake it each time
# A frame that has not left is replaced by the next one: no row of old ones builds up before a
# controller that reads slowly.
MOST_WAITING_BYTES = 48


def takes_more(end: int) -> bool:
    """Whether its reader keeps up."""
    found = fcntl.ioctl(end, termios.FIONREAD, bytes(4))
    return int.from_bytes(found, sys.byteorder) < MOST_WAITING_BYTES


class SensorNode:
    def __init__(self, target: int, target_end: int, bench: int, samples: list[bytes]) -> None:
        self._target, self._target_end, self._bench = target, target_end, bench
        self._samples = samples
        self._ticks, self._alive = 0, 0
        self._rest = b""
        self._waiting = b""  # for the bench

    def run(self) -> None:
        """Until the bench has gone."""
        while True:
            writers = [self._bench] if self._waiting else []
            readers, _, _ = select.select([self._target, self._bench], writers, [])
            if self._target in readers:
                self._from_target()
            if self._bench in readers:
                data = os.read(self._bench, 65536)
                if not data:
                    return
                self._write(data)
            self._pass_on()

    def _from_target(self) -> None:
        time.sleep(READ_S)
        with contextlib.suppress(OSError):  # flushed meanwhile
            data = os.read(self._target, 65536)
            self._waiting += data
            *lines, self._rest = (self._rest + data).split(b"\r")
            for line in lines:
                self._answer(line)

    def _answer(self, line: bytes) -> None:
        """The counter of demands is its clock, so that those that are lost count."""
        if line[:5] != DEMAND or len(line) != DEMAND_BYTES:
            return
        alive = int(line[ALIVE_AT : ALIVE_AT + 1], 16)
        self._ticks += (alive - self._alive - 1) % 16 + 1
        self._alive = alive
        if takes_more(self._target_end):
            self._write(self._samples[self._ticks % len(self._samples)])

    def _write(self, data: bytes) -> None:
        """A line that nobody reads loses frames."""
        with contextlib.suppress(OSError):
            os.write(self._target, data)

    def _pass_on(self) -> None:
        with contextlib.suppress(BlockingIOError):
            self._waiting = self._waiting[os.write(self._bench, self._waiting) :]


def main() -> None:
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))
    target, target_end, bench = map(int, sys.argv[1:])
    samples = sys.stdin.buffer.read().splitlines(keepends=True)
    with contextlib.suppress(ConnectionError):
        SensorNode(target, target_end, bench, samples).run()


if __name__ == "__main__":
    main()
