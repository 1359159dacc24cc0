"""Holds an emulator to a share of one core, to see whether a test depends on the host's speed.

QUIESCE_VM_CPU_SHARE=0.25 lets each run of QEMU have a quarter of a core: it is stopped (SIGSTOP)
as soon as it has used more, whatever else the host does, and goes on when its share allows it.
Needs no rights and no control group.
"""

import ctypes
import os
import re
import signal
import threading
import time
from dataclasses import dataclass

from quiesce.base.errors import UsageError

VARIABLE = "QUIESCE_VM_CPU_SHARE"
LEAST = 0.01
PERIOD_S = 0.1  # a share of 0.25 runs for 25 ms of it
LOOK_S = 0.005  # how often what it has used is looked at


def wanted() -> float | None:
    """The share that the environment asks for; None: as much as it gets."""
    text = os.environ.get(VARIABLE)
    return share_of(text) if text else None


def share_of(text: str) -> float:
    """UsageError where the text is no share."""
    try:
        share = float(text)
    except ValueError:
        share = 0.0
    if not LEAST <= share <= 1.0:
        raise UsageError(f"{VARIABLE}={text}: expected a share of a core, {LEAST} to 1")
    return share


@dataclass
class Usage:
    """Of all emulators that were held."""

    cpu_s: float = 0.0
    wall_s: float = 0.0

    def line(self) -> str:
        used = self.cpu_s / self.wall_s if self.wall_s else 0.0
        return f"emulator: {used:.3f} of a core over {self.wall_s:.1f} s"


def used_share(text: str) -> float | None:
    """The share in a `Usage.line` somewhere in the text."""
    match = re.search(r"^emulator: ([0-9.]+) of a core", text, re.MULTILINE)
    return float(match[1]) if match else None


total = Usage()


class Holder:
    """Holds a process from now on, until `release` or its end; adds to the usage then."""

    def __init__(self, process_id: int, share: float, usage: Usage) -> None:
        self._process_id = process_id
        self._share = share
        self._usage = usage
        self._clock = _cpu_clock(process_id)
        self._released = threading.Event()
        self._thread = threading.Thread(target=self._hold, daemon=True)
        self._thread.start()

    def release(self) -> None:
        """To be called before the process is waited for: until then its number is its own."""
        self._released.set()
        self._thread.join()

    def _hold(self) -> None:
        start_s = last_s = time.monotonic()
        used_s = 0.0
        credit_s = most_s = self._share * PERIOD_S
        is_stopped = False
        try:
            while not self._released.wait(LOOK_S):
                now_s, cpu_s = time.monotonic(), time.clock_gettime(self._clock)
                credit_s += self._share * (now_s - last_s) - (cpu_s - used_s)
                credit_s = min(credit_s, most_s)
                last_s, used_s = now_s, cpu_s
                must_stop = credit_s < (most_s if is_stopped else 0.0)
                if must_stop != is_stopped:
                    os.kill(self._process_id, signal.SIGSTOP if must_stop else signal.SIGCONT)
                    is_stopped = must_stop
            os.kill(self._process_id, signal.SIGCONT)
        except OSError:  # it has ended
            pass
        self._usage.cpu_s += used_s
        self._usage.wall_s += last_s - start_s


def _cpu_clock(process_id: int) -> int:
    clock = ctypes.c_int()
    error = ctypes.CDLL(None).clock_getcpuclockid(process_id, ctypes.byref(clock))
    if error:
        raise OSError(error, os.strerror(error))
    return clock.value
