"""Stretches of an input: where all its memberships are straight lines, in exact numbers.

An input is an int32 n. In a stretch its variable is t = (n - middle) << shift, -2^31 .. 2^31 - 1,
which stands for t / 2^32 (horner.py); the input's value and its memberships are polynomials of
that, of first degree. Beyond the universe they are those of its ends.
"""

from dataclasses import dataclass, replace
from fractions import Fraction

from quiesce.rules.integers.cells import (
    INT32_MAX,
    INT32_MIN,
    Axis,
    ceil,
    exact,
    exact_membership,
    floor,
    integer_spans,
)
from quiesce.rules.model import FuzzySet, Input
from quiesce.rules.straight.horner import Variable, range_of
from quiesce.rules.straight.polynomial import Polynomial, constant, variable
from quiesce.rules.system.model import SystemInput


@dataclass(frozen=True)
class Stretch:
    first: int  # both inclusive
    last: int
    shift: int
    name: str  # of the variable
    x: Polynomial  # the input in its unit
    memberships: tuple[Polynomial, ...]  # of every set

    @property
    def middle(self) -> int:
        return (self.first + self.last + 1) // 2

    @property
    def variable(self) -> Variable:
        ends = ((end - self.middle) << self.shift for end in (self.first, self.last))
        return Variable(*ends)

    @property
    def text(self) -> str:
        """C of the variable; x and the input's number name the integer."""
        distance = f"(uint32_t)x{self.name[1:]} - {self.middle & 0xFFFFFFFF}u"
        return f"(int32_t)(({distance}) << {self.shift})"


def stretches_of(one: SystemInput, index: int, axis: Axis, has_slope: bool) -> list[Stretch]:
    """They cover int32. has_slope: whether some output moves with the input's own value."""
    sets = tuple(FuzzySet(term.name, term.curve.points or ()) for term in one.terms)
    variable_of_model = Input(one.name, one.minimum, one.maximum, sets)
    low, high = ceil(axis.position(one.minimum)), floor(axis.position(one.maximum))
    maker = Maker(sets, axis, f"t{index}")
    found = [maker.held(exact(one.minimum), INT32_MIN, low - 1)]
    found += [maker.stretch(*ends) for ends in integer_spans(variable_of_model, axis, low, high)]
    found.append(maker.held(exact(one.maximum), high + 1, INT32_MAX))
    return merged([part for part in found if part.first <= part.last], has_slope)


@dataclass(frozen=True)
class Maker:
    sets: tuple[FuzzySet, ...]
    axis: Axis
    name: str

    def held(self, x: Fraction, first: int, last: int) -> Stretch:
        values = tuple(constant(exact_membership(one, x)) for one in self.sets)
        return Stretch(first, last, 0, self.name, constant(x), values)

    def stretch(self, first: int, last: int) -> Stretch:
        start, end = (self.axis.origin + n * self.axis.lsb for n in (first, last))
        shift = 32 - (last - first).bit_length()
        made = Stretch(first, last, shift if last > first else 0, self.name, constant(start), ())
        low, high = range_of(made.variable)

        def straight(at_start: Fraction, at_end: Fraction) -> Polynomial:
            slope = (at_end - at_start) / (high - low) if last > first else Fraction(0)
            return constant(at_start - slope * low) + variable(self.name) * slope

        memberships = tuple(
            straight(*(exact_membership(one, x) for x in (start, end))) for one in self.sets
        )
        return replace(made, x=straight(start, end), memberships=memberships)


def merged(parts: list[Stretch], has_slope: bool) -> list[Stretch]:
    """Neighbours in which nothing that counts moves become one."""
    out: list[Stretch] = []
    for part in parts:
        previous = out[-1] if out else None
        if previous and is_alike(previous, part, has_slope):
            out[-1] = replace(previous, last=part.last, shift=0)
        else:
            out.append(part)
    return out


def is_alike(one: Stretch, other: Stretch, has_slope: bool) -> bool:
    still = (*one.memberships, one.x) if has_slope else one.memberships
    others = (*other.memberships, other.x) if has_slope else other.memberships
    return still == others and all(part.is_constant for part in still)
