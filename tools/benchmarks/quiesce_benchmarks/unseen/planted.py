"""Faults of channels planted into measured tests, as a rig makes them, then filtered, thinned."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from quiesce.damper.data.read import RawTest

CLIPPED_AT = 0.8  # of the force's ends
STUCK_S = 0.5  # at the end, or three quarters of a cycle where that is longer
STUCK_CYCLES = 0.75
NOISE = 0.003  # of the force's span
# The low-pass of whoever exported the file, and the rows that are kept of it.
_FILTER_CYCLES = 20.0
_ROWS_A_CYCLE = 40


@dataclass(frozen=True)
class Planted:
    """A test with a fault, and what a message about it says."""

    name: str
    test: RawTest
    word: str


def with_channel(test: RawTest, role: str, values: np.ndarray) -> RawTest:
    return replace(test, si={**test.si, role: values})


def exported(test: RawTest, cycle_rows: float, noise: float, seed: int) -> RawTest:
    """The force with noise; force and displacement low-passed; rows thinned."""
    from scipy.signal import butter, sosfiltfilt

    force_N = test.si["force"]
    rng = np.random.default_rng(seed)
    si = {**test.si, "force": force_N + rng.normal(0.0, noise * np.ptp(force_N), len(force_N))}
    step = max(1, int(cycle_rows / _ROWS_A_CYCLE))
    if step > 1:
        sos = butter(4, 2.0 * _FILTER_CYCLES / cycle_rows, output="sos")
        si |= {role: sosfiltfilt(sos, si[role]) for role in ("displacement", "force")}
    return replace(
        test,
        period_s=test.period_s * step,
        time_s=test.time_s[::step],
        si={role: values[::step] for role, values in si.items()},
    )


def clipped(test: RawTest) -> RawTest:
    force_N = test.si["force"]
    middle_N = 0.5 * (force_N.max() + force_N.min())
    half_N = CLIPPED_AT * 0.5 * np.ptp(force_N)
    return with_channel(test, "force", np.clip(force_N, middle_N - half_N, middle_N + half_N))


def stuck(test: RawTest, role: str, cycle_rows: float) -> RawTest:
    values = test.si[role].copy()
    rows = round(max(STUCK_S / test.period_s, STUCK_CYCLES * cycle_rows))
    values[-rows:] = values[-rows]
    return with_channel(test, role, values)


def drifting(test: RawTest) -> RawTest:
    """By a quarter of the force's span over the test."""
    force_N = test.si["force"]
    ramp = np.linspace(0.0, 0.25 * np.ptp(force_N), len(force_N))
    return with_channel(test, "force", force_N + ramp)


def planted(test: RawTest, cycle_rows: float, seed: int) -> Iterator[Planted]:
    """Saturated and stuck channels, each as measured and as exported."""
    makers: dict[str, tuple[Callable[[RawTest], RawTest], str]] = {
        "clipped force": (clipped, "is its channel saturated?"),
        "stuck force": (lambda one: stuck(one, "force", cycle_rows), "the force stands still"),
        "stuck displacement": (
            lambda one: stuck(one, "displacement", cycle_rows),
            "the displacement stands still",
        ),
    }
    for name, (make, word) in makers.items():
        faulty = make(test)
        yield Planted(name, faulty, word)
        yield Planted(f"{name}, exported", exported(faulty, cycle_rows, 0.0, seed), word)
        yield Planted(f"{name}, noisy, exported", exported(faulty, cycle_rows, NOISE, seed), word)
