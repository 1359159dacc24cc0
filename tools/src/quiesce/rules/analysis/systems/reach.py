"""What values an output of a system can have, and what could make it jump: from its terms."""

from collections.abc import Iterator

import numpy as np

from quiesce.rules.analysis.systems.signs import maker_of
from quiesce.rules.model import AND, OR
from quiesce.rules.system.fold import propositions
from quiesce.rules.system.model import (
    BISECTOR,
    BY_RULE,
    BY_TERM,
    CENTROID,
    SET_METHODS,
    Complement,
    ConstantTerm,
    Curve,
    Expression,
    Join,
    LinearTerm,
    SetTerm,
    System,
    SystemOutput,
    SystemRule,
    ValueTerm,
)
from quiesce.rules.system.norms import ANY, NORMS

EDGED = [name for name in NORMS if name.startswith(("Drastic", "Nilpotent"))]


def reach(system: System, index: int) -> tuple[float, float] | None:
    """Bounds of an output where a rule fires; None where they do not follow from its terms."""
    output = system.outputs[index]
    if output.method in SET_METHODS or output.clips:
        return output.minimum, output.maximum
    if output.method not in (BY_RULE, BY_TERM):
        return None
    used = {c.term for rule in system.rules for c in rule.conclusions if c.output == index}
    ends = [ends_of(system, output.terms[k]) for k in sorted(used)]
    known = [both for both in ends if both is not None]
    if not known or len(known) < len(ends):
        return None
    return min(low for low, _ in known), max(high for _, high in known)


def ends_of(system: System, term: SetTerm | ValueTerm) -> tuple[float, float] | None:
    if isinstance(term, ConstantTerm):
        return term.value, term.value
    if not isinstance(term, LinearTerm):
        return None
    ends = [
        sorted((slope * one.minimum, slope * one.maximum))
        for slope, one in zip(term.slopes, system.inputs, strict=True)
    ]
    low, high = (term.constant + sum(end[k] for end in ends) for k in (0, 1))
    return low, high


def why_it_may_jump(system: System, index: int, is_covered: bool) -> list[str]:
    """Nothing: it is continuous."""
    output = system.outputs[index]
    rules = [r for r in system.rules if any(c.output == index for c in r.conclusions)]
    reasons = [] if is_covered else ["places where no rule fires"]
    if output.method in SET_METHODS and output.method != CENTROID:
        reasons.append("a bisector" if output.method == BISECTOR else f"the {output.method}")
    reasons += [norm for norm in sorted(norms_of(system, output, rules)) if norm in EDGED]
    reasons += sorted(set(edges_of(system, rules)))
    if any(has_output(rule) for rule in rules):
        reasons.append("conditions on outputs")
    reasons += sorted(
        f"the values of {term.name}"
        for term in output.terms
        if not isinstance(term, ConstantTerm | LinearTerm | SetTerm)
    )
    if output.method == CENTROID and not keeps_area(system, output, rules):
        reasons.append("sets that may be 0 at all places")
    return reasons


def keeps_area(system: System, output: SystemOutput, rules: list[SystemRule]) -> bool:
    """Whether a rule that fires leaves something of its set: the minimum and products do, and no
    set of a weak strength is rounded away."""
    kept = ("Minimum", "AlgebraicProduct", "EinsteinProduct", "HamacherProduct")
    places = output.minimum + (output.maximum - output.minimum) / output.places * (
        np.arange(output.places) + 0.5
    )
    return all(system.blocks[rule.block].implication in kept for rule in rules) and all(
        bool((np.asarray(term.curve.function(places)) > 0).any())
        for term in output.terms
        if isinstance(term, SetTerm)
    )


def norms_of(system: System, output: SystemOutput, rules: list[SystemRule]) -> set[str]:
    """Those that its value depends on."""
    found = set() if output.method == BY_RULE else {output.aggregation}
    for rule in rules:
        block = system.blocks[rule.block]
        joins = set(connectives(rule.expression))
        found |= {block.conjunction} if AND in joins else set()
        found |= {block.disjunction} if OR in joins else set()
        found |= {block.implication} if output.method in SET_METHODS else set()
    return found


def connectives(expression: Expression) -> Iterator[str]:
    if isinstance(expression, Complement):
        yield from connectives(expression.part)
    elif isinstance(expression, Join):
        yield expression.connective
        for part in expression.parts:
            yield from connectives(part)


def has_output(rule: SystemRule) -> bool:
    return any(not one.is_input for one in propositions(rule.expression))


def edges_of(system: System, rules: list[SystemRule]) -> Iterator[str]:
    """Terms of inputs with a vertical edge in the universe, or of formulas."""
    for rule in rules:
        for one in propositions(rule.expression):
            if not one.is_input or ANY in one.hedges:
                continue
            variable = system.inputs[one.variable]
            term = variable.terms[one.term]
            if has_edge(term.curve, variable.minimum, variable.maximum):
                yield f"{term.name} of {variable.name}"


def has_edge(curve: Curve, low: float, high: float) -> bool:
    """Whether it jumps within the universe; True as well where it is not known."""
    if curve.points is None:
        return maker_of(curve) is None
    return any(
        x == other
        and mu != mu_behind
        and (low < x < high or (x == low and mu > mu_behind) or (x == high and mu < mu_behind))
        for (x, mu), (other, mu_behind) in zip(curve.points, curve.points[1:], strict=False)
    )
