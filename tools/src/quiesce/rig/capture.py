"""What a capture is: which samples, from when."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from quiesce.base.errors import UsageError

Value = int | float | str


@dataclass(frozen=True)
class Trigger:
    """Holds from a sample that satisfies all that are given, after one that does not: an edge."""

    path: str
    above: float | None = None
    below: float | None = None
    equal: Value | None = None

    def __post_init__(self) -> None:
        if (self.above, self.below, self.equal) == (None, None, None):
            raise UsageError(f"a trigger on {self.path} needs above, below or equal")

    def is_met(self, value: Value) -> bool:
        if self.equal is not None and value != self.equal:
            return False
        if self.above is None and self.below is None:
            return True
        if isinstance(value, str):
            raise UsageError(f"{self.path} is {value!r}, no number: its trigger is equal=...")
        is_above = self.above is None or value > self.above
        return is_above and (self.below is None or value < self.below)


@dataclass(frozen=True)
class Series:
    """Samples of a variable. times_s: from the trigger on; before it they are below 0."""

    times_s: np.ndarray
    values: np.ndarray


@dataclass
class Capture:
    """Samples under way: all of them come in the order of their times. earliest_s: of a trigger;
    what was before it has to be there."""

    paths: Sequence[str]
    trigger: Trigger | None
    earliest_s: float
    samples: dict[str, list[tuple[float, Value]]] = field(init=False)
    start_s: float | None = None  # of the trigger
    _was_met: bool | None = None

    def __post_init__(self) -> None:
        self.samples = {path: [] for path in self.paths}

    def take(self, path: str, time_s: float, value: Value) -> None:
        if path in self.samples:
            self.samples[path].append((time_s, value))
        if self.trigger is not None and path == self.trigger.path and self.start_s is None:
            is_met = self.trigger.is_met(value)
            if is_met and self._was_met is False and time_s >= self.earliest_s:
                self.start_s = time_s
            self._was_met = is_met

    def forget(self, before_s: float) -> None:
        """While it waits: what is older is not wanted."""
        for path, samples in self.samples.items():
            if samples and samples[0][0] < before_s:
                self.samples[path] = [one for one in samples if one[0] >= before_s]

    def series(self, pre_s: float, length_s: float) -> dict[str, Series]:
        """From pre_s before the trigger until length_s after it."""
        assert self.start_s is not None
        out = {}
        for path, samples in self.samples.items():
            inside = [
                (time_s - self.start_s, value)
                for time_s, value in samples
                if -pre_s <= time_s - self.start_s <= length_s
            ]
            times_s = np.array([one[0] for one in inside])
            out[path] = Series(times_s, np.array([one[1] for one in inside]))
        return out
