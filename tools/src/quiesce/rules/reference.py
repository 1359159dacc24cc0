"""What a rule base answers, in float64: the yardstick of the firmware's integers.

Straight from the text of model.py and independent of how the firmware computes. The centroid is
exact: between the breakpoints of the output's sets all memberships are straight lines, so that
their clipped maximum is made of straight pieces, whose ends are where a line meets a line or a
strength. Each piece is integrated in closed form; nothing is sampled.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.rules.model import (
    AND,
    CENTROID,
    WEIGHTED_SUM,
    FuzzySet,
    Output,
    Rule,
    RuleBase,
    membership_of,
)

CHUNK_POINTS = 1 << 13  # evaluated at once; bounds the memory


@dataclass(frozen=True)
class Reference:
    """Arrays have the common shape of the inputs behind their first index."""

    outputs: np.ndarray  # [output, ...]; the default where is_default, NaN where there is none
    is_default: np.ndarray  # [output, ...], bool
    strengths: np.ndarray | None = None  # [rule, ...], on request


def evaluate(
    base: RuleBase, inputs: Sequence[np.ndarray], want_strengths: bool = False
) -> Reference:
    """Outputs at each point; inputs[i] holds input i in its unit.

    The inputs may have any shapes that numpy broadcasts together: a grid given as open axes, such
    as x[:, None] and y[None, :], costs one membership per axis value.
    """
    points = [np.atleast_1d(np.asarray(x, dtype=float)) for x in inputs]
    shape = np.broadcast_shapes(*(x.shape for x in points))
    memberships = []
    for variable, x in zip(base.inputs, points, strict=True):
        axes = x.reshape((1,) * (len(shape) - x.ndim) + x.shape)
        mu = input_memberships(variable.sets, np.clip(axes, variable.minimum, variable.maximum))
        memberships.append(np.broadcast_to(mu, (len(mu), *shape)))
    outputs = np.empty((len(base.outputs), *shape))
    is_default = np.empty(outputs.shape, dtype=bool)
    all_strengths = np.empty((len(base.rules), *shape)) if want_strengths else None
    rows = max(1, CHUNK_POINTS // max(1, int(np.prod(shape[1:]))))
    for first in range(0, shape[0], rows):
        part = slice(first, first + rows)
        strengths = rule_strengths(base, [mu[:, part] for mu in memberships])
        if all_strengths is not None:
            all_strengths[:, part] = strengths
        for number, output in enumerate(base.outputs):
            outputs[number, part], is_default[number, part] = infer(
                output, number, base.rules, strengths
            )
    return Reference(outputs, is_default, all_strengths)


def input_memberships(sets: Sequence[FuzzySet], x: np.ndarray) -> np.ndarray:
    """[set, ...] at x, which is not clamped here."""
    return np.stack([membership(one, x) for one in sets]) if sets else np.empty((0, *x.shape))


def membership(fuzzy_set: FuzzySet, x: np.ndarray) -> np.ndarray:
    """FuzzySet.membership at every element of x."""
    return membership_of(fuzzy_set.points, x)


def rule_strengths(base: RuleBase, memberships: Sequence[np.ndarray]) -> np.ndarray:
    """[rule, ...] from the memberships [set, ...] of every input."""
    shape = memberships[0].shape[1:]
    strengths = np.empty((len(base.rules), *shape))
    for number, rule in enumerate(base.rules):
        join = np.minimum if rule.connective == AND else np.maximum
        strength: np.ndarray | None = None
        for condition in rule.conditions:
            mu = memberships[condition.input][condition.set]
            mu = 1.0 - mu if condition.negated else mu
            strength = mu if strength is None else join(strength, mu)
        strengths[number] = rule.weight * strength
    return strengths


def infer(
    output: Output, number: int, rules: Sequence[Rule], strengths: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Value and whether it is the default, from strengths [rule, ...]."""
    concluding = [i for i, rule in enumerate(rules) if rule.conclusions[number] is not None]
    terms = [rules[i].conclusions[number] for i in concluding]
    if output.method == WEIGHTED_SUM:
        weights = strengths[concluding]
    else:
        weights = term_strengths(strengths[concluding], terms, len(output.terms))
        terms = list(range(len(output.terms)))
    if output.method == CENTROID:
        value, total = centroid(output, weights)
    else:
        singletons = np.array([output.terms[term].value for term in terms])
        value, total = weighted_average(weights, singletons)
    default = np.nan if output.default is None else output.default
    return np.where(total > 0, value, default), ~(total > 0)


def term_strengths(strengths: np.ndarray, terms: Sequence[int | None], count: int) -> np.ndarray:
    """[term, ...]: the greatest strength of each term's rules."""
    greatest = np.zeros((count, *strengths.shape[1:]))
    for strength, term in zip(strengths, terms, strict=True):
        np.maximum(greatest[term], strength, out=greatest[term])
    return greatest


