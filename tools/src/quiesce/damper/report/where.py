"""Where a model's error is made: when, at which speeds, at which commands."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper.data.channels import cycles_of
from quiesce.damper.report.runs import Run, command_parts, shortened

# Windows that a test is looked at in: no shorter than a cycle, which errs in its own way.
_WINDOWS = (4, 40)
# Speeds, as parts of a test's largest.
_SPEEDS = ((0.0, 0.1), (0.1, 0.3), (0.3, 0.6), (0.6, 1.01))
# A stretch is told where it has half of the squared error in at most this part of the time.
_HALF, _SHORT = 0.5, 0.15
# In fewer cycles of the motion one turning point is as much.
_LEAST_CYCLES = 4.0
# Rows are told where their part of the squared error is this many times their part of the rows.
_NOTABLE = 2.0


@dataclass(frozen=True)
class Place:
    """Rows with something in common: their parts of all rows and of the squared error."""

    text: str
    rows: float
    error: float


@dataclass(frozen=True)
class Course:
    """One test: windows' middles in s from its start, and each one's root mean square error as a
    part of the test's root mean square force, [windows]."""

    label: str
    time_s: np.ndarray
    error: np.ndarray


def course_of(run: Run) -> Course:
    cycle = cycles_of(run.segment.record.disp_m[run.segment.rows])
    cycles = _WINDOWS[1] if cycle is None else int(len(run.model_N) / float(np.median(cycle)))
    count = max(1, min(int(np.clip(cycles, *_WINDOWS)), len(run.model_N) // 4))
    parts = np.array_split(np.arange(len(run.model_N)), count)
    size = float(np.sqrt(np.mean(run.measured_N**2)))
    errors = [float(np.sqrt(np.mean(run.residual_N[rows] ** 2))) for rows in parts]
    middles = [float(np.mean(run.time_s[rows]) - run.time_s[0]) for rows in parts]
    # The columns that tell tests of one file apart, where there are any.
    file, _, own = run.segment.record.name.partition(" ")
    label = own or f"{file.rsplit('/', 1)[-1]}, {run.label}"
    return Course(shortened(label), np.array(middles), np.array(errors) / max(size, 1e-300))


def places_of(runs: Sequence[Run]) -> list[Place]:
    """By speed, by direction, by command; every test's squared error relative to its own force."""
    weights = [1.0 / max(float(np.sum(run.measured_N**2)), 1e-300) for run in runs]
    total = sum(w * float(np.sum(run.residual_N**2)) for w, run in zip(weights, runs, strict=True))
    count = sum(len(run.model_N) for run in runs)
    found: dict[str, list[float]] = {}
    for weight, run in zip(weights, runs, strict=True):
        for text, rows in masks_of(run):
            sums = found.setdefault(text, [0.0, 0.0])
            sums[0] += float(np.count_nonzero(rows))
            sums[1] += weight * float(np.sum(run.residual_N[rows] ** 2))
    return [
        Place(text, rows / count, error / max(total, 1e-300))
        for text, (rows, error) in found.items()
    ]


def masks_of(run: Run) -> list[tuple[str, np.ndarray]]:
    """Rows of a test by speed, by whether it speeds up or slows down, and by command."""
    record, rows = run.segment.record, run.segment.rows
    velocity, accel = record.velocity_m_s[rows], record.accel_m_s2[rows]
    part = np.abs(velocity) / max(float(np.abs(velocity).max()), 1e-300)
    speeds = [
        (f"at {100 * low:.0f} to {min(100.0, 100 * high):.0f} % of the largest speed",
         (part >= low) & (part < high))
        for low, high in _SPEEDS
    ]  # fmt: skip
    faster = velocity * accel > 0.0
    ways = [("while it speeds up", faster), ("while it slows down", ~faster)]
    return [*speeds, *ways, *((f"at {text}", mask) for text, mask in command_parts(run))]


def stretch_of(run: Run) -> str | None:
    """In words the shortest stretch with half of a test's squared error, where that is short."""
    squares = np.concatenate([[0.0], np.cumsum(run.residual_N**2)])
    count = len(run.model_N)
    ends = np.searchsorted(squares, squares[:-1] + _HALF * squares[-1])
    lengths = np.where(ends <= count, ends - np.arange(count), count + 1)
    first = int(np.argmin(lengths))
    cycle = cycles_of(run.segment.record.disp_m[run.segment.rows])
    has_few = cycle is not None and _LEAST_CYCLES * float(np.median(cycle)) > count
    if lengths[first] > _SHORT * count or has_few or squares[-1] <= 0.0:
        return None
    time_s = run.time_s
    last = min(first + int(lengths[first]), count - 1)
    return (
        f"half of the squared error of {shortened(run.segment.record.name)} is made from "
        f"{time_s[first]:.3g} to {time_s[last]:.3g} s, {100.0 * lengths[first] / count:.1f} % of "
        "its time: look at the recording there"
    )


def sentences(runs: Sequence[Run], most: int = 4) -> list[str]:
    """What is notable, the worst first; says so where nothing is."""
    found = [text for run in runs if (text := stretch_of(run)) is not None][:most]
    notable = [one for one in places_of(runs) if one.error >= max(_NOTABLE * one.rows, 0.1)]
    notable.sort(key=lambda one: one.error / max(one.rows, 1e-9), reverse=True)
    found += [
        f"{100.0 * one.error:.0f} % of the squared error is made {one.text}, in "
        f"{100.0 * one.rows:.0f} % of the rows"
        for one in notable[: max(0, most - len(found))]
    ]
    return found or ["the error is spread evenly over time, speeds and commands"]
