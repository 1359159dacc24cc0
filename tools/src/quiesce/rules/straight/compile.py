"""From a system to what straight-line C of it is made of, or why there is none.

In a combination of stretches of the inputs (stretches.py) sets are straight lines, products of them
polynomials, and an output is the quotient of two: of the sums of strength x value and of strength.
Where the strengths add up to a constant, as the products of sets that add up to 1 do, it is one
polynomial. Minima are one of their parts in each region that comparisons tell apart, or numbers
found at run time.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod

from quiesce.base.errors import UsageError
from quiesce.rules.integers.cells import nearest
from quiesce.rules.integers.compile import (
    INT32_LIMIT,
    Q15,
    Q16,
    default_of,
    input_axis,
    output_axis,
)
from quiesce.rules.model import AND
from quiesce.rules.straight.stretches import Stretch, stretches_of
from quiesce.rules.system.compile import ScaledSystem
from quiesce.rules.system.fold import propositions
from quiesce.rules.system.model import (
    BY_TERM,
    VALUE_METHODS,
    ConstantTerm,
    Expression,
    Join,
    LinearTerm,
    Proposition,
    System,
    SystemOutput,
)
from quiesce.rules.system.norms import (
    ALGEBRAIC_PRODUCT,
    ANY,
    MAXIMUM,
    MINIMUM,
    NOT,
    UNBOUNDED_SUM,
)

MAX_INPUTS = 4
MAX_LEAVES = 400  # combinations of stretches
MAX_WORK = 6_000  # rules to be looked at, over all of them
ALGEBRAIC_SUM = "AlgebraicSum"
JOINS = (MINIMUM, MAXIMUM, ALGEBRAIC_PRODUCT, ALGEBRAIC_SUM)


class NotStraight(Exception):
    """Why a system has no straight-line form; one line."""


@dataclass(frozen=True)
class StraightSystem(ScaledSystem):
    stretches: tuple[tuple[Stretch, ...], ...]  # of each input, in order, over all of int32
    default_counts: tuple[int, ...]


def why_not_straight(system: System) -> str:
    """Empty where compile_straight() may take it."""
    if len(system.inputs) > MAX_INPUTS:
        return f"{len(system.inputs)} inputs; straight-line C takes {MAX_INPUTS}"
    for variable in system.inputs:
        for term in variable.terms:
            points = term.curve.points
            if points is None or not all(0.0 <= mu <= 1.0 for _, mu in points):
                return f"set {term.name} of input {variable.name} is not made of straight lines"
    for output in system.outputs:
        reason = why_not_output(output)
        if reason:
            return f"output {output.name} {reason}"
    for number, rule in enumerate(system.rules):
        reason = why_not_expression(system, rule.block, rule.expression)
        if not reason and any(one.hedges for one in rule.conclusions):
            reason = "has a hedge in its conclusion"
        if reason:
            return f"rule {number + 1} {reason}"
    return ""


def why_not_output(output: SystemOutput) -> str:
    if output.method not in VALUE_METHODS:
        return f"is the {output.method} of sets"
    if not all(isinstance(term, ConstantTerm | LinearTerm) for term in output.terms):
        return "has values that are no straight lines of the inputs"
    if output.method == BY_TERM and output.aggregation not in (MAXIMUM, UNBOUNDED_SUM):
        return f"aggregates by {output.aggregation}"
    return ""


def why_not_expression(system: System, block: int, expression: Expression) -> str:
    for one in propositions(expression):
        if not one.is_input:
            return "looks at an output"
        odd = [hedge for hedge in one.hedges if hedge not in (NOT, ANY)]
        if odd:
            return f"has the hedge {odd[0]}"
    norms = norms_of(system, block, expression)
    odd = [norm for norm in norms if norm not in JOINS]
    return f"joins by {odd[0]}" if odd else ""


def norms_of(system: System, block: int, expression: Expression) -> list[str]:
    if isinstance(expression, Proposition):
        return []
    if not isinstance(expression, Join):
        return norms_of(system, block, expression.part)
    own = system.blocks[block]
    norm = own.conjunction if expression.connective == AND else own.disjunction
    return [norm, *(one for part in expression.parts for one in norms_of(system, block, part))]


def compile_straight(
    system: System,
    inputs: Sequence[float | str] | None = None,
    outputs: Sequence[float | str] | None = None,
    defaults: Mapping[str, float] | None = None,
) -> StraightSystem:
    """inputs, outputs, defaults: as of compile_system. NotStraight where it has no such form,
    UsageError where the integers cannot hold it."""
    reason = why_not_straight(system)
    if reason:
        raise NotStraight(reason)
    forms = inputs or [Q15] * len(system.inputs)
    axes = tuple(input_axis(one, form) for one, form in zip(system.inputs, forms, strict=True))
    stretches = tuple(
        tuple(stretches_of(one, i, axes[i], has_slope(system, i)))
        for i, one in enumerate(system.inputs)
    )
    leaves = prod(map(len, stretches))
    if leaves > MAX_LEAVES or leaves * len(system.rules) > MAX_WORK:
        raise NotStraight(
            f"{leaves} combinations of stretches for {len(system.rules)} rules; straight-line C "
            f"takes {MAX_LEAVES}, and {MAX_WORK} rules in all of them"
        )
    notes: list[str] = []
    found = [default_of(one, defaults or {}, notes) for one in system.outputs]
    forms = outputs or [Q16] * len(system.outputs)
    own = tuple(output_axis(one, form) for one, form in zip(system.outputs, forms, strict=True))
    counts = tuple(nearest(axis.position(x)) for axis, x in zip(own, found, strict=True))
    if any(abs(count) > INT32_LIMIT for count in counts):
        raise UsageError(f"{system.name}: a default does not fit int32; use a larger LSB")
    return StraightSystem(
        system, axes, own, tuple(found), (*system.notes, *notes), stretches, counts
    )


def has_slope(system: System, index: int) -> bool:
    """Whether some output moves with the input's own value."""
    return any(
        isinstance(term, LinearTerm) and term.slopes[index] != 0
        for output in system.outputs
        for term in output.terms
    )
