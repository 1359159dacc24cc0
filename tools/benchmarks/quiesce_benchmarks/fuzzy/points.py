"""Where a rule base is compared: points that reach every cell, every edge and beyond the ends."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.model import Input, RuleBase
from quiesce.rules.reference import evaluate

from quiesce_benchmarks.fuzzy.sets import breakpoints

INT32_MIN, INT32_MAX = -(2**31), 2**31 - 1
# Counts of an input beside each breakpoint that are tried.
NEAR = (-3.0, -1.5, -1.0, -0.5, -0.25, 0.0, 0.25, 0.5, 1.0, 1.5, 3.0)
# A rounding box is looked at on so many lines of each input, and at the breakpoints inside.
BOX_LINES = 5
FINE_BOX_LINES = 41
BOX_BREAKS = 2
CHUNK_POINTS = 2000


def random_points(
    base: RuleBase, lsb: Sequence[float], rng: np.random.Generator, count: int
) -> np.ndarray:
    """[point, input]: uniform; every input near breakpoints; at the universe's ends; beyond."""
    columns = [one_input(v, step, rng, count) for v, step in zip(base.inputs, lsb, strict=True)]
    return np.stack(columns, axis=1)


def one_input(variable: Input, lsb: float, rng: np.random.Generator, count: int) -> np.ndarray:
    low, high = variable.minimum, variable.maximum
    places = [x for x in breakpoints(variable.sets) if low <= x <= high] or [low]
    span = high - low
    near = rng.choice(places, count) + rng.choice(NEAR, count) * lsb
    ends = np.array([low, high])[rng.integers(0, 2, count)]
    beyond = rng.choice([low - 0.1 * span, high + 0.1 * span, low - 3 * span, high + lsb], count)
    kind = rng.choice(4, count, p=[0.55, 0.35, 0.06, 0.04])
    return np.choose(kind, [rng.uniform(low, high, count), near, ends, beyond])


def integers_of(compiled: CompiledBase, points: np.ndarray) -> list[np.ndarray]:
    """Nearest int32 of each input [point]; not clamped to the universe: the engines do that."""
    out = []
    for axis, x in zip(compiled.axes, points.T, strict=True):
        counts = np.floor((x - float(axis.origin)) / float(axis.lsb) + 0.5)
        out.append(np.clip(counts, INT32_MIN, INT32_MAX).astype(np.int32))
    return out


@dataclass(frozen=True)
class Range:
    """Of the reference over a rounding box; arrays [output, point]."""

    low: np.ndarray
    high: np.ndarray
    has_default: np.ndarray  # the default stands somewhere in the box
    has_value: np.ndarray  # some rule fires somewhere in the box


def rounding_range(
    base: RuleBase, points: np.ndarray, lsb: Sequence[float], lines: int = BOX_LINES
) -> Range:
    """Over x +- half a count in every input. With more lines it can only be wider, and slower."""
    parts = [
        box_range(base, points[i : i + CHUNK_POINTS], lsb, lines)
        for i in range(0, len(points), CHUNK_POINTS)
    ]
    names = ("low", "high", "has_default", "has_value")
    return Range(*(np.concatenate([getattr(one, n) for one in parts], axis=1) for n in names))


def box_range(base: RuleBase, points: np.ndarray, lsb: Sequence[float], lines: int) -> Range:
    axes = [
        box_lines(variable, x, step, lines)
        for variable, x, step in zip(base.inputs, points.T, lsb, strict=True)
    ]
    grids = [
        lines.reshape(len(points), *(-1 if i == k else 1 for k in range(len(axes))))
        for i, lines in enumerate(axes)
    ]
    reference = evaluate(base, grids)
    shape = (len(base.outputs), len(points), -1)
    outputs = reference.outputs.reshape(shape)
    is_default = reference.is_default.reshape(shape)
    return Range(
        np.where(is_default, np.inf, outputs).min(axis=2),
        np.where(is_default, -np.inf, outputs).max(axis=2),
        is_default.any(axis=2),
        ~is_default.all(axis=2),
    )


def box_lines(variable: Input, x: np.ndarray, lsb: float, lines: int) -> np.ndarray:
    """[point, line]: even lines over the box, and both sides of the breakpoints inside it."""
    even = x[:, None] + lsb * np.linspace(-0.5, 0.5, lines)
    places = np.array(breakpoints(variable.sets))
    distance = np.abs(places[None, :] - x[:, None])
    nearest = np.argsort(distance, axis=1)[:, :BOX_BREAKS]
    is_inside = np.take_along_axis(distance, nearest, axis=1) <= 0.5000001 * lsb
    inside = np.where(is_inside, places[nearest], x[:, None])
    beside = [np.nextafter(inside, -np.inf), inside, np.nextafter(inside, np.inf)]
    sides = [np.where(is_inside, one, x[:, None]) for one in beside]
    return np.concatenate([even, *sides], axis=1)
