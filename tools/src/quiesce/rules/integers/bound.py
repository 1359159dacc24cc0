"""How far a weighted average can be off, from the rounding of its integers alone.

With strengths off by at most e and singletons c, an average moves by at most
e * sum |c - average| / sum of strengths. In a cell every strength of "and" is concave, so that
their sum is least in a corner.
"""

from collections.abc import Sequence
from fractions import Fraction
from itertools import product

from quiesce.rules.integers.cells import Cell
from quiesce.rules.integers.compile import MEMBERSHIP_ERROR, singleton_error
from quiesce.rules.integers.compiled import WEIGHT_ONE, CompiledBase, IntegerRule
from quiesce.rules.model import CENTROID, WEIGHTED_MAX

PRODUCT_ERROR = Fraction(1)  # at most, of the bits that fuzzy_strength() drops
WEIGHT_ERROR = Fraction(1, 2 * WEIGHT_ONE)
MAX_COMBINATIONS = 20_000


def error_bounds(compiled: CompiledBase) -> list[float | None]:
    """Of each output, in its unit; None where there is no such bound: a centroid, strengths that
    fall to 0, "or", more than MAX_COMBINATIONS of cells."""
    count = 1
    for cells in compiled.cells:
        count *= len(cells)
    is_simple = count <= MAX_COMBINATIONS and not any(rule.is_or for rule in compiled.rules)
    return [
        output_bound(compiled, index) if is_simple and output.method != CENTROID else None
        for index, output in enumerate(compiled.base.outputs)
    ]


def output_bound(compiled: CompiledBase, index: int) -> float | None:
    worst = Fraction(0)
    for cells in product(*compiled.cells):
        found = cell_bound(compiled, index, cells)
        if found is None:
            return None
        worst = max(worst, found)
    # The quotient is to nearest, and so are the singletons.
    rounding = Fraction(1, 2) + singleton_error(
        compiled.outputs[index], compiled.base.outputs[index]
    )
    return float((worst + rounding) * compiled.outputs[index].axis.lsb)


def cell_bound(compiled: CompiledBase, index: int, cells: Sequence[Cell]) -> Fraction | None:
    """In counts of the output."""
    corners = [strengths(compiled, index, cells, ends) for ends in corner_choices(cells)]
    rules = [rule for rule in compiled.rules if rule.conclusions[index] is not None]
    fired = [r for r in range(len(rules)) if any(corner[r] > 0 for corner in corners)]
    if not fired:
        return Fraction(0)
    least = min(sum(corner) for corner in corners)
    output = compiled.outputs[index]
    if compiled.base.outputs[index].method == WEIGHTED_MAX:
        # Of rules with one term only the strongest counts.
        shared = [rules[r].conclusions[index] for r in fired]
        least /= max(shared.count(term) for term in shared)
    if least <= 0:
        return None
    scale = 2**output.fraction
    values = [Fraction(output.terms[rules[r].conclusions[index]], scale) for r in fired]
    errors = [strength_error(compiled, rules[r]) for r in fired]
    spread = max(
        sum(e * abs(c - end) for e, c in zip(errors, values, strict=True))
        for end in (min(values), max(values))
    )
    return spread / least


def corner_choices(cells: Sequence[Cell]) -> list[tuple[int, ...]]:
    return list(
        product(*({cell.first, cell.last} if has_slope(cell) else {cell.first} for cell in cells))
    )


def has_slope(cell: Cell) -> bool:
    return any(ramp.b for ramp in cell.ramps)


def strengths(
    compiled: CompiledBase, index: int, cells: Sequence[Cell], ends: Sequence[int]
) -> list[Fraction]:
    """Of the rules that conclude something for the output, in units of 2^-bits."""
    one = 1 << compiled.bits
    memberships = [cell.memberships(n) for cell, n in zip(cells, ends, strict=True)]
    found = []
    for rule in compiled.rules:
        if rule.conclusions[index] is None:
            continue
        values = [
            one - memberships[i].get(s, 0) if negated else memberships[i].get(s, 0)
            for i, s, negated in rule.conditions
        ]
        found.append(Fraction(min(values) * rule.weight_q19, WEIGHT_ONE << rule.exponent))
    return found


def strength_error(compiled: CompiledBase, rule: IntegerRule) -> Fraction:
    if rule.is_full:
        return MEMBERSHIP_ERROR
    one = 1 << compiled.bits
    return MEMBERSHIP_ERROR + PRODUCT_ERROR + WEIGHT_ERROR * one / 2**rule.exponent
