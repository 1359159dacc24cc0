"""Strengths as they are while straight-line C is written: sums of C variables and a constant.

What is known of their order in the region at hand decides minima and maxima without a comparison
at run time.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

Named = Callable[[str], "Affine"]  # defines a C variable with this value


@dataclass(frozen=True)
class Affine:
    """offset + sum of coefficient * variable; variables are uint32_t of 0 .. 2^bits."""

    offset: int
    terms: dict[str, int] = field(default_factory=dict)

    @property
    def is_constant(self) -> bool:
        return not self.terms

    @property
    def is_zero(self) -> bool:
        return self.is_constant and self.offset == 0

    def __add__(self, other: "Affine") -> "Affine":
        terms = dict(self.terms)
        for name, factor in other.terms.items():
            terms[name] = terms.get(name, 0) + factor
        return Affine(self.offset + other.offset, {n: f for n, f in terms.items() if f})

    def __mul__(self, factor: int) -> "Affine":
        if factor == 0:
            return constant(0)
        return Affine(self.offset * factor, {n: f * factor for n, f in self.terms.items()})

    def complement(self, one: int) -> "Affine":
        return constant(one) + self * -1

    def text(self) -> str:
        """C, modulo 2^32."""
        parts = [product_text(name, factor) for name, factor in self.terms.items() if factor > 0]
        if self.offset > 0 or not (parts or self.terms):
            parts.append(f"{self.offset % 2**32}u")
        text = " + ".join(parts) or "0u"
        for name, factor in self.terms.items():
            if factor < 0:
                text += f" - {product_text(name, -factor)}"
        if self.offset < 0:
            text += f" - {-self.offset % 2**32}u"
        return text if len(self.terms) == 1 and text == next(iter(self.terms)) else f"({text})"

    def wide_text(self) -> str:
        """C, as uint64_t; the value fits 32 bits."""
        return f"(uint64_t){self.text()}"


def product_text(name: str, factor: int) -> str:
    return name if factor == 1 else f"{factor % 2**32}u * {name}"


def constant(value: int) -> Affine:
    return Affine(value)


@dataclass(frozen=True)
class Order:
    """What is known of the variables: their range, and which is the least of its region.

    With u and v of a region, one of u, 1-u, v, 1-v is the least; its complement is the greatest,
    and the other two and 1/2 lie between.
    """

    one: int
    least: tuple[str, bool] | None = None  # name, whether it is the complement
    between: str = ""  # the other variable of the region

    @classmethod
    def none(cls, one: int) -> "Order":
        return cls(one)

    @classmethod
    def region(cls, one: int, u: str, v: str, u_le_v: bool, sum_le_one: bool) -> "Order":
        if u_le_v:
            return cls(one, (u, False), v) if sum_le_one else cls(one, (v, True), u)
        return cls(one, (v, False), u) if sum_le_one else cls(one, (u, True), v)

    def rank(self, value: Affine) -> int | None:
        """0 the least, 1 between, 2 the greatest of the region; -1 zero, 3 one; None unknown."""
        if value.is_constant:
            known = {0: -1, self.one // 2: 1, self.one: 3}
            return known.get(value.offset)
        if self.least is None or len(value.terms) != 1:
            return None
        (name, factor), is_complement = next(iter(value.terms.items())), value.offset == self.one
        if (factor, value.offset) not in ((1, 0), (-1, self.one)):
            return None
        if name == self.least[0]:
            return 0 if is_complement == self.least[1] else 2
        return 1 if name == self.between else None

    def is_less(self, a: Affine, b: Affine) -> bool | None:
        """Whether a <= b everywhere in the region, or b <= a (False); None: not known."""
        if a == b:
            return True
        if a.is_constant and b.is_constant:
            return a.offset <= b.offset
        for low, high, answer in ((a, b, True), (b, a, False)):
            if low.is_zero or (high.is_constant and high.offset >= self.one):
                return answer
        ranks = self.rank(a), self.rank(b)
        if None in ranks or ranks[0] == ranks[1]:
            return None
        return ranks[0] < ranks[1]

    def corners(self) -> list[dict[str, int]] | None:
        """Of the region: the affine functions take their extremes there."""
        if self.least is None:
            return None
        name, is_complement = self.least
        edge, half = self.one if is_complement else 0, self.one // 2
        return [
            {name: edge, self.between: 0},
            {name: edge, self.between: self.one},
            {name: half, self.between: half},
        ]

    def bounds(self, value: Affine) -> tuple[int, int]:
        corners = self.corners()
        if corners is not None and all(name in corners[0] for name in value.terms):
            found = [
                value.offset + sum(f * corner[name] for name, f in value.terms.items())
                for corner in corners
            ]
            return min(found), max(found)
        low = high = value.offset
        for factor in value.terms.values():
            low += min(0, factor * self.one)
            high += max(0, factor * self.one)
        return low, high

    def upper_bound(self, value: Affine) -> int:
        return self.bounds(value)[1]

    def lower_bound(self, value: Affine) -> int:
        return self.bounds(value)[0]


def minimum(values: Sequence[Affine], order: Order, named: Named) -> Affine:
    return extreme(values, order, named, "fuzzy_min", True)


def maximum(values: Sequence[Affine], order: Order, named: Named) -> Affine:
    return extreme(values, order, named, "fuzzy_max", False)


def extreme(
    values: Sequence[Affine], order: Order, named: Named, function: str, wants_less: bool
) -> Affine:
    kept: list[Affine] = []
    for value in values:
        if value in kept:
            continue
        kept = [other for other in kept if order.is_less(value, other) is not wants_less]
        if not any(order.is_less(other, value) is wants_less for other in kept):
            kept.append(value)
    result = kept[0]
    for value in kept[1:]:
        result = named(f"{function}({result.text()}, {value.text()})")
    return result
