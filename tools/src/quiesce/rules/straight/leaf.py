"""Strengths and values in one combination of stretches, as polynomials of the inputs' variables."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce

from quiesce.rules.integers.cells import ceil, exact, floor
from quiesce.rules.model import AND
from quiesce.rules.straight.compile import ALGEBRAIC_SUM, StraightSystem
from quiesce.rules.straight.horner import ONE, Variable, range_of
from quiesce.rules.straight.polynomial import Polynomial, Range, constant, total
from quiesce.rules.straight.region import Region, region_of
from quiesce.rules.straight.stretches import Stretch
from quiesce.rules.system.model import (
    BY_TERM,
    WEIGHTED,
    Complement,
    ConstantTerm,
    Expression,
    LinearTerm,
    Proposition,
    SystemRule,
    ValueTerm,
)
from quiesce.rules.system.norms import ALGEBRAIC_PRODUCT, ANY, MAXIMUM, MINIMUM, NOT

Pair = tuple[Polynomial, Polynomial]
# Of polynomials of which no one is known to be the least (True) or the greatest: one of them.
Extreme = Callable[[Sequence[Polynomial], bool], Polynomial]


@dataclass(frozen=True)
class Sums:
    """Of an output: of strength x value, in its counts, and of strength; the range of the values,
    in counts; the value, where all have the same; how many strengths there are."""

    weighted: Polynomial
    strength: Polynomial
    values: Range
    common: Polynomial | None
    count: int


@dataclass(frozen=True)
class Fact:
    """What a comparison has told: difference <= doubt, or - difference <= doubt. doubt is what
    rounding may do to it."""

    difference: Polynomial
    is_less: bool
    doubt: Fraction

    @property
    def limit(self) -> Polynomial:
        return self.difference * (1 if self.is_less else -1) - constant(self.doubt)


class Leaf:
    def __init__(
        self,
        compiled: StraightSystem,
        stretches: Sequence[Stretch],
        facts: Sequence[Fact],
        extreme: Extreme,
    ) -> None:
        self.compiled, self.stretches, self.facts = compiled, stretches, facts
        self.extreme = extreme
        self.floors: dict[str, Polynomial] = {}
        whole = {part.name: range_of(part.variable) for part in stretches}
        self.region = region_of(whole, [fact.limit for fact in facts])
        self.variables = {name: variable_of(ends) for name, ends in self.region.box.items()}

    def range(self, polynomial: Polynomial) -> Range:
        return self.region.range(polynomial)

    def add_variable(self, name: str, of: Variable, at_least: Polynomial) -> None:
        """at_least: what it is no less than."""
        self.variables[name], self.floors[name] = of, at_least
        self.region = Region({**self.region.box, name: range_of(of)}, self.region.corners)

    def least(self, strength: Polynomial) -> Fraction:
        """That a sum of strengths can be."""
        for name, floor_of in self.floors.items():
            fixed, *rising = strength.powers(name)
            strength = total([fixed, *(one * floor_of for one in rising)])
        return self.range(strength)[0]

    # ---- strengths ------------------------------------------------------------------------------

    def is_no_more(self, one: Polynomial, other: Polynomial) -> bool | None:
        """Whether one <= other everywhere here, or other <= one (False); None: neither is known."""
        difference = one - other
        low, high = self.range(difference)
        if high <= 0 or low >= 0:
            return high <= 0
        for fact in self.facts:
            ratio = ratio_of(difference, fact.difference)
            if ratio:
                return fact.is_less == (ratio > 0)
        return None

    def least_of(self, values: Sequence[Polynomial], is_least: bool) -> Polynomial:
        """Or the greatest."""
        kept: list[Polynomial] = []
        for value in values:
            if any(self.is_no_more(*pair(other, value, is_least)) for other in kept):
                continue
            kept = [one for one in kept if not self.is_no_more(*pair(value, one, is_least))]
            kept.append(value)
        return kept[0] if len(kept) == 1 else self.extreme(kept, is_least)

    def join(self, norm: str, values: Sequence[Polynomial]) -> Polynomial:
        if norm == ALGEBRAIC_PRODUCT:
            return reduce(lambda a, b: a * b, values)
        if norm == ALGEBRAIC_SUM:
            return reduce(lambda a, b: a + b - a * b, values)
        assert norm in (MINIMUM, MAXIMUM)
        return self.least_of(values, norm == MINIMUM)

    def strength_of(self, block: int, expression: Expression) -> Polynomial:
        if isinstance(expression, Complement):
            return constant(1) - self.strength_of(block, expression.part)
        if isinstance(expression, Proposition):
            return self.proposed(expression)
        own = self.compiled.system.blocks[block]
        norm = own.conjunction if expression.connective == AND else own.disjunction
        return self.join(norm, [self.strength_of(block, part) for part in expression.parts])

    def proposed(self, one: Proposition) -> Polynomial:
        of_set = self.stretches[one.variable].memberships[one.term]
        value = constant(1) if ANY in one.hedges else of_set
        return constant(1) - value if one.hedges.count(NOT) % 2 else value

    def rule_strength(self, rule: SystemRule) -> Polynomial:
        return self.strength_of(rule.block, rule.expression) * exact(rule.weight)

    # ---- outputs --------------------------------------------------------------------------------

    def value_of(self, index: int, term: ValueTerm) -> Polynomial:
        """In counts from the output's origin; of a weighted sum from its 0."""
        output, axis = self.compiled.system.outputs[index], self.compiled.output_axes[index]
        origin = Fraction(0) if output.method == WEIGHTED else axis.origin
        if isinstance(term, ConstantTerm):
            value = constant(exact(term.value))
        else:
            assert isinstance(term, LinearTerm)
            moving = zip(term.slopes, self.stretches, strict=True)
            parts = [part.x * exact(slope) for slope, part in moving if slope]
            value = total([constant(exact(term.constant)), *parts])
        return (value - constant(origin)) * (1 / axis.lsb)

    def fired(self, index: int) -> list[tuple[Polynomial, Polynomial]]:
        """Strength and value of what counts, where that can be above 0."""
        output = self.compiled.system.outputs[index]
        by_term: list[list[Polynomial]] = [[] for _ in output.terms]
        for rule in self.compiled.system.rules:
            for one in rule.conclusions:
                strength = self.rule_strength(rule) if one.output == index else constant(0)
                if self.range(strength)[1] > 0:
                    by_term[one.term].append(strength)
        if output.method == BY_TERM and output.aggregation == MAXIMUM:
            by_term = [[self.least_of(found, False)] if found else [] for found in by_term]
        return [
            (strength, self.value_of(index, term))
            for term, found in zip(output.terms, by_term, strict=True)
            for strength in found
        ]

    def sums(self, index: int) -> Sums:
        found = self.fired(index)
        ranges = [self.range(value) for _, value in found] or [(Fraction(0), Fraction(0))]
        return Sums(
            total(strength * value for strength, value in found),
            total(strength for strength, _ in found),
            (min(low for low, _ in ranges), max(high for _, high in ranges)),
            found[0][1] if len({value for _, value in found}) == 1 else None,
            len(found),
        )


def variable_of(ends: Range) -> Variable:
    return Variable(floor(ends[0] * ONE), ceil(ends[1] * ONE))


def pair(one: Polynomial, other: Polynomial, is_least: bool) -> Pair:
    return (one, other) if is_least else (other, one)


def ratio_of(one: Polynomial, other: Polynomial) -> Fraction | None:
    """one = ratio x other; None where there is none."""
    if [m for m, _ in one.terms] != [m for m, _ in other.terms]:
        return None
    ratios = {a / b for (_, a), (_, b) in zip(one.terms, other.terms, strict=True)}
    return ratios.pop() if len(ratios) == 1 else None
