"""Cells of an input: where all its memberships are straight lines, in integers.

An input is an int32 n; x = n * lsb + origin. The int32 range is cut into cells; in a cell a set's
membership is, exactly,

    mu = (a + b * ((n - first) << shift)) >> 32        64 bit, floor; 0 <= mu <= 2^bits

which is the real one rounded to nearest, within 5/8 of its unit 2^-bits. A pair of sets that adds
up to 1 adds up to 2^bits exactly. Beyond the universe the memberships of its ends hold, so that
nothing clamps at run time.
"""

from dataclasses import dataclass
from fractions import Fraction

from quiesce.rules.model import FuzzySet, Input

INT32_MIN, INT32_MAX = -(2**31), 2**31 - 1
HALF = 1 << 31


def exact(x: float) -> Fraction:
    """The decimal number that a float was written as: 0.05 is one twentieth."""
    return Fraction(repr(float(x)))


@dataclass(frozen=True)
class Ramp:
    """Membership of one set in one cell."""

    set: int
    a: int  # int64
    b: int  # int32

    def membership(self, offset: int, shift: int) -> int:
        return (self.a + self.b * (offset << shift)) >> 32


@dataclass(frozen=True)
class Cell:
    first: int  # int32, both inclusive
    last: int
    shift: int  # 0..31; (last - first) << shift < 2^31 where a ramp has a slope
    ramps: tuple[Ramp, ...]  # sets that are not 0 all over the cell, by index

    def memberships(self, n: int) -> dict[int, int]:
        offset = n - self.first
        return {ramp.set: ramp.membership(offset, self.shift) for ramp in self.ramps}


@dataclass(frozen=True)
class Axis:
    """Exact real line below an integer input: x = origin + n * lsb."""

    origin: Fraction
    lsb: Fraction

    def position(self, x: float) -> Fraction:
        """Of x, in integers n; not rounded."""
        return (exact(x) - self.origin) / self.lsb


def exact_membership(fuzzy_set: FuzzySet, x: Fraction) -> Fraction:
    """model.FuzzySet.membership without rounding."""
    points = [(exact(at), exact(mu)) for at, mu in fuzzy_set.points]
    if x < points[0][0]:
        return points[0][1]
    if x > points[-1][0]:
        return points[-1][1]
    at_x = [mu for at, mu in points if at == x]
    if at_x:
        return max(at_x)
    after = next(i for i, (at, _) in enumerate(points) if at > x)
    (x0, mu0), (x1, mu1) = points[after - 1], points[after]
    return mu0 + (mu1 - mu0) * (x - x0) / (x1 - x0)


def make_cells(variable: Input, axis: Axis, bits: int) -> tuple[Cell, ...]:
    """Cells that cover int32. The axis must hold the universe inside int32."""
    low = ceil(axis.position(variable.minimum))
    high = floor(axis.position(variable.maximum))
    spans = integer_spans(variable, axis, low, high)
    cells = [make_cell(variable, axis, first, last, bits) for first, last in spans]
    cells = [constant_cell(variable, variable.minimum, INT32_MIN, low - 1, bits), *cells]
    cells.append(constant_cell(variable, variable.maximum, high + 1, INT32_MAX, bits))
    return merged([cell for cell in cells if cell.first <= cell.last])


def floor(x: Fraction) -> int:
    return x.numerator // x.denominator


def ceil(x: Fraction) -> int:
    return -floor(-x)


def integer_spans(variable: Input, axis: Axis, low: int, high: int) -> list[tuple[int, int]]:
    """Integers low..high cut at the breakpoints; one of its own where a vertical edge hits one."""
    edges: dict[int, bool] = {}
    for fuzzy_set in variable.sets:
        places = [x for x, _ in fuzzy_set.points]
        for x in places:
            at = axis.position(x)
            is_alone = at.denominator == 1 and places.count(x) > 1
            start = ceil(at)
            edges[start] = edges.get(start, False) or is_alone
    starts = {low}
    for start, is_alone in edges.items():
        starts |= {start, start + 1} if is_alone else {start}
    # No cell is wider than its offset's format.
    starts |= {low + (high - low) * part // 4 for part in (1, 2, 3) if high - low >= 2**30}
    inside = sorted(start for start in starts if low <= start <= high)
    return [
        (start, following - 1)
        for start, following in zip(inside, [*inside[1:], high + 1], strict=True)
    ]


def make_cell(variable: Input, axis: Axis, first: int, last: int, bits: int) -> Cell:
    width = last - first
    shift = 31 if width == 0 else min(31, 31 - width.bit_length())
    ends = []
    for fuzzy_set in variable.sets:
        values = [exact_membership(fuzzy_set, axis.origin + n * axis.lsb) for n in (first, last)]
        ends.append((values[0], values[1]))
    ramps = [
        make_ramp(index, start, end, width, shift, bits)
        for index, (start, end) in enumerate(ends)
        if start > 0 or end > 0
    ]
    if len(ramps) == 2 and all(
        sum(pair) == 1 for pair in zip(*(e for e in ends if any(e)), strict=True)
    ):
        ramps = complementary(ramps, bits)
    return Cell(first, last, shift, tuple(ramps))


def make_ramp(
    index: int, start: Fraction, end: Fraction, width: int, shift: int, bits: int
) -> Ramp:
    scale = Fraction(2) ** (bits + 32)
    slope = (end - start) / (width << shift) if width else Fraction(0)
    b = nearest(slope * scale)
    # Half of the slope's rounding error at either end.
    drift = (slope * scale - b) * (width << shift) / 2
    a = nearest(start * scale + drift) + HALF
    return Ramp(index, a, b)


def complementary(ramps: list[Ramp], bits: int) -> list[Ramp]:
    """The falling one is 2^bits minus the rising one, bit for bit."""
    rising, falling = sorted(ramps, key=lambda ramp: -ramp.b)
    mirrored = Ramp(falling.set, (1 << (bits + 32)) + (1 << 32) - 1 - rising.a, -rising.b)
    return sorted([rising, mirrored], key=lambda ramp: ramp.set)


def nearest(x: Fraction) -> int:
    return floor(x + Fraction(1, 2))


def constant_cell(variable: Input, x: float, first: int, last: int, bits: int) -> Cell:
    values = [exact_membership(fuzzy_set, exact(x)) for fuzzy_set in variable.sets]
    ramps = [
        make_ramp(index, value, value, 0, 31, bits) for index, value in enumerate(values) if value
    ]
    if len(ramps) == 2 and sum(values) == 1:
        ramps = complementary(ramps, bits)
    return Cell(first, last, 0, tuple(ramps))


def is_constant(cell: Cell) -> bool:
    return all(ramp.b == 0 for ramp in cell.ramps)


def merged(cells: list[Cell]) -> tuple[Cell, ...]:
    """Neighbours with the same constant memberships become one."""
    out: list[Cell] = []
    for cell in cells:
        previous = out[-1] if out else None
        if previous and is_constant(cell) and is_constant(previous) and same(previous, cell):
            out[-1] = Cell(previous.first, cell.last, 0, previous.ramps)
        else:
            out.append(cell)
    return tuple(out)


def same(one: Cell, other: Cell) -> bool:
    return one.ramps == other.ramps
