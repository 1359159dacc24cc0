"""The place where it is done: a rig on its bus, and what can be done to it there."""

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Protocol

import numpy as np

from quiesce.base.errors import BenchFailure
from quiesce.can.changes import apply
from quiesce.can.parameters import settings_of
from quiesce.plant_id.sweep import Timeline
from quiesce.rig import Rig, Trigger

RUN_S = 20.0  # sensors are judged for a while before it runs
IDLE_S = 5.0
AT_WORK = ("RUN", "DEGRADED")


class Site(Protocol):
    """Entered: nothing is driven, and nothing is when it is left, however that came about."""

    rig: Rig
    is_simulated: bool
    limit_mA: int  # nothing asks for more

    def __enter__(self) -> "Site": ...
    def __exit__(self, *_: object) -> None: ...
    def shake(self, freq_Hz: float, drive_V: float) -> None:
        """The shaker, from now on; 0 V: not at all."""

    def turn(self, gravity_g: float, how: str) -> None:
        """The accelerometer lies so that it reads this. how: in words."""

    def settle(self, length_s: float) -> None:
        """Of the rig's own time."""

    def armed(self, why: str) -> "_Armed":
        """Entered the controller runs, left it does not."""

    def played(self, line: Timeline, name: str, has_damper: bool) -> None:
        """Plays drive and current, and leaves the recording as NAME.csv in the folder."""

    def mount_damper(self) -> None:
        """It was off while something was played."""


class _Armed(Protocol):
    def __enter__(self) -> None: ...
    def __exit__(self, *_: object) -> None: ...


def give(rig: Rig, settings: dict[str, int | str]) -> None:
    """To a controller that is disarmed, all of it or nothing. BenchFailure where it is refused."""
    apply(rig.tables().services, settings_of([f"{key}={one}" for key, one in settings.items()]))


@contextmanager
def running(rig: Rig) -> Iterator[None]:
    """Waits for RUN. Somebody else gives the enable before, and takes it after. BenchFailure where
    it has stopped by itself meanwhile: what was measured was not at work."""
    if rig.read("status/fault") != "NONE":
        raise BenchFailure(f"the controller is in fault {rig.read('status/fault')}: see to that")
    rig.wait(Trigger("status/state", equal="RUN"), RUN_S)
    yield
    state = rig.read("status/state")
    if state not in AT_WORK:
        raise BenchFailure(
            f"the controller stopped by itself: {state}, fault {rig.read('status/fault')}; "
            "docs/reference/faults.md tells what to look at"
        )


def until_idle(rig: Rig, timeout_s: float = IDLE_S) -> bool:
    """Whether it runs no more."""
    end_s = time.monotonic() + timeout_s
    while time.monotonic() < end_s:
        if rig.read("status/state") not in AT_WORK:
            return True
    return False


def heard(site: Site, paths: Sequence[str], length_s: float) -> dict[str, np.ndarray]:
    """Numbers of these signals while so much of the rig's own time passes. BenchFailure where a
    signal is silent."""
    before = {path: np.empty(0) for path in paths}
    left_s = length_s
    while left_s > 0.05 * length_s:
        start = clock_s(site)
        found = site.rig.capture(list(paths), max(left_s, 0.2))
        for path in paths:
            values = np.asarray(found[path].values, float)
            before[path] = np.concatenate([before[path], values])
        left_s -= max(clock_s(site) - start, 1e-3)
    for path, values in before.items():
        if not len(values):
            raise BenchFailure(f"{path}: nothing came in {length_s:g} s")
    return before


def clock_s(site: Site) -> float:
    """The rig's own time: one in the computer may be late."""
    return float(site.rig.read("rig/time_s")) if site.is_simulated else time.monotonic()
