"""Delayed copies of the inputs at a model's own sample time, as the C++ library makes them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment, records_in
from quiesce.damper.learned.inputs import Box

# How far back the inputs go by default.
SPAN_S = 0.03


@dataclass(frozen=True)
class Series:
    """One segment at the sample time. Rows first .. count - 1 are to be learned."""

    inputs: np.ndarray  # scaled and delayed, [samples, lags * inputs]
    target: np.ndarray  # in parts of the largest, [samples]
    first: int

    def __len__(self) -> int:
        return len(self.target)


def sample_time_s(segments: Sequence[Segment]) -> float:
    """That of the slowest record."""
    return 1.0 / min(record.rate_Hz for record in records_in(segments))


def default_lags(time_s: float) -> tuple[int, ...]:
    """0, 1, 2, 4, ... samples, up to SPAN_S."""
    lags = [0, 1]
    while 2 * lags[-1] * time_s <= SPAN_S:
        lags.append(2 * lags[-1])
    return tuple(lags)


def sampled_rows(record: Record, time_s: float) -> np.ndarray:
    """The record's rows at multiples of the sample time."""
    count = int((len(record) - 1) / (record.rate_Hz * time_s) + 1e-6) + 1
    return np.round(np.arange(count) * time_s * record.rate_Hz).astype(int)


def delayed(picked: np.ndarray, box: Box, lags: Sequence[int]) -> np.ndarray:
    """Scaled copies of SI inputs [samples, inputs]; rest, that is 0, before the first."""
    padded = np.concatenate([np.zeros((max(lags), picked.shape[1])), picked])
    first = max(lags)
    return np.concatenate(
        [box.scaled(padded[first - lag : first - lag + len(picked)]) for lag in lags], axis=1
    )


def series_of(
    segments: Sequence[Segment],
    box: Box,
    lags: Sequence[int],
    time_s: float,
    target: Callable[[Record], np.ndarray],
) -> list[Series]:
    """target: [samples] of a record, in parts of the largest."""
    out = []
    for one in segments:
        rows = sampled_rows(one.record, time_s)
        rows = rows[rows < one.end]
        inputs = delayed(box.picked(one.record)[rows], box, lags)
        first = int(np.searchsorted(rows, one.first))
        out.append(Series(inputs, target(one.record)[rows], first))
    return out
