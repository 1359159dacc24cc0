"""A controller on a bus, and somebody who stands beside it."""

import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.base.paths import shown
from quiesce.can.database import load
from quiesce.can.operator import Operator
from quiesce.commission.folder import Folder
from quiesce.commission.hand import Hand
from quiesce.commission.site import running, until_idle
from quiesce.commission.wants import Wants
from quiesce.plant_id.sweep import Timeline, write_line
from quiesce.rig import Rig

IDLE_S = 1.0  # a controller whose enable is taken away has its safe current within two ticks
STOP_S = 5.0
ENABLE_S = 2.0  # an enable over CAN is seen in four of its frames
RESET_S, PRESS_S = 5.0, 0.6


class SiteByHand:
    """limit_mA: what its user says that coil and driver may carry."""

    is_simulated = False

    def __init__(self, rig: Rig, hand: Hand, folder: Folder, limit_mA: int) -> None:
        self.rig = rig
        self.limit_mA = limit_mA
        self._hand = hand
        self._folder = folder
        self._operator = Operator(rig.send, load())
        self._shaken: tuple[float, float] | None = None  # nobody has said yet

    def __enter__(self) -> "SiteByHand":
        self.rig.__enter__()
        self._operator.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self._operator.__exit__(*error)
        self.rig.__exit__(*error)

    def shake(self, freq_Hz: float, drive_V: float) -> None:
        wanted = (freq_Hz if drive_V else 0.0, drive_V)
        if wanted == self._shaken:
            return
        self._shaken = wanted
        if drive_V:
            self._hand.do(f"shake it with a sine of {freq_Hz:g} Hz, {drive_V:g} V")
        else:
            self._hand.do("switch the shaker off, and let everything come to rest")

    def turn(self, gravity_g: float, how: str) -> None:
        self._hand.do(how)

    def settle(self, length_s: float) -> None:
        time.sleep(length_s)

    @contextmanager
    def armed(self, why: str) -> Iterator[None]:
        """Ctrl-C, and whatever else ends it, leaves the safe current behind."""
        self._hand.allow(
            f"{why}: up to {1e-3 * self.limit_mA:g} A through the coil. Hands off the damper, the "
            "emergency stop within reach"
        )
        had_to_stop = False
        try:
            self._enable()
            with running(self.rig):
                yield
        finally:
            with uninterrupted():
                had_to_stop = self._make_safe()
        if had_to_stop:
            self._hand.do(
                "stopped by EmergencyStop, as its enable was still there. Take your enable away; "
                "the stop is acknowledged after that"
            )
            self._acknowledge()

    def _enable(self) -> None:
        """Over CAN, and by the hand where something else is needed, too."""
        self._operator.enable()
        end_s = time.monotonic() + ENABLE_S
        while not self.rig.read("status/is_enabled"):
            if time.monotonic() > end_s:
                self._hand.do(
                    "OperatorCommand does not enable it: give the enable that you have at hand, "
                    "current flows from then on"
                )
                return

    def _make_safe(self) -> bool:
        """No enable; where that does not do, the emergency stop, and whether it had to be used.
        BenchFailure where that does not do either."""
        self._operator.disable()
        try:
            if until_idle(self.rig, IDLE_S):
                return False
        except BenchFailure:
            pass  # nothing is heard of it: all the more
        if not self.rig.emergency_stop(STOP_S):
            raise BenchFailure(
                "the controller does not tell that it has stopped: use its own switch"
            )
        return True

    def _acknowledge(self) -> None:
        """Of the fault. BenchFailure where the enable is still there, or the fault stays."""
        if self.rig.read("status/is_enabled"):
            raise BenchFailure("the enable is still there, the stop stays: take it away")
        end_s = time.monotonic() + RESET_S
        while time.monotonic() < end_s:
            self._operator.acknowledge()
            time.sleep(PRESS_S)
            if self.rig.read("status/fault") == "NONE":
                return
        raise BenchFailure(f"fault {self.rig.read('status/fault')} stays: is a stop pressed?")

    def played(self, line: Timeline, name: str, has_damper: bool) -> None:
        """A recording of this very line is used as it is. UsageError where none is there when he
        says that it is."""
        asked, file = to_play(self._folder.path, name), self._folder.path / f"{name}.csv"
        before = asked.read_bytes() if asked.is_file() else b""
        write_line(asked, line)
        if file.is_file() and asked.read_bytes() != before:
            os.replace(file, file.with_name(f"{name}_older.csv"))  # of another line, or another day
        if not file.is_file():
            self._ask_for(line, asked, file, has_damper)
        if not file.is_file():
            raise UsageError(f"{shown(file)}: no such file; it is the recording of {shown(asked)}")

    def _ask_for(self, line: Timeline, asked: Path, file: Path, has_damper: bool) -> None:
        if (most_A := float(line.current_A.max())) > 0.0:
            self._hand.allow(
                f"current_cmd_A of {shown(asked)} drives up to {most_A:g} A through the coil. "
                "Hands off the damper, the emergency stop within reach"
            )
        damper = "" if has_damper else "Take the damper off. "
        self._hand.do(
            f"{damper}Play drive_V and current_cmd_A of {shown(asked)} at {line.rate_Hz} Hz "
            f"through shaker and driver; record the acceleration beside them as accel_m_s2, in "
            f"{shown(file)}"
        )

    def mount_damper(self) -> None:
        self._hand.do("mount the damper again")


def site_on_bus(rig: Rig, hand: Hand, wants: Wants, folder: Folder) -> SiteByHand:
    assert wants.max_current_A is not None  # begun() has seen to that
    return SiteByHand(rig, hand, folder, round(1e3 * wants.max_current_A))


def to_play(folder: Path, name: str) -> Path:
    """What a recording is of; where it is gone the recording is of something else."""
    return folder / f"{name}_to_play.csv"


@contextmanager
def uninterrupted() -> Iterator[None]:
    """A second Ctrl-C waits until the controller is safe."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
