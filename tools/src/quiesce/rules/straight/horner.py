"""A polynomial in 32-bit integers: a step a coefficient, each one multiplication.

A variable is an integer n that stands for n / 2^32, a value one that counts units of 2^-bits. A
step is base + floor(factor n / 2^32), fuzzy_step() of the firmware; the unit is the finest with
which nothing leaves 32 bits. What rounding does is bounded exactly.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import permutations

from quiesce.rules.integers.c_writer import int_text
from quiesce.rules.integers.cells import ceil, floor, nearest
from quiesce.rules.straight.polynomial import Polynomial, Range, constant

ONE = 1 << 32  # of a variable
LIMIT = (1 << 31) - 1
ROOM = 1 << 10  # units that rounding and its correction may need
MANY = 3  # variables, of which all orders are no longer tried
MAX_BITS = 30
MIN_BITS = -30


@dataclass(frozen=True)
class Variable:
    """Of C, int32: least .. most, off by at most error; all in 2^-32."""

    least: int
    most: int
    error: Fraction = Fraction(0)


Variables = Mapping[str, Variable]


def range_of(one: Variable) -> Range:
    return Fraction(one.least, ONE), Fraction(one.most, ONE)


@dataclass(frozen=True)
class Form:
    """C of an int32 that lies in least .. most; it less what it stands for lies in below .. above.
    All in units of 2^-bits."""

    text: str
    bits: int
    least: int
    most: int
    below: Fraction
    above: Fraction
    steps: int
    widest: int  # magnitude of whatever is computed on the way

    @property
    def error(self) -> Fraction:
        """At most, in what it stands for."""
        return max(abs(self.below), abs(self.above)) / Fraction(2) ** self.bits


def plain_form(polynomial: Polynomial, variables: Variables, bits: int) -> Form:
    return horner(polynomial, best_order(polynomial), variables, bits)


def centred_form(polynomial: Polynomial, variables: Variables, bits: int) -> Form:
    """Off by as much to either side."""
    plain = plain_form(polynomial, variables, bits)
    return moved_form(polynomial, variables, bits, -nearest((plain.below + plain.above) / 2))


def lifted_form(polynomial: Polynomial, variables: Variables, bits: int) -> Form:
    """Not below what it stands for."""
    plain = plain_form(polynomial, variables, bits)
    return moved_form(polynomial, variables, bits, -floor(plain.below))


def moved_form(polynomial: Polynomial, variables: Variables, bits: int, by: int) -> Form:
    """The form of the polynomial, and `by` of its units more, which count as an error."""
    form = plain_form(polynomial + constant(by / Fraction(2) ** bits), variables, bits)
    return replace(form, below=form.below + by, above=form.above + by)


def finest_bits(polynomial: Polynomial, variables: Variables, most: int = MAX_BITS) -> int | None:
    """With which nothing leaves 32 bits, a few units more included; None where it does anyway."""
    order = best_order(polynomial)
    fits, too_fine = MIN_BITS, most + 1
    if not is_narrow(polynomial, order, variables, fits):
        return None
    while too_fine - fits > 1:
        tried = (fits + too_fine) // 2
        if is_narrow(polynomial, order, variables, tried):
            fits = tried
        else:
            too_fine = tried
    return fits


def is_narrow(
    polynomial: Polynomial, order: Sequence[str], variables: Variables, bits: int
) -> bool:
    return horner(polynomial, order, variables, bits).widest < LIMIT - ROOM


def best_order(polynomial: Polynomial) -> tuple[str, ...]:
    """Of the variables: that with the fewest steps; of many, those first that most terms have."""
    names = polynomial.names
    if len(names) > MANY:
        held = [{name for name, _ in monomial} for monomial, _ in polynomial.terms]
        return tuple(sorted(names, key=lambda name: -sum(name in one for one in held)))
    orders = permutations(names)
    return min(orders, key=lambda order: step_count(polynomial, order))


def step_count(polynomial: Polynomial, order: Sequence[str]) -> int:
    name = next((one for one in order if one in polynomial.names), None)
    if name is None:
        return 0
    parts = polynomial.powers(name)
    return len(parts) - 1 + sum(step_count(one, order) for one in parts)


def horner(polynomial: Polynomial, order: Sequence[str], variables: Variables, bits: int) -> Form:
    if polynomial.is_constant:
        return constant_form(polynomial.value, bits)
    name = next(one for one in order if one in polynomial.names)
    *others, result = (horner(one, order, variables, bits) for one in polynomial.powers(name))
    for base in reversed(others):
        result = step(base, result, name, variables[name])
    return result


def constant_form(value: Fraction, bits: int) -> Form:
    exact = value * Fraction(2) ** bits
    integer = nearest(exact)
    off = integer - exact
    return Form(int_text(integer), bits, integer, integer, off, off, 0, abs(integer))


def step(base: Form, factor: Form, name: str, of: Variable) -> Form:
    ends = [a * b for a in (factor.least, factor.most) for b in (of.least, of.most)]
    least, most = base.least + min(ends) // ONE, base.most + max(ends) // ONE
    reach = [Fraction(end, ONE) for end in (of.least, of.most)]
    moves = [a * b for a in (factor.below, factor.above) for b in reach]
    height = max(abs(factor.least), abs(factor.most))
    own = of.error * height / ONE
    return Form(
        f"fuzzy_step({base.text}, {factor.text}, {name})", base.bits, least, most,
        base.below + min(moves) - own - 1, base.above + max(moves) + own,
        base.steps + factor.steps + 1,
        max(base.widest, factor.widest, abs(least), abs(most), ceil(Fraction(height))),
    )  # fmt: skip
