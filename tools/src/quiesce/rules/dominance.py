"""Rules that another rule with the same conclusion always outdoes.

Where only the greatest strength of a term counts, a rule changes nothing if another one with the
same conclusion is at least as strong everywhere. With minimum conditions this separates by input:
Q outdoes R where, along each input, Q's own condition is nowhere weaker than R's, the latter
capped by the most that R's other conditions can reach. Each of these is a comparison of two
piecewise linear functions, done at their breakpoints (from both sides) and where the cap is met.
"""

from collections.abc import Sequence
from functools import cache

import numpy as np

from quiesce.rules.model import AND, WEIGHTED_SUM, Condition, FuzzySet, Input, Rule, RuleBase
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
    most = [weak_weight * span(base, condition)[1] for condition in weak]
    for condition in strong:
        along = [i for i, other in enumerate(weak) if other.input == condition.input]
        cap = min((m for i, m in enumerate(most) if i not in along), default=weak_weight)
        variable = base.inputs[condition.input]
        if not along:
            if strong_weight * span(base, condition)[0] < cap - TOLERANCE:
                return False
        elif not is_above(variable, condition, strong_weight, weak[along[0]], weak_weight, cap):
            return False
    return True


def span(base: RuleBase, condition: Condition) -> tuple[float, float]:
    """Least and greatest value of a condition over its input's universe."""
    variable = base.inputs[condition.input]
    one = variable.sets[condition.set]
    values = [mu for start, end in intervals(variable) for mu in limits(one, start, end)]
    values += [one.membership(x) for x in edges(variable)]
    low, high = min(values), max(values)
    return (1 - high, 1 - low) if condition.negated else (low, high)


@cache
def edges(variable: Input) -> tuple[float, ...]:
    places = {x for one in variable.sets for x, _ in one.points}
    places |= {variable.minimum, variable.maximum}
    return tuple(sorted(x for x in places if variable.minimum <= x <= variable.maximum))


def intervals(variable: Input) -> list[tuple[float, float]]:
    return list(zip(edges(variable), edges(variable)[1:], strict=False))


@cache
def is_above(
    variable: Input,
    strong: Condition,
    strong_weight: float,
    weak: Condition,
    weak_weight: float,
    cap: float,
) -> bool:
    """Whether strong_weight * strong >= min(cap, weak_weight * weak) all along the input."""
    upper, lower = variable.sets[strong.set], variable.sets[weak.set]
    for x in edges(variable):
        a = strong_weight * counted(upper.membership(x), strong)
        b = weak_weight * counted(lower.membership(x), weak)
        if a < min(cap, b) - TOLERANCE:
            return False
    return all(
        is_line_above(
            [strong_weight * mu for mu in line(upper, strong, start, end)],
            [weak_weight * mu for mu in line(lower, weak, start, end)],
            cap,
        )
        for start, end in intervals(variable)
    )


def counted(mu: float, condition: Condition) -> float:
    return 1 - mu if condition.negated else mu


def line(one: FuzzySet, condition: Condition, start: float, end: float) -> list[float]:
    return [counted(mu, condition) for mu in limits(one, start, end)]


def is_line_above(upper: Sequence[float], lower: Sequence[float], cap: float) -> bool:
    """Between two ends: upper >= min(cap, lower), where upper and lower are straight."""
    places = [0.0, 1.0]
    if min(lower) < cap < max(lower):
        places.append((cap - lower[0]) / (lower[1] - lower[0]))
    for u in places:
        a = upper[0] + u * (upper[1] - upper[0])
        b = lower[0] + u * (lower[1] - lower[0])
        if a < min(cap, b) - TOLERANCE:
            return False
    return True
