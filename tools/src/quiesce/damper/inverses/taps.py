"""What learned inverses see: wanted force, displacement and velocity, now and earlier, at a sample
time of their own; and their answer held in between.

Near v = 0 every current gives much the same force: rows there are left out of the training of
methods without memory, and their answer is held.
"""

from collections.abc import Sequence

import numpy as np

from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment
from quiesce.damper.inverses.demand import resists
from quiesce.damper.learned.sampled import Series, sampled_rows

INPUTS = ("force_N", "displacement_m", "velocity_m_s")
LEAST_SPEED = 0.1  # of the largest: slower than this the answer is held


def largest_speed_m_s(segments: Sequence[Segment]) -> float:
    return max(float(np.max(np.abs(one.record.velocity_m_s[one.rows]))) for one in segments)


def is_told(record: Record, rows: np.ndarray, least_m_s: float) -> np.ndarray:
    """Rows that tell the current: fast enough, and the force resists."""
    velocity = record.velocity_m_s[rows]
    return (np.abs(velocity) >= least_m_s) & resists(record.force_N[rows], velocity)


def taught_rows(
    segments: Sequence[Segment],
    series: Sequence[Series],
    time_s: float,
    least_m_s: float,
    most_rows: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Inputs [rows, inputs] and targets [rows] of the rows that tell the current, at most
    `most_rows`."""
    inputs, targets = [], []
    for one, taps in zip(segments, series, strict=True):
        rows = sampled_rows(one.record, time_s)[: len(taps)]
        kept = is_told(one.record, rows, least_m_s)
        kept[: taps.first] = False
        inputs.append(taps.inputs[kept])
        targets.append(taps.target[kept])
    u, y = np.concatenate(inputs), np.concatenate(targets)
    every = max(1, int(np.ceil(len(u) / most_rows)))
    return u[::every], y[::every]


def held(current_A: np.ndarray, velocity_m_s: np.ndarray, least_m_s: float) -> np.ndarray:
    """The current before, at first 0 A, where the motion is slower than this."""
    last = np.maximum.accumulate(
        np.where(np.abs(velocity_m_s) >= least_m_s, np.arange(len(current_A)), -1)
    )
    return np.where(last >= 0, current_A[last], 0.0)


def spread(at_rows: np.ndarray, rows: np.ndarray, count: int) -> np.ndarray:
    """Values at rising `rows` (the first 0), each held until the next, [count]."""
    return at_rows[np.searchsorted(rows, np.arange(count), side="right") - 1]
