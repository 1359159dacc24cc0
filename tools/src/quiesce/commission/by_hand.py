"""A controller on a bus, and somebody who stands beside it."""

import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.base.paths import shown
from quiesce.can.database import load
from quiesce.can.emergency import StopFrames
from quiesce.can.operator import Operator
from quiesce.commission.folder import Folder
from quiesce.commission.hand import Hand
from quiesce.commission.site import running, until_idle
from quiesce.plant_id.sweep import Timeline, write_line
from quiesce.rig import Rig

IDLE_S = 1.0  # a controller whose enable is taken away has its safe current within two ticks
STOP_S = 5.0


class SiteByHand:
    """limit_mA: what its user says that coil and driver may carry."""

    is_simulated = False

    def __init__(self, rig: Rig, hand: Hand, folder: Folder, limit_mA: int) -> None:
        self.rig = rig
        self.limit_mA = limit_mA
        self._hand = hand
        self._folder = folder
        self._database = load()
        self._operator = Operator(rig.send, self._database)
        self._shaken: tuple[float, float] | None = None  # nobody has said yet

    def __enter__(self) -> "SiteByHand":
        self.rig.__enter__()
        self._operator.__enter__()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._operator.__exit__(kind, error, trace)
        self.rig.__exit__(kind, error, trace)

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
        self._operator.enable()
        try:
            with running(self.rig):
                yield
        finally:
            with uninterrupted():
                self._make_safe()

    def _make_safe(self) -> None:
        """No enable; where that does not do, the emergency stop. BenchFailure where that does not
        either."""
        self._operator.disable()
        try:
            if until_idle(self.rig, IDLE_S):
                return
        except BenchFailure:
            pass  # nothing is heard of it: all the more
        frames = StopFrames(self._database)
        end_s = time.monotonic() + STOP_S
        while time.monotonic() < end_s:
            self.rig.send(frames.frame_id, frames.next())
            time.sleep(frames.cycle_s)
            if self._is_stopped():
                return
        raise BenchFailure("the controller does not tell that it has stopped: use its own switch")

    def _is_stopped(self) -> bool:
        try:
            return until_idle(self.rig, 0.2)
        except BenchFailure:
            return False

    def played(self, line: Timeline, name: str, has_damper: bool) -> None:
        """UsageError where the recording is not there when he says that it is."""
        asked = self._folder.path / f"{name}_to_play.csv"
        file = self._folder.path / f"{name}.csv"
        write_line(asked, line)
        if not file.is_file():
            damper = "" if has_damper else "Take the damper off. "
            self._hand.do(
                f"{damper}Play drive_V and current_cmd_A of {shown(asked)} at {line.rate_Hz} Hz "
                f"through shaker and driver; record the acceleration beside them as accel_m_s2, in "
                f"{shown(file)}"
            )
        if not file.is_file():
            raise UsageError(f"{shown(file)}: no such file; it is the recording of {shown(asked)}")


@contextmanager
def uninterrupted() -> Iterator[None]:
    """A second Ctrl-C waits until the controller is safe."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
