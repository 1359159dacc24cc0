"""What a rule base means, whatever file it came from.

A membership function is piecewise linear: points (x, membership) in ascending x. Left of the first
point it holds that point's value, right of the last one the last one's. Two points with equal x
are a vertical edge, at which the greater value holds. Inputs clamp to their universe first.

A rule's strength is its weight times the minimum ("and") or the maximum ("or") of its conditions'
memberships; a negated condition counts 1 - membership. A rule fires where its strength is above 0.
Of every output:

weighted average, "sum"   sum over rules of strength * singleton / sum over rules of strength
                          (MATLAB's Sugeno, fuzzylite 6)
weighted average, "max"   the same over the output's terms, each with the greatest strength of its
                          rules (fuzzylite 7 with aggregation Maximum, HC12 MEM/REV/WAV)
centroid                  of max over terms of min(greatest strength of its rules, membership),
                          over the output's universe (Mamdani, min implication, max aggregation)

and its default where none of its rules fires.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

MAX_INPUTS = 4
MAX_OUTPUTS = 4
MAX_SETS = 7  # of an input, and of an output with sets
MAX_SINGLETONS = 64  # of an output with singletons
MAX_RULES = 1024
MAX_CONDITIONS = 8  # of a rule

AND = "and"
OR = "or"

WEIGHTED_SUM = "weighted average, sum"
WEIGHTED_MAX = "weighted average, max"
CENTROID = "centroid"
METHODS = (WEIGHTED_SUM, WEIGHTED_MAX, CENTROID)

Point = tuple[float, float]  # x in the variable's unit, membership 0..1


@dataclass(frozen=True)
class FuzzySet:
    """A named membership function."""

    name: str
    points: tuple[Point, ...]  # at least one; x never falls

    def membership(self, x: float) -> float:
        """At x, after the rules of the module's text; x is not clamped to any universe."""
        return float(membership_of(self.points, np.asarray(x, dtype=float)))


def membership_of(points: Sequence[Point], x: np.ndarray) -> np.ndarray:
    """At every element of x."""
    at, mu = np.array(points, dtype=float).T
    greatest = np.array([mu[at == place].max() for place in at])
    with np.errstate(divide="ignore", invalid="ignore"):
        # Not finite at a vertical edge, which is never the segment that is looked up.
        slope = np.append(np.diff(mu) / np.diff(at), 0.0)
    found = np.searchsorted(at, x, side="right") - 1  # the last point at or left of x
    index = np.maximum(found, 0)
    value = mu[index] + np.where(x > at[index], slope[index] * (x - at[index]), 0.0)
    value = np.where(x == at[index], greatest[index], value)
    return np.where(found < 0, mu[0], value)


@dataclass(frozen=True)
class Singleton:
    """A named constant of an output; of first order, where that was asked for, a straight line:
    value + sum of slopes x inputs."""

    name: str
    value: float
    slopes: tuple[float, ...] = ()  # one an input; (): all are 0


@dataclass(frozen=True)
class Input:
    name: str
    minimum: float  # of the universe; minimum < maximum
    maximum: float
    sets: tuple[FuzzySet, ...]


@dataclass(frozen=True)
class Output:
    """terms: all singletons (weighted average) or all sets (centroid)."""

    name: str
    minimum: float
    maximum: float
    terms: tuple[FuzzySet, ...] | tuple[Singleton, ...]
    method: str  # of METHODS
    default: float | None = None  # None: the file does not say


@dataclass(frozen=True)
class Condition:
    """`input IS [NOT] set`, by index."""

    input: int
    set: int
    negated: bool = False


@dataclass(frozen=True)
class Rule:
    """Conditions joined by one connective; an input that is not named does not matter."""

    conditions: tuple[Condition, ...]  # at least one
    conclusions: tuple[int | None, ...]  # index of the term of each output; None: says nothing
    connective: str = AND
    weight: float = 1.0  # 0..1


@dataclass(frozen=True)
class RuleBase:
    name: str
    inputs: tuple[Input, ...]
    outputs: tuple[Output, ...]
    rules: tuple[Rule, ...]
    # What a reader approximated or took for granted; each one line for the user.
    notes: tuple[str, ...] = field(default=(), compare=False)

    def rule_text(
        self,
        rule: Rule,
        word: Callable[[str], str] = str,
        joint: str = ", ",
        number: Callable[[float], str] = "{:g}".format,
    ) -> str:
        """`f IS S AND a IS NOT M THEN I IS Z`, as FCL has it behind IF.

        word: of a keyword, such as str.lower; joint: between conclusions; number: of the weight.
        """
        conditions = word(f" {rule.connective.upper()} ").join(
            f"{self.inputs[c.input].name} {word('IS NOT' if c.negated else 'IS')} "
            f"{self.inputs[c.input].sets[c.set].name}"
            for c in rule.conditions
        )
        conclusions = joint.join(
            f"{output.name} {word('IS')} {output.terms[term].name}"
            for output, term in zip(self.outputs, rule.conclusions, strict=True)
            if term is not None
        )
        weight = "" if rule.weight == 1 else f" {word('WITH')} {number(rule.weight)}"
        return f"{conditions} {word('THEN')} {conclusions}{weight}"


def triangle(name: str, left: float, top: float, right: float) -> FuzzySet:
    return trapezoid(name, left, top, top, right)


def trapezoid(name: str, a: float, b: float, c: float, d: float) -> FuzzySet:
    """0 up to a, 1 from b to c, 0 from d on; equal neighbours are vertical edges.

    An edge at minus or plus infinity makes a shoulder.
    """
    points: list[Point] = []
    if a != float("-inf") and b != float("-inf"):
        points += [(a, 0.0), (b, 1.0)]
    if c != float("inf") and d != float("inf"):
        points += [(c, 1.0), (d, 0.0)] if not points or c != b else [(d, 0.0)]
    if not points:
        points = [(0.0, 1.0)]
    return FuzzySet(name, tuple(points))


def ramp(name: str, zero: float, one: float) -> FuzzySet:
    """0 up to (or from) `zero`, 1 from (or up to) `one`."""
    ends = ((zero, 0.0), (one, 1.0))
    return FuzzySet(name, tuple(sorted(ends)))
