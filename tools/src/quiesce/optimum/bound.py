"""The best that any periodic current can do: optimal control over half a period.

The current is free in each of n intervals. What is found is a best value, not a proof: several
starts guard against poor local minima.
"""

from collections.abc import Iterator

import numpy as np

from quiesce.optimum.descent import Optimum, improve
from quiesce.optimum.goal import Goal, reference
from quiesce.optimum.periodic import Drive, Floats

INTERVALS = 60
STARTS = 4


class FreeCurrent:
    """Any current that is constant in each of n intervals: the parameters are its values."""

    def __init__(self, count: int) -> None:
        self.low = np.zeros(count)
        self.high = np.ones(count)

    def command(self, parameters: Floats) -> Floats:
        return parameters

    def slopes(self, parameters: Floats) -> Floats:
        return np.eye(len(parameters))


def bound(
    drive: Drive, goal: Goal, *, intervals: int = INTERVALS, starts: int = STARTS, seed: int = 1
) -> Optimum:
    """The best current for the goal over all starts."""
    ref = reference(drive)
    shape = FreeCurrent(intervals)
    guesses = first_guesses(intervals, starts, seed)
    return min((improve(ref, goal, shape, guess) for guess in guesses), key=lambda o: o.cost)


def first_guesses(count: int, starts: int, seed: int) -> Iterator[Floats]:
    """Parts of full current: constants, pulses of a quarter period, then random levels."""
    pulse = np.repeat([1.0, 0.0], [count // 2, count - count // 2])
    fixed = [np.full(count, part) for part in (1.0, 0.5, 0.0)]
    fixed += [np.roll(pulse, quarter * count // 4) for quarter in range(4)]
    yield from fixed[:starts]
    rng = np.random.default_rng(seed)
    for _ in range(starts - len(fixed)):
        yield np.repeat(rng.uniform(0.0, 1.0, 6), -(-count // 6))[:count]
