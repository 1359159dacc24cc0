"""Whether two rule bases say the same: names, sets, rules in order, whatever their spelling.

Equal are sets that differ in points which do not bend them, rules whose conditions stand in
another order, and the two connectives where there is one condition.
"""

from dataclasses import replace

from quiesce.rules.analysis.coverage import uncovered_regions
from quiesce.rules.model import AND, CENTROID, FuzzySet, Input, Output, Point, Rule, RuleBase


def difference(one: RuleBase, other: RuleBase) -> str | None:
    """What they differ in, in words; None where they say the same."""
    if one.name != other.name:
        return f"names {one.name} and {other.name}"
    if (len(one.inputs), len(one.outputs)) != (len(other.inputs), len(other.outputs)):
        return "numbers of variables"
    for a, b in zip(one.inputs, other.inputs, strict=True):
        if plain_input(a) != plain_input(b):
            return f"input {a.name}"
    for index, (a, b) in enumerate(zip(one.outputs, other.outputs, strict=True)):
        if plain_output(a) != plain_output(b):
            return f"output {a.name}"
        if a.default != b.default and default_matters(one, index):
            return f"default of output {a.name}"
    if len(one.rules) != len(other.rules):
        return "numbers of rules"
    for number, (a, b) in enumerate(zip(one.rules, other.rules, strict=True), start=1):
        if plain_rule(a) != plain_rule(b):
            return f"rule {number}"
    return None


def default_matters(base: RuleBase, output: int) -> bool:
    """Whether there is an input at which no rule of the output fires."""
    return bool(uncovered_regions(base, output))


def plain_points(points: tuple[Point, ...]) -> tuple[Point, ...]:
    """Without those that lie on a level stretch, and the outer ones of a level end."""
    kept: list[Point] = []
    for point in points:
        if len(kept) > 1 and kept[-2][1] == kept[-1][1] == point[1]:
            kept.pop()
        kept.append(point)
    while len(kept) > 1 and kept[0][1] == kept[1][1]:
        kept.pop(0)
    while len(kept) > 1 and kept[-1][1] == kept[-2][1]:
        kept.pop()
    if len(kept) == 1:
        return ((0.0, kept[0][1]),)
    return tuple(kept)


def plain_set(one: FuzzySet) -> FuzzySet:
    return FuzzySet(one.name, plain_points(one.points))


def plain_input(variable: Input) -> Input:
    return replace(variable, sets=tuple(map(plain_set, variable.sets)))


def plain_output(output: Output) -> Output:
    """Without its default."""
    terms = tuple(map(plain_set, output.terms)) if output.method == CENTROID else output.terms
    return replace(output, terms=terms, default=None)


def plain_rule(rule: Rule) -> Rule:
    conditions = tuple(sorted(rule.conditions, key=lambda c: (c.input, c.set, c.negated)))
    return replace(
        rule, conditions=conditions, connective=rule.connective if len(conditions) > 1 else AND
    )