def weighted_average(weights: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Average, and the sum of the weights; the same bits whatever the shape of the points."""
    total, moment = np.zeros(weights.shape[1:]), np.zeros(weights.shape[1:])
    for weight, value in zip(weights, values, strict=True):
        total += weight
        moment += weight * value
    with np.errstate(divide="ignore", invalid="ignore"):
        return moment / total, total


# Centroid


@dataclass(frozen=True)
class Stretch:
    """A part of the output's universe in which every membership is a straight line."""

    start: float
    end: float
    terms: tuple[int, ...]  # those that are not 0 all over it
    ends: np.ndarray  # [term of terms, 2]: memberships at start and end, limits from within


def centroid(output: Output, strengths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of the aggregated set, and its area; strengths [term, ...]. An area of 0 has no centroid."""
    shape = strengths.shape[1:]
    flat = strengths.reshape(len(strengths), -1)
    fires = flat.max(axis=1, initial=0.0) > 0
    area, moment = np.zeros(flat.shape[1]), np.zeros(flat.shape[1])
    for stretch in stretches(output):
        chosen = [i for i, term in enumerate(stretch.terms) if fires[term]]
        if not chosen:
            continue
        levels = flat[[stretch.terms[i] for i in chosen]]
        one_area, one_moment = integrate(stretch.ends[chosen], levels)
        width = stretch.end - stretch.start
        area += width * one_area
        # About the universe's lower end: no term is negative, so that nothing cancels.
        moment += width * ((stretch.start - output.minimum) * one_area + width * one_moment)
    with np.errstate(divide="ignore", invalid="ignore"):
        return (output.minimum + moment / area).reshape(shape), area.reshape(shape)


def stretches(output: Output) -> list[Stretch]:
    places = {output.minimum, output.maximum}
    places |= {x for term in output.terms for x, _ in term.points}
    inside = sorted(x for x in places if output.minimum <= x <= output.maximum)
    found = []
    for start, end in zip(inside, inside[1:], strict=False):
        ends = np.array([limits(term, start, end) for term in output.terms])
        terms = np.flatnonzero(ends.max(axis=1) > 0)
        found.append(Stretch(start, end, tuple(int(term) for term in terms), ends[terms]))
    return found


def limits(fuzzy_set: FuzzySet, start: float, end: float) -> tuple[float, float]:
    """Membership at both ends of an interval without a breakpoint inside, seen from within."""
    points = fuzzy_set.points
    after = next((i for i, (x, _) in enumerate(points) if x > start), len(points))
    if after == 0:
        return points[0][1], points[0][1]
    if after == len(points):
        return points[-1][1], points[-1][1]
    (x0, mu0), (x1, mu1) = points[after - 1], points[after]
    slope = (mu1 - mu0) / (x1 - x0)
    at_start = mu0 if start == x0 else mu0 + slope * (start - x0)
    return at_start, mu1 if end == x1 else mu0 + slope * (end - x0)


def integrate(ends: np.ndarray, levels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Integrals of g(u) and u g(u) over 0 <= u <= 1, where g = max over terms of min(level, line).

    ends [term, 2]: the lines at u = 0 and 1; levels [term, point]. A piece between neighbouring
    cuts is straight: its value in the middle and its slope say all, without any cancellation.
    """
    cuts = np.sort(cut_places(ends, levels), axis=0)
    width, middle = np.diff(cuts, axis=0), (cuts[1:] + cuts[:-1]) / 2
    value, slope = np.zeros_like(middle), np.zeros_like(middle)
    for (start, end), level in zip(ends, levels, strict=True):
        line = middle * (end - start)
        line += start
        own_slope = np.where(line < level, end - start, 0.0) if start != end else 0.0
        np.minimum(line, level, out=line)
        is_greatest = line > value
        np.copyto(slope, own_slope, where=is_greatest)
        np.copyto(value, line, where=is_greatest)
    area = width * value
    return area.sum(axis=0), (area * middle + slope * width**3 / 12).sum(axis=0)


def cut_places(ends: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """[cut, point], not sorted: 0, 1, and where a line meets another or the top of a term."""
    places = [np.zeros_like(levels[0]), np.ones_like(levels[0])]
    tops = [np.minimum(level, max(pair)) for pair, level in zip(ends, levels, strict=True)]
    for number, (start, end) in enumerate(ends):
        if start != end:
            places += [np.clip((top - start) / (end - start), 0.0, 1.0) for top in tops]
        for other_start, other_end in ends[:number]:
            difference = (end - start) - (other_end - other_start)
            if difference != 0:
                meet = np.clip((other_start - start) / difference, 0.0, 1.0)
                places.append(np.full_like(levels[0], meet))
    return np.stack(places)
