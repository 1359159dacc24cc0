"""Rules that another rule with the same conclusion always outdoes.

Where only the greatest strength of a term counts, a rule changes nothing if another one with the
same conclusion is at least as strong everywhere. With minimum conditions this separates by input:
Q outdoes R where, along each input, Q's conditions are nowhere weaker than R's, the latter capped
by the most that R can reach. Each of these is a comparison of
piecewise linear functions, done at their breakpoints (from both sides) and where they meet.
"""

from collections.abc import Sequence
from functools import cache
from itertools import combinations

import numpy as np

from quiesce.rules.model import AND, WEIGHTED_SUM, Condition, Input, Rule, RuleBase
from quiesce.rules.reference import evaluate, limits

TOLERANCE = 1e-12
SAMPLES = 256  # random points that spare most pairs the exact comparison


def dominated_rules(base: RuleBase) -> dict[int, int]:
    """Rules that never decide anything, and for each one that outdoes it (for its first output).

    Of rules that are equally strong everywhere, the first one stays. Joint coverage by several
    rules is not looked for; an "or" counts as outdoing where one of its conditions alone does.
    """
    found: dict[int, int] = {}
    sampled = sampled_strengths(base)
    for index, rule in enumerate(base.rules):
        may_outdo = (sampled >= sampled[index] - TOLERANCE).all(axis=1)
        masters = [
            master_of(base, index, output, may_outdo)
            for output, term in enumerate(rule.conclusions)
            if term is not None
        ]
        if masters and all(master is not None for master in masters):
            found[index] = next(master for master in masters if master is not None)
    return found


def sampled_strengths(base: RuleBase) -> np.ndarray:
    """[rule, point], at random points."""
    random = np.random.default_rng(1)
    points = [random.uniform(v.minimum, v.maximum, SAMPLES) for v in base.inputs]
    strengths = evaluate(base, points, want_strengths=True).strengths
    assert strengths is not None
    return strengths


def master_of(base: RuleBase, index: int, output: int, may_outdo: np.ndarray) -> int | None:
    """A rule that makes rule `index` pointless for an output; may_outdo [rule], bool."""
    if base.outputs[output].method == WEIGHTED_SUM:
        return None
    rule = base.rules[index]
    for other, candidate in enumerate(base.rules):
        if other == index or candidate.conclusions[output] != rule.conclusions[output]:
            continue
        if not may_outdo[other]:
            continue
        if outdoes(base, candidate, rule) and (other < index or not outdoes(base, rule, candidate)):
            return other
    return None


def outdoes(base: RuleBase, strong: Rule, weak: Rule) -> bool:
    """Whether strong's strength is nowhere below weak's."""
    return all(
        any(
            and_outdoes(base, strong_part, strong.weight, weak_part, weak.weight)
            for strong_part in and_parts(strong)
        )
        for weak_part in and_parts(weak)
    )


def and_parts(rule: Rule) -> list[tuple[Condition, ...]]:
    """The rule as a maximum of minima."""
    return [rule.conditions] if rule.connective == AND else [(c,) for c in rule.conditions]


def and_outdoes(
    base: RuleBase,
    strong: Sequence[Condition],
    strong_weight: float,
    weak: Sequence[Condition],
    weak_weight: float,
) -> bool:
    by_input: dict[int, list[Condition]] = {}
    for condition in weak:
        by_input.setdefault(condition.input, []).append(condition)
    most = {
        i: weak_weight * max(map(min, values(base.inputs[i], tuple(conditions))))
        for i, conditions in by_input.items()
    }
    cap = min(most.values())
    for condition in strong:
        along = tuple(by_input.get(condition.input, ()))
        weights = (strong_weight, *[weak_weight] * len(along))
        rows = values(base.inputs[condition.input], (condition, *along), weights, cap)
        if any(row[0] < min((cap, *row[1:])) - TOLERANCE for row in rows):
            return False
    return True


@cache
def edges(variable: Input) -> tuple[float, ...]:
    places = {x for one in variable.sets for x, _ in one.points}
    places |= {variable.minimum, variable.maximum}
    return tuple(sorted(x for x in places if variable.minimum <= x <= variable.maximum))


@cache
def values(
    variable: Input,
    conditions: tuple[Condition, ...],
    weights: tuple[float, ...] | None = None,
    level: float | None = None,
) -> list[tuple[float, ...]]:
    """Weighted values of all conditions together, wherever a comparison of them can turn.

    That is at the breakpoints, on both sides of them, and where two of them, or one and the level,
    are equal.
    """
    weights = weights or (1.0,) * len(conditions)
    pairs = list(zip(conditions, weights, strict=True))
    sets = variable.sets
    rows = [
        tuple(weight * counted(sets[c.set].membership(x), c) for c, weight in pairs)
        for x in edges(variable)
    ]
    for start, end in zip(edges(variable), edges(variable)[1:], strict=False):
        lines = [
            [weight * counted(mu, c) for mu in limits(sets[c.set], start, end)]
            for c, weight in pairs
        ]
        levels = [] if level is None else [[level, level]]
        for u in (0.0, 1.0, *crossings([*lines, *levels])):
            rows.append(tuple(first + u * (last - first) for first, last in lines))
    return rows


def counted(mu: float, condition: Condition) -> float:
    return 1 - mu if condition.negated else mu


def crossings(lines: Sequence[Sequence[float]]) -> list[float]:
    """Places between 0 and 1 at which two lines, given there, are equal."""
    found = []
    for one, other in combinations(lines, 2):
        start, end = one[0] - other[0], one[1] - other[1]
        if start * end < 0:
            found.append(start / (start - end))
    return found
