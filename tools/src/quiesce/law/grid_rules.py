"""Rule bases over two signals, made of numbers: a rule for each pair of sets."""

from collections.abc import Callable, Sequence
from itertools import product

from quiesce.rules.model import (
    WEIGHTED_SUM,
    Condition,
    FuzzySet,
    Input,
    Output,
    Rule,
    RuleBase,
    Singleton,
)


def variable(name: str, reach: float, middles: Sequence[float]) -> Input:
    """Over -reach .. reach: triangles that add up to 1, the outer ones 1 to the ends."""
    sets = tuple(FuzzySet(f"{at:g}", _triangle(middles, i)) for i, at in enumerate(middles))
    return Input(name, -reach, reach, sets)


def _triangle(middles: Sequence[float], number: int) -> tuple[tuple[float, float], ...]:
    near = range(max(0, number - 1), min(len(middles), number + 2))
    return tuple((middles[i], float(i == number)) for i in near)


def evenly(reach: float, steps: int) -> list[float]:
    """Places from -reach to reach, 0 in the middle."""
    return [reach * k / steps for k in range(-steps, steps + 1)]


def grid(
    name: str, inputs: tuple[Input, Input], conclusion: Callable[[int, int], Singleton]
) -> RuleBase:
    """conclusion: of a pair of sets by number; equal ones are one term. Currents in A."""
    pairs = list(product(*(range(len(one.sets)) for one in inputs)))
    of_pair = [conclusion(*pair) for pair in pairs]
    terms = tuple(dict.fromkeys(of_pair))
    values = [one.value for one in terms]
    output = Output("current", min(values), max(values), terms, WEIGHTED_SUM, 0.0)
    rules = tuple(
        Rule((Condition(0, i), Condition(1, k)), (terms.index(term),))
        for (i, k), term in zip(pairs, of_pair, strict=True)
    )
    return RuleBase(name, inputs, (output,), rules)


def constant(value_A: float) -> Singleton:
    return Singleton(f"{value_A:g}", value_A)
