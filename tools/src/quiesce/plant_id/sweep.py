"""The excitation and the current steps to record, from which find.py finds a plant.

One sweep without current, then dwells at fixed frequencies with current steps. Every part starts
and ends at rest, so that each can be simulated from zero and nothing leaks from one to the next.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.recording.write import write_columns

# Part of a sweep over which the drive rises at its start and falls at its end.
FADE_s = 0.5
# Fractions of the largest current that a dwell holds: up for force and yield, down for the lag.
HELD_FRACTIONS = (0.0, 0.25, 0.5, 1.0, 0.5, 0.0)
# Then the current jumps between 0 and the largest at uneven intervals: what the lag shows in most.
JUMP_INTERVALS_s = (0.11, 0.17, 0.13, 0.23, 0.19, 0.14, 0.21, 0.12, 0.16, 0.18)
# Samples a period that the fastest frequency needs at least.
MIN_SAMPLES_A_PERIOD = 8
MAX_ROWS = 4_000_000


@dataclass(frozen=True)
class SweepPlan:
    """What to record. Times are rounded to whole samples."""

    rate_Hz: int = 1000
    low_Hz: float = 3.0
    high_Hz: float = 120.0
    is_linear: bool = False
    sweep_s: float = 60.0
    drive_V: float = 0.1
    dwell_Hz: tuple[float, ...] = (5.0, 8.0, 12.0, 18.0)
    dwell_drive_V: float = 0.1
    max_current_A: float = 5.0
    hold_s: float = 1.0
    rest_s: float = 2.0

    def __post_init__(self) -> None:
        check_plan(self)


@dataclass(frozen=True)
class Timeline:
    """A drive against time at `rate_Hz`: drive = amplitude_V sin(2 pi phase_cycles)."""

    rate_Hz: int
    amplitude_V: np.ndarray
    phase_cycles: np.ndarray
    current_A: np.ndarray

    @property
    def time_s(self) -> np.ndarray:
        return np.arange(len(self.amplitude_V)) / self.rate_Hz

    @property
    def drive_V(self) -> np.ndarray:
        return self.amplitude_V * np.sin(2.0 * np.pi * self.phase_cycles)


def check_plan(plan: SweepPlan) -> None:
    """UsageError, naming the option, for a plan that cannot be recorded."""
    fastest_Hz = max(plan.high_Hz, *plan.dwell_Hz)
    rules = (
        (bool(plan.dwell_Hz), "--dwell-hz: name at least one frequency"),
        (0.0 < plan.low_Hz < plan.high_Hz, "--band: expected 0 < LOW < HIGH"),
        (min(plan.dwell_Hz, default=0.0) > 0.0, "--dwell-hz: expected frequencies above 0"),
        (
            plan.rate_Hz >= MIN_SAMPLES_A_PERIOD * fastest_Hz,
            f"--rate {plan.rate_Hz}: {fastest_Hz:g} Hz needs at least "
            f"{math.ceil(MIN_SAMPLES_A_PERIOD * fastest_Hz)} Hz",
        ),
        (plan.sweep_s >= 4.0 * FADE_s, f"--sweep-s: at least {4.0 * FADE_s:g} s"),
        (plan.drive_V > 0.0 and plan.dwell_drive_V > 0.0, "--drive: expected more than 0 V"),
        (plan.max_current_A > 0.0, "--max-current: expected more than 0 A"),
        (plan.hold_s > 0.0 and plan.rest_s > 0.0, "--hold-s, --rest-s: expected more than 0 s"),
        (duration_s(plan) * plan.rate_Hz <= MAX_ROWS, f"more than {MAX_ROWS} rows; shorten it"),
    )
    for is_met, problem in rules:
        if not is_met:
            raise UsageError(problem)


def dwell_s(plan: SweepPlan) -> float:
    """Length of one dwell."""
    return len(HELD_FRACTIONS) * plan.hold_s + sum(JUMP_INTERVALS_s) + plan.hold_s


def duration_s(plan: SweepPlan) -> float:
    count = len(plan.dwell_Hz)
    return plan.sweep_s + count * dwell_s(plan) + (count + 2) * plan.rest_s


def sweep_phase(plan: SweepPlan, time_s: np.ndarray) -> np.ndarray:
    """Cycles since the sweep's start."""
    span = time_s / plan.sweep_s
    if plan.is_linear:
        return time_s * (plan.low_Hz + 0.5 * (plan.high_Hz - plan.low_Hz) * span)
    octaves = math.log(plan.high_Hz / plan.low_Hz)
    return plan.low_Hz * plan.sweep_s / octaves * np.expm1(octaves * span)


def fade(time_s: np.ndarray, length_s: float) -> np.ndarray:
    """0 at both ends, 1 between, raised cosines of FADE_s."""
    nearest_s = np.minimum(time_s, length_s - time_s)
    return 0.5 - 0.5 * np.cos(np.pi * np.clip(nearest_s / FADE_s, 0.0, 1.0))


def rest_part(plan: SweepPlan, cycles: float = 0.0) -> np.ndarray:
    """No drive; its phase is where the part before it would go on."""
    rest = np.zeros((3, round(plan.rest_s * plan.rate_Hz)))
    rest[1] = cycles
    return rest


def sweep_part(plan: SweepPlan) -> np.ndarray:
    """Rows: amplitude, phase, current."""
    time_s = np.arange(round(plan.sweep_s * plan.rate_Hz)) / plan.rate_Hz
    amplitude_V = plan.drive_V * fade(time_s, plan.sweep_s)
    return np.array([amplitude_V, sweep_phase(plan, time_s), np.zeros_like(time_s)])


def dwell_currents(plan: SweepPlan) -> np.ndarray:
    """Current of one dwell, a value a sample: held levels, then jumps, then none."""
    steps = [(fraction, plan.hold_s) for fraction in HELD_FRACTIONS]
    steps += [(float(i % 2 == 0), length) for i, length in enumerate(JUMP_INTERVALS_s)]
    steps.append((0.0, plan.hold_s))
    edges = np.rint(np.cumsum([0.0, *(length for _, length in steps)]) * plan.rate_Hz).astype(int)
    return np.repeat([plan.max_current_A * part for part, _ in steps], np.diff(edges))


def dwell_part(plan: SweepPlan, freq_Hz: float) -> np.ndarray:
    current_A = dwell_currents(plan)
    time_s = np.arange(len(current_A)) / plan.rate_Hz
    return np.array([np.full_like(time_s, plan.dwell_drive_V), freq_Hz * time_s, current_A])


def timeline(plan: SweepPlan) -> Timeline:
    parts = [rest_part(plan)]
    for part in (sweep_part(plan), *(dwell_part(plan, freq_Hz) for freq_Hz in plan.dwell_Hz)):
        parts += [part, rest_part(plan, 2.0 * part[1, -1] - part[1, -2])]
    return Timeline(plan.rate_Hz, *np.concatenate(parts, axis=1))


COLUMNS = ("time_s", "drive_V", "current_cmd_A", "accel_m_s2")


def write_line(file: Path, line: Timeline, accel_m_s2: np.ndarray | None = None) -> None:
    """One row a sample, in the format that the suffix asks for, CSV without one that is known. With
    an acceleration it is a recording."""
    columns = [line.time_s, line.drive_V, line.current_A]
    columns += [] if accel_m_s2 is None else [accel_m_s2]
    write_columns(file, dict(zip(COLUMNS, columns, strict=False)))
