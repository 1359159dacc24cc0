"""What is wrong, or looks wrong, with a rule base: found without running anything on a target."""

from itertools import combinations

from quiesce.rules.analysis.coverage import coverage_findings, silent_findings, silent_rules
from quiesce.rules.analysis.dominance import dominated_rules
from quiesce.rules.analysis.findings import (
    CONTRADICTORY,
    DUPLICATE,
    EMPTY,
    ERROR,
    UNREACHABLE,
    UNUSED,
    WARNING,
    Finding,
    rule_place,
)
from quiesce.rules.analysis.monotone import monotone_findings
from quiesce.rules.model import CENTROID, WEIGHTED_SUM, Rule, RuleBase
from quiesce.rules.reference import stretches


def analyse(base: RuleBase) -> list[Finding]:
    """Every finding; errors first, then warnings, then notes, otherwise in a stable order."""
    found = [
        *coverage_findings(base),
        *unused_findings(base),
        *empty_findings(base),
        *silent_findings(base),
        *dominated_findings(base),
        *pair_findings(base),
        *monotone_findings(base),
    ]
    return worst_first(found)


def worst_first(found: list[Finding]) -> list[Finding]:
    order = {ERROR: 0, WARNING: 1}
    return sorted(found, key=lambda finding: order.get(finding.severity, 2))


# Sets, terms, inputs and outputs without a rule


def unused_findings(base: RuleBase) -> list[Finding]:
    conditions = [condition for rule in base.rules for condition in rule.conditions]
    found = []
    for index, variable in enumerate(base.inputs):
        used = {c.set for c in conditions if c.input == index}
        found += nothing_uses("input", variable.name, variable.sets, used, "asks for")
    for index, output in enumerate(base.outputs):
        used = {rule.conclusions[index] for rule in base.rules} - {None}
        found += nothing_uses("output", output.name, output.terms, used, "concludes")
    return found


def nothing_uses(kind: str, name: str, parts: tuple, used: set, verb: str) -> list[Finding]:
    place = f"{kind} {name}"
    if not used:
        return [Finding(UNUSED, WARNING, f"no rule {verb} {place}", place)]
    return [
        Finding(UNUSED, WARNING, f"no rule {verb} {part.name} of {place}", f"{place}, {part.name}")
        for i, part in enumerate(parts)
        if i not in used
    ]


def empty_findings(base: RuleBase) -> list[Finding]:
    """Terms of a centroid output that rules conclude, but that have no area in its universe."""
    found = []
    for index, output in enumerate(base.outputs):
        if output.method != CENTROID:
            continue
        used = {rule.conclusions[index] for rule in base.rules}
        filled = {term for stretch in stretches(output) for term in stretch.terms}
        for i, term in enumerate(output.terms):
            if i in used and i not in filled:
                place = f"output {output.name}, {term.name}"
                text = f"{term.name} of output {output.name} has no area in its universe: rules "
                found.append(Finding(EMPTY, ERROR, f"{text}that conclude it say nothing", place))
    return found


# Rules beside other rules


def dominated_findings(base: RuleBase) -> list[Finding]:
    told_already = set(silent_rules(base)) | {later for _, later in duplicates(base)}
    return [
        Finding(
            UNREACHABLE,
            WARNING,
            f"{rule_place(weak)} never decides: {rule_place(strong)} has the same conclusion and "
            f"is at least as strong everywhere ({base.rule_text(base.rules[weak])})",
            rule_place(weak),
        )
        for weak, strong in dominated_rules(base).items()
        if weak not in told_already
    ]


def pair_findings(base: RuleBase) -> list[Finding]:
    found = []
    for first, second in same_conditions(base):
        one, other = base.rules[first], base.rules[second]
        clashing = [
            output
            for output, (a, b) in enumerate(zip(one.conclusions, other.conclusions, strict=True))
            if a is not None and b is not None and a != b
        ]
        found += [contradiction(base, first, second, output) for output in clashing]
    return found + [duplicate(base, first, second) for first, second in duplicates(base)]


def same_conditions(base: RuleBase) -> list[tuple[int, int]]:
    """Pairs of rules, the earlier one first."""
    groups: dict[object, list[int]] = {}
    for index, rule in enumerate(base.rules):
        groups.setdefault(condition_key(base, rule), []).append(index)
    return sorted(pair for group in groups.values() for pair in combinations(group, 2))


def condition_key(base: RuleBase, rule: Rule) -> object:
    """Equal for rules of equal conditions, in any order; sets count by shape, not by name."""
    conditions = frozenset(
        (c.input, base.inputs[c.input].sets[c.set].points, c.negated) for c in rule.conditions
    )
    return conditions, rule.connective if len(conditions) > 1 else None


def duplicates(base: RuleBase) -> list[tuple[int, int]]:
    """Pairs of equal conditions that conclude the same wherever both conclude something."""
    found = []
    for first, second in same_conditions(base):
        conclusions = zip(
            base.rules[first].conclusions, base.rules[second].conclusions, strict=True
        )
        common = [(a, b) for a, b in conclusions if a is not None and b is not None]
        if common and all(a == b for a, b in common):
            found.append((first, second))
    return found


def contradiction(base: RuleBase, first: int, second: int, output: int) -> Finding:
    terms = [base.rules[i].conclusions[output] for i in (first, second)]
    one, other = (base.outputs[output].terms[term].name for term in terms if term is not None)
    name = base.outputs[output].name
    return Finding(
        CONTRADICTORY,
        WARNING,
        f"{rule_place(first)} and {rule_place(second)} have the same conditions, but conclude "
        f"{name} IS {one} and {name} IS {other}: {base.rule_text(base.rules[first])}",
        rule_place(second),
    )


def duplicate(base: RuleBase, first: int, second: int) -> Finding:
    counts_twice = any(
        output.method == WEIGHTED_SUM
        and None not in (base.rules[first].conclusions[i], base.rules[second].conclusions[i])
        for i, output in enumerate(base.outputs)
    )
    effect = "counts twice" if counts_twice else "has no effect of its own"
    if not counts_twice and base.rules[first].weight != base.rules[second].weight:
        effect = "only the greater weight counts"
    return Finding(
        DUPLICATE,
        WARNING,
        f"{rule_place(second)} repeats {rule_place(first)}, {effect}: "
        f"{base.rule_text(base.rules[second])}",
        rule_place(second),
    )
