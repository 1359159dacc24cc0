"""Areas and moments of clipped output sets, in closed form.

A set is cut into layers of its height in which both of its flanks are straight. Over a layer that
starts at height t0 the width is W - S t and the middle m0 + m1 t, t counted from t0; filled up to
t = beta the layer has

    area(beta)   = beta * w          w = W - beta S / 2
    moment(beta) = beta * (m0 w + beta (m1 W / 2 - beta m1 S / 3))

Sets are in order: of any two at any height, neither flank of the later one lies left of the
earlier one's. The union of intervals in such an order is their sum less the overlaps of those that
follow one another, so that the aggregated set is

    sum over terms k of filled(k, beta_k)
      - sum over pairs k < l of filled(overlap of k and l, min(beta_k, beta_l))
                              - filled(overlap of k and l, the same or less, max beta between them)

exactly, whatever overlaps whatever: no sampling, no crossing points.

Sets in any other arrangement (one inside another, with a dip) are stacked: the universe is cut into
stretches where sets begin, end, bend or cross. In a stretch, from the highest set down, each adds
the layers between the greatest strength above it and its own.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import combinations, pairwise

from quiesce.base.errors import UsageError
from quiesce.rules.integers.cells import exact, nearest
from quiesce.rules.model import FuzzySet, Output

Line = tuple[Fraction, Fraction]  # value at the start, slope
MIN_AREA = Fraction(1, 1024)  # of a set
MAX_STEEP = 20


@dataclass(frozen=True)
class Layer:
    """All positions as shares of the output's span, 0..1."""

    start: Fraction  # heights, 0..1
    end: Fraction
    left: Line
    right: Line

    @property
    def width(self) -> Line:
        return self.right[0] - self.left[0], self.left[1] - self.right[1]

    @property
    def middle(self) -> Line:
        return (self.left[0] + self.right[0]) / 2, (self.left[1] + self.right[1]) / 2


@dataclass(frozen=True)
class Shape:
    """One term, or the overlap of two (first < second)."""

    first: int  # indices into OutputShapes.order
    second: int
    layers: tuple[Layer, ...]

    def area(self, beta: Fraction) -> Fraction:
        """Filled up to beta, as a share of the span."""
        total = Fraction(0)
        for layer in self.layers:
            filled = max(Fraction(0), min(beta, layer.end) - layer.start)
            width, narrowing = layer.width
            total += filled * (width - filled * narrowing / 2)
        return total


@dataclass(frozen=True)
class OutputShapes:
    order: tuple[int, ...]  # the output's terms from left to right
    shapes: tuple[Shape, ...]  # every term, then every pair that overlaps; none where stacked
    stretches: tuple[tuple[Shape, ...], ...] = ()  # where stacked: the highest set of each first
    peaks: tuple[Fraction, ...] = ()  # of the terms in order
    not_ordered: str = ""  # why they are stacked

    @property
    def terms(self) -> tuple[Shape, ...]:
        return self.shapes[: len(self.order)]


class NotOrdered(Exception):
    """Why sets do not follow one another; one line."""


class Flanks:
    """Left and right edge of a unimodal set at any height."""

    def __init__(self, output: Output, fuzzy_set: FuzzySet, low: Fraction, span: Fraction) -> None:
        self._name = f"output set {output.name}.{fuzzy_set.name}"
        self.points = clipped(output, fuzzy_set, low, span)
        heights = [mu for _, mu in self.points]
        self.peak = max(heights)
        top = heights.index(self.peak)
        self._rise = self.points[: top + 1]
        last_top = len(heights) - 1 - heights[::-1].index(self.peak)
        self._fall = self.points[last_top:]
        flat = heights[top : last_top + 1]
        if (
            not (rises(heights[: top + 1]) and rises(heights[last_top:][::-1]))
            or min(flat) < self.peak
        ):
            raise NotOrdered(f"{self._name} has a dip")
        self.levels = sorted({Fraction(0), *heights})

    def left(self, height: Fraction) -> Fraction:
        return crossing(self._rise, height)

    def right(self, height: Fraction) -> Fraction:
        return crossing(self._fall[::-1], height)


def rises(values: list[Fraction]) -> bool:
    return all(b >= a for a, b in pairwise(values))


def crossing(flank: list[tuple[Fraction, Fraction]], height: Fraction) -> Fraction:
    """Where a flank, walked from its foot, first reaches a height."""
    x0, mu0 = flank[0]
    if mu0 >= height:
        return x0
    for x1, mu1 in flank[1:]:
        if mu1 >= height:
            return x0 + (x1 - x0) * (height - mu0) / (mu1 - mu0)
        x0, mu0 = x1, mu1
    raise AssertionError("above the set's top")


