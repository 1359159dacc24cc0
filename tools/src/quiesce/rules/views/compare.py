"""Where the outputs of two rule bases differ, over all of their inputs."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.rules.model import Input, RuleBase
from quiesce.rules.reference import evaluate

POINTS = {1: 4001, 2: 401, 3: 33, 4: 9}  # along an axis, by the number of inputs
REFINEMENTS, REFINED_POINTS = 6, 9
SAME = 1e-9  # of the output's range: smaller differences are rounding


# Matching by name


def matched(one: RuleBase, other: RuleBase) -> RuleBase:
    """`other` with its inputs and outputs in the order of `one`'s. UsageError where they differ."""
    inputs = order_of("inputs", one, other, one.inputs, other.inputs)
    outputs = order_of("outputs", one, other, one.outputs, other.outputs)
    place = {index: i for i, index in enumerate(inputs)}
    rules = tuple(
        replace(
            rule,
            conditions=tuple(replace(c, input=place[c.input]) for c in rule.conditions),
            conclusions=tuple(rule.conclusions[i] for i in outputs),
        )
        for rule in other.rules
    )
    return replace(
        other,
        inputs=tuple(other.inputs[i] for i in inputs),
        outputs=tuple(other.outputs[i] for i in outputs),
        rules=rules,
    )


def order_of(
    kind: str, one: RuleBase, other: RuleBase, wanted: Sequence[Any], there: Sequence[Any]
) -> list[int]:
    """Index in `there` of each of `wanted`, by name."""
    names, other_names = [v.name for v in wanted], [v.name for v in there]
    if sorted(names) != sorted(other_names):
        raise UsageError(
            f"{one.name} and {other.name} cannot be compared: {kind} {', '.join(names)} "
            f"against {', '.join(other_names)}; they are matched by name"
        )
    return [other_names.index(name) for name in names]


# What comes out


@dataclass(frozen=True)
class OutputDifference:
    """Of one output; over all inputs inside the universes of both."""

    name: str
    range: float  # of the output: the wider universe
    largest: float  # |B - A|; infinite where only one of them has a value
    at: tuple[float, ...]  # inputs there
    values: tuple[float, float]  # A and B there
    threshold: float  # in the output's unit
    share_beyond: float  # of the volume of the inputs where |B - A| > threshold
    share_default: float  # of the volume where only one of them is at its default

    @property
    def is_same(self) -> bool:
        return self.largest <= SAME * self.range


@dataclass(frozen=True)
class Grid:
    axes: tuple[np.ndarray, ...]

    @property
    def weights(self) -> np.ndarray:
        """Share of the volume that each point stands for."""
        weights = np.ones(())
        for axis in self.axes:
            widths = np.zeros(len(axis))
            widths[:-1] += np.diff(axis) / 2
            widths[1:] += np.diff(axis) / 2
            weights = weights[..., None] * (widths / widths.sum())
        return weights

    @property
    def points(self) -> int:
        return int(np.prod([len(axis) for axis in self.axes]))


def make_grid(one: RuleBase, other: RuleBase) -> Grid:
    """Even steps over both universes, every breakpoint of both, and the middles between these."""
    count = POINTS[len(one.inputs)]
    return Grid(
        tuple(
            common_axis(a, b, count, len(one.inputs) < 3)
            for a, b in zip(one.inputs, other.inputs, strict=True)
        )
    )


def common_axis(a: Input, b: Input, count: int, with_middles: bool) -> np.ndarray:
    low, high = min(a.minimum, b.minimum), max(a.maximum, b.maximum)
    edges = [x for one in (*a.sets, *b.sets) for x, _ in one.points]
    edges += [a.minimum, a.maximum, b.minimum, b.maximum]
    inside = np.unique([x for x in edges if low <= x <= high])
    middles = (inside[1:] + inside[:-1]) / 2 if with_middles else []
    return np.unique(np.concatenate([np.linspace(low, high, count), inside, middles]))


def differences(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """|b - a|; 0 where neither has a value, infinite where one has none."""
    return np.where(
        np.isnan(a) & np.isnan(b), 0.0, np.where(np.isnan(a) | np.isnan(b), np.inf, np.abs(b - a))
    )


def compare_outputs(
    one: RuleBase, other: RuleBase, grid: Grid, threshold: float | None
) -> list[OutputDifference]:
    """threshold in the outputs' unit; None: a thousandth of each output's range."""
    here, there = (evaluate(base, np.ix_(*grid.axes)) for base in (one, other))
    weights = grid.weights
    found = []
    for index, (a, b) in enumerate(zip(one.outputs, other.outputs, strict=True)):
        span = max(a.maximum, b.maximum) - min(a.minimum, b.minimum)
        limit = 1e-3 * span if threshold is None else threshold
        error = differences(here.outputs[index], there.outputs[index])
        worst = np.unravel_index(int(np.argmax(error)), error.shape)
        at = refined(one, other, index, grid, worst)
        largest, values = at_point(one, other, index, at)
        is_one_default = here.is_default[index] != there.is_default[index]
        found.append(
            OutputDifference(
                a.name, span, largest, at, values, limit,
                float(weights[error > limit].sum()), float(weights[is_one_default].sum()),
            )
        )  # fmt: skip
    return found


def at_point(
    one: RuleBase, other: RuleBase, index: int, at: Sequence[float]
) -> tuple[float, tuple[float, float]]:
    a, b = (
        float(evaluate(base, [np.array([x]) for x in at]).outputs[index, 0])
        for base in (one, other)
    )
    return float(differences(np.array(a), np.array(b))), (a, b)


def refined(
    one: RuleBase, other: RuleBase, index: int, grid: Grid, worst: Sequence[Any]
) -> tuple[float, ...]:
    """A place near the worst point of the grid where the difference is greatest."""
    best = tuple(float(axis[i]) for axis, i in zip(grid.axes, worst, strict=True))
    steps = [float(np.diff(axis).max()) for axis in grid.axes]
    bounds = [(float(axis[0]), float(axis[-1])) for axis in grid.axes]
    height = at_point(one, other, index, best)[0]
    for _ in range(REFINEMENTS if np.isfinite(height) else 0):
        axes = [
            np.unique(np.clip([*np.linspace(x - step, x + step, REFINED_POINTS), x], *bound))
            for x, step, bound in zip(best, steps, bounds, strict=True)
        ]
        outputs = [evaluate(base, np.ix_(*axes)).outputs[index] for base in (one, other)]
        error = differences(*outputs)
        place = np.unravel_index(int(np.argmax(error)), error.shape)
        if error[place] > height:
            height = float(error[place])
            best = tuple(float(axis[i]) for axis, i in zip(axes, place, strict=True))
        steps = [step / 3 for step in steps]
    return best
