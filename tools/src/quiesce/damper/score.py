"""Errors of a model's force against a measured one."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment

Simulate = Callable[[Record], np.ndarray]  # force in N at the samples, before any average


@dataclass(frozen=True)
class SegmentScore:
    name: str
    level: float | None  # the command where it is constant
    samples: int
    squared_error_N2: float
    squared_force_N2: float
    largest_N: float  # error

    @property
    def error(self) -> float:
        """||F - F_model|| / ||F||."""
        return float(np.sqrt(self.squared_error_N2 / max(self.squared_force_N2, 1e-300)))


@dataclass(frozen=True)
class Score:
    """Of all segments. A model that diverges has an infinite error."""

    segments: tuple[SegmentScore, ...]

    @property
    def error(self) -> float:
        """||F - F_model|| / ||F|| over all samples."""
        return float(
            np.sqrt(self.squared_error_N2 / sum(s.squared_force_N2 for s in self.segments))
        )

    @property
    def mean_error(self) -> float:
        """Mean over the segments of their own errors."""
        return float(np.mean([one.error for one in self.segments]))

    @property
    def squared_error_N2(self) -> float:
        return sum(one.squared_error_N2 for one in self.segments)


def score(simulate: Simulate, segments: Sequence[Segment]) -> Score:
    """The model runs from the first row of every record, free; scored rows are the segment's."""
    forces: dict[int, np.ndarray] = {}
    for segment in segments:
        record = segment.record
        if id(record) not in forces:
            forces[id(record)] = record.averaged(simulate(record))
    return Score(tuple(score_segment(forces[id(one.record)], one) for one in segments))


def score_segment(force_N: np.ndarray, segment: Segment) -> SegmentScore:
    measured = segment.record.force_N[segment.rows]
    with np.errstate(all="ignore"):
        error = force_N[segment.rows] - measured
        squared = float(np.sum(error**2))
    finite = bool(np.isfinite(squared))
    return SegmentScore(
        segment.record.name,
        segment.record.level,
        len(segment),
        squared if finite else float("inf"),
        float(np.sum(measured**2)),
        float(np.max(np.abs(error))) if finite else float("inf"),
    )