def clipped(
    output: Output, fuzzy_set: FuzzySet, low: Fraction, span: Fraction
) -> list[tuple[Fraction, Fraction]]:
    """The set's points inside the universe, its ends included, x as shares of the span."""
    ends = exact(output.minimum), exact(output.maximum)
    points = [(exact(x), exact(mu)) for x, mu in fuzzy_set.points]
    points = [(min(ends[0], points[0][0]) - 1, points[0][1]), *points]
    points.append((max(ends[1], points[-1][0]) + 1, points[-1][1]))
    out: list[tuple[Fraction, Fraction]] = []
    for (x0, mu0), (x1, mu1) in pairwise(points):
        if x1 < ends[0] or x0 > ends[1]:
            continue
        for x in (max(x0, ends[0]), min(x1, ends[1])):
            mu = mu0 if x == x0 else mu1 if x == x1 else mu0 + (mu1 - mu0) * (x - x0) / (x1 - x0)
            point = ((x - low) / span, mu)
            if not out or out[-1] != point:
                out.append(point)
    return out


def line(at: Fraction, end: Fraction, function: Callable[[Fraction], Fraction]) -> Line:
    """The straight line through a function inside (at, end): value at `at`, slope."""
    near, far = at + (end - at) / 3, end - (end - at) / 3
    slope = (function(far) - function(near)) / (far - near)
    return function(near) - slope * (near - at), slope


def layers_of(
    left: Callable[[Fraction], Fraction],
    right: Callable[[Fraction], Fraction],
    levels: list[Fraction],
) -> tuple[Layer, ...]:
    """Layers between levels, cut where the width becomes 0, those without area left out."""
    out = []
    for start, end in pairwise(levels):
        layer = Layer(start, end, line(start, end, left), line(start, end, right))
        width, slope = layer.width
        if width <= 0:
            continue
        if width - slope * (end - start) < 0:
            layer = Layer(start, start + width / slope, layer.left, layer.right)
        out.append(layer)
    return tuple(out)


def levels_below(peak: Fraction, *sets: Flanks) -> list[Fraction]:
    return sorted({level for one in sets for level in one.levels if level < peak} | {peak})


def make_shapes(output: Output, low: Fraction, span: Fraction) -> OutputShapes:
    """Of an output with sets. UsageError names a set that has no area to speak of."""
    for term in output.terms:
        require_area(output, term, low, span)
    try:
        return ordered_shapes(output, low, span)
    except NotOrdered as reason:
        return stacked_shapes(output, low, span, str(reason))


def require_area(output: Output, term: FuzzySet, low: Fraction, span: Fraction) -> None:
    points = clipped(output, term, low, span)
    area = sum((x1 - x0) * (y0 + y1) / 2 for (x0, y0), (x1, y1) in pairwise(points))
    if area < MIN_AREA:
        raise UsageError(
            f"output set {output.name}.{term.name} has less than 1/{1 / MIN_AREA} of the area of "
            "its output's universe"
        )


def ordered_shapes(output: Output, low: Fraction, span: Fraction) -> OutputShapes:
    flanks = [Flanks(output, term, low, span) for term in output.terms]

    def place(index: int) -> tuple[Fraction, ...]:
        one = flanks[index]
        middle = one.peak / 2
        return (one.left(middle) + one.right(middle), one.left(one.peak) + one.right(one.peak))

    order = sorted(range(len(flanks)), key=place)
    shapes = []
    for rank, index in enumerate(order):
        one = flanks[index]
        layers = layers_of(one.left, one.right, levels_below(one.peak, one))
        shapes.append(Shape(rank, rank, layers))
    for (i, first), (j, second) in combinations(enumerate(order), 2):
        one, other = flanks[first], flanks[second]
        levels = levels_below(min(one.peak, other.peak), one, other)
        layers = layers_of(other.left, one.right, levels)
        if layers:
            require_order(output, (first, second), one, other, levels)
            shapes.append(Shape(i, j, layers))
    peaks = tuple(flanks[index].peak for index in order)
    return OutputShapes(tuple(order), tuple(shapes), peaks=peaks)


