"""Polynomials of named variables with exact coefficients."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from itertools import product

Monomial = tuple[tuple[str, int], ...]  # name and power, by name; () for the constant
Range = tuple[Fraction, Fraction]
FEW = 4  # variables whose corners are looked at
Box = Mapping[str, Range]  # where the variables are


@dataclass(frozen=True)
class Polynomial:
    """terms: coefficients that are not 0, by monomial, in order."""

    terms: tuple[tuple[Monomial, Fraction], ...]

    @property
    def names(self) -> list[str]:
        return sorted({name for monomial, _ in self.terms for name, _ in monomial})

    @property
    def is_constant(self) -> bool:
        return not self.names

    @property
    def value(self) -> Fraction:
        """Of a constant, or at 0."""
        return dict(self.terms).get((), Fraction(0))

    def __add__(self, other: "Polynomial") -> "Polynomial":
        return collected((*self.terms, *other.terms))

    def __sub__(self, other: "Polynomial") -> "Polynomial":
        return self + other * -1

    def __mul__(self, other: "Polynomial | Fraction | int") -> "Polynomial":
        factor = other if isinstance(other, Polynomial) else constant(other)
        return collected((joined(m, n), a * b) for m, a in self.terms for n, b in factor.terms)

    def powers(self, name: str) -> list["Polynomial"]:
        """Coefficients of the powers of one variable, from 0 on."""
        found: list[list[tuple[Monomial, Fraction]]] = [[]]
        for monomial, factor in self.terms:
            power = dict(monomial).get(name, 0)
            found += [[] for _ in range(power + 1 - len(found))]
            rest = tuple(one for one in monomial if one[0] != name)
            found[power].append((rest, factor))
        return [collected(terms) for terms in found]

    def at(self, place: Mapping[str, Fraction]) -> Fraction:
        total = Fraction(0)
        for monomial, factor in self.terms:
            total += reduce(lambda x, one: x * place[one[0]] ** one[1], monomial, factor)
        return total

    def range(self, box: Box) -> Range:
        """The least and the greatest value in a box: exact for a few variables without powers
        above 1, else bounds."""
        names = self.names
        powers = [power for monomial, _ in self.terms for _, power in monomial]
        if len(names) <= FEW and max(powers, default=1) == 1:
            corners = product(*(box[name] for name in names))
            values = [self.at(dict(zip(names, corner, strict=True))) for corner in corners]
            return min(values), max(values)
        name = max(names, key=lambda one: len(self.powers(one)))
        low, high = Fraction(0), Fraction(0)
        for coefficient in reversed(self.powers(name)):
            own = coefficient.range(box)
            ends = [a * b for a in (low, high) for b in box[name]]
            low, high = min(ends) + own[0], max(ends) + own[1]
        return low, high


def collected(terms: Iterable[tuple[Monomial, Fraction]]) -> Polynomial:
    found: dict[Monomial, Fraction] = {}
    for monomial, factor in terms:
        found[monomial] = found.get(monomial, Fraction(0)) + factor
    return Polynomial(tuple(sorted((m, f) for m, f in found.items() if f)))


def joined(one: Monomial, other: Monomial) -> Monomial:
    powers = dict(one)
    for name, power in other:
        powers[name] = powers.get(name, 0) + power
    return tuple(sorted(powers.items()))


def constant(value: Fraction | int) -> Polynomial:
    return collected([((), Fraction(value))])


def variable(name: str) -> Polynomial:
    return Polynomial(((((name, 1),), Fraction(1)),))


def total(parts: Iterable[Polynomial]) -> Polynomial:
    return collected(term for part in parts for term in part.terms)
