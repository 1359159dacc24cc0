"""The best waveform of a plant's currents for one base motion, by descent along the slopes of its
adjoint. What is found is a best value, not a proof: several starts guard against poor local minima.

The currents are free in each of n intervals, from none to the ceiling. Peaks in what is minimised
are smoothed, and sharpened from stage to stage; what counts in the end is the true value.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from quiesce.base.errors import UsageError
from quiesce.plant.open_loop import Motion, OpenLoop

Floats = NDArray[np.float64]
CORRECTIONS = 20  # that the descent remembers
FAILED = 1e3  # cost of a motion that cannot be: a damper at its end


class Judge(Protocol):
    def value(self, motion: Motion, command_A: Floats) -> float:
        """What is to be least."""
        ...

    def smooth(self, motion: Motion, sharpness: float) -> tuple[float, Motion]:
        """The same, smoothed, and its slopes."""
        ...


@dataclass(frozen=True)
class Effort:
    """hold_ticks: of an interval. tried: starts that are descended from, first_runs runs each; then
    the best goes on, for each sharpness so many runs."""

    hold_ticks: int = 4
    tried: int = 2
    first_runs: int = 10
    stages: tuple[tuple[float, int], ...] = ((32.0, 50), (128.0, 60))

    @property
    def runs(self) -> int:
        return self.tried * self.first_runs + sum(runs for _, runs in self.stages)


@dataclass(frozen=True)
class Waveform:
    """command_A [ticks dampers], and what it is worth."""

    command_A: Floats
    value: float


def best_waveform(
    loop: OpenLoop,
    judge: Judge,
    ceiling_A: float,
    starts: Sequence[Floats],
    effort: Effort,
    on_run: Callable[[float], None] = lambda value: None,
) -> Waveform:
    """starts: commands [ticks dampers] in A, of which the best ones are descended from. on_run is
    told the best value so far after every run. UsageError where no start can be simulated."""
    search = _Search(loop, judge, ceiling_A, effort.hold_ticks, on_run)
    parts = sorted((search.parts(start) for start in starts), key=search.true_value)
    if not np.isfinite(search.best):
        raise UsageError("no current that was tried keeps the dampers within their strokes")
    sharpness = effort.stages[0][0]
    found = [search.descend(start, sharpness, effort.first_runs) for start in parts[: effort.tried]]
    now = min(found, key=search.true_value)
    for sharpness, runs in effort.stages:
        search.descend(now, sharpness, runs)
        now = search.best_parts
    return Waveform(search.command_A(now), search.best)


class _Search:
    """best_parts [intervals dampers]: of the ceiling, the best that any run has shown."""

    def __init__(
        self, loop: OpenLoop, judge: Judge, ceiling_A: float, hold: int,
        on_run: Callable[[float], None],
    ) -> None:  # fmt: skip
        self._loop = loop
        self._judge = judge
        self._ceiling_A = min(ceiling_A, loop.max_current_A)
        self._hold = hold
        self._on_run = on_run
        self._first = np.arange(0, loop.ticks, hold)
        self.best = np.inf
        self.best_parts = np.zeros((len(self._first), len(loop.dampers)))

    def parts(self, command_A: Floats) -> Floats:
        """Means over the intervals."""
        sums = np.add.reduceat(command_A, self._first, axis=0)
        lengths = np.diff(self._first, append=self._loop.ticks)[:, None]
        return np.clip(sums / lengths / self._ceiling_A, 0.0, 1.0)

    def command_A(self, parts: Floats) -> Floats:
        return self._ceiling_A * np.repeat(parts, self._hold, axis=0)[: self._loop.ticks]

    def true_value(self, parts: Floats) -> float:
        try:
            self._run(parts)
        except UsageError:
            return np.inf
        return self._value

    def _run(self, parts: Floats) -> Motion:
        command_A = self.command_A(parts)
        motion = self._loop.run(command_A)
        self._value = self._judge.value(motion, command_A)
        if self._value < self.best:
            self.best, self.best_parts = self._value, parts.copy()
        return motion

    def descend(self, start: Floats, sharpness: float, runs: int) -> Floats:
        """The end of so many runs, which need not be the best."""

        def cost(flat: Floats) -> tuple[float, Floats]:
            try:
                motion = self._run(flat.reshape(start.shape))
            except UsageError:
                return FAILED, np.zeros_like(flat)
            value, slopes = self._judge.smooth(motion, sharpness)
            by_command = self._loop.pull(slopes)
            by_part = self._ceiling_A * np.add.reduceat(by_command, self._first, axis=0)
            self._on_run(self.best)
            return value, by_part.ravel()

        options = {"maxfun": runs, "maxiter": runs, "maxcor": CORRECTIONS, "ftol": 1e-9}
        found = minimize(
            cost, start.ravel(), jac=True, method="L-BFGS-B",
            bounds=[(0.0, 1.0)] * start.size, options=options,
        )  # fmt: skip
        return found.x.reshape(start.shape)