def require_order(
    output: Output, pair: tuple[int, int], one: Flanks, other: Flanks, levels: list[Fraction]
) -> None:
    for start, end in pairwise(levels):
        for flank, following in ((one.left, other.left), (one.right, other.right)):
            if is_ever_above(line(start, end, flank), line(start, end, following), end - start):
                names = " and ".join(output.terms[index].name for index in pair)
                reason = f"of sets {names} of output {output.name} one lies inside the other"
                raise NotOrdered(reason)


def is_ever_above(one: Line, other: Line, length: Fraction) -> bool:
    """Whether `one` exceeds `other` at either end: between the ends both are straight."""
    start, slope = one[0] - other[0], one[1] - other[1]
    return start > 0 or start + slope * length > 0


def stacked_shapes(output: Output, low: Fraction, span: Fraction, reason: str) -> OutputShapes:
    curves = [clipped(output, term, low, span) for term in output.terms]
    ends = sorted({x for points in curves for x, _ in points})
    stretches = []
    for start, end in pairwise(ends):
        lines = [line(start, end, partial(height_at, points)) for points in curves]
        cuts = sorted({start, end, *crossings(lines, start, end)})
        for left, right in pairwise(cuts):
            stretches.append(stretch(lines, start, left, right))
    order = tuple(range(len(output.terms)))
    peaks = tuple(max(mu for _, mu in points) for points in curves)
    filled = tuple(one for one in stretches if one)
    return OutputShapes(order, (), filled, peaks, reason)


def height_at(points: Sequence[tuple[Fraction, Fraction]], x: Fraction) -> Fraction:
    """Between two neighbouring points; x is none of them."""
    for (x0, y0), (x1, y1) in pairwise(points):
        if x0 < x < x1:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    raise AssertionError("beyond the curve")


def crossings(lines: Sequence[Line], start: Fraction, end: Fraction) -> list[Fraction]:
    found = []
    for (a, slope_a), (b, slope_b) in combinations(lines, 2):
        if slope_a != slope_b:
            at = start + (b - a) / (slope_a - slope_b)
            if start < at < end:
                found.append(at)
    return found


def stretch(
    lines: Sequence[Line], origin: Fraction, left: Fraction, right: Fraction
) -> tuple[Shape, ...]:
    """Sets that are not 0 in it, the highest first."""

    def heights(index: int) -> tuple[Fraction, Fraction]:
        value, slope = lines[index]
        return value + slope * (left - origin), value + slope * (right - origin)

    above = [index for index in range(len(lines)) if sum(heights(index)) > 0]
    above.sort(key=lambda index: -sum(heights(index)))
    return tuple(Shape(i, i, column_layers(left, right, *heights(i))) for i in above)


def column_layers(
    left: Fraction, right: Fraction, at_left: Fraction, at_right: Fraction
) -> tuple[Layer, ...]:
    """Below a straight line from (left, at_left) to (right, at_right)."""
    low, high = sorted((at_left, at_right))
    layers = []
    still = Fraction(0)
    if low > 0:
        layers.append(Layer(still, low, (left, still), (right, still)))
    if high > low:
        pace = (right - left) / (high - low)
        falls = at_left > at_right
        flanks = ((left, still), (right, -pace)) if falls else ((left, pace), (right, still))
        layers.append(Layer(low, high, *flanks))
    return tuple(layers)


@dataclass(frozen=True)
class LayerIntegers:
    start: int  # 2^-bits
    height: int
    flanks: tuple[int, ...]  # fuzzy_flanks_t
    is_skewed_left: bool
    steep: int


def layer_integers(layer: Layer, bits: int) -> LayerIntegers:
    """Flanks over little height narrow by more than their formats hold: then 2^-steep of it."""
    one = 1 << bits
    width, narrowing = layer.width
    m0, m1 = layer.middle
    start, end = nearest(layer.start * one), nearest(layer.end * one)
    slopes = (
        (narrowing / 2, 28),
        (abs(m1) * width / 2, 27),
        (abs(m1) * narrowing / 3, 29),
    )
    most = max(value * 2**q for value, q in slopes)
    steep = max(0, nearest(most).bit_length() - 32)
    if steep > MAX_STEEP:
        # So low that it holds less than a count's worth of area.
        return LayerIntegers(start, 0, (0, 0, 0, 0, 0), False, 0)
    turn, skew, skew_turn = (nearest(value * 2**q / 2**steep) for value, q in slopes)
    flanks = (nearest(width * 2**26), turn, nearest(m0 * 2**31), skew, skew_turn)
    return LayerIntegers(start, end - start, flanks, m1 < 0, steep)
