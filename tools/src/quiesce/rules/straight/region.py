"""The part of a box that straight lines leave: of two variables, a polygon, exact."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from quiesce.rules.straight.polynomial import Box, Polynomial, Range

Corner = dict[str, Fraction]


@dataclass(frozen=True)
class Region:
    """corners: of the polygon, in order; none where the lines are of other variables than two."""

    box: Box
    corners: tuple[Corner, ...]

    def range(self, polynomial: Polynomial) -> Range:
        """Exact where the polynomial is of first degree, else bounds."""
        known = self.corners and set(polynomial.names) <= set(self.corners[0])
        if known and is_first_degree(polynomial):
            values = [polynomial.at(corner) for corner in self.corners]
            return min(values), max(values)
        return polynomial.range(self.box)


def region_of(box: Mapping[str, Range], limits: Sequence[Polynomial]) -> Region:
    """limits: of first degree, 0 or less there."""
    names = sorted({name for one in limits for name in one.names})
    if len(names) != 2:
        return Region(box, ())
    first, second = names
    corners = [
        {first: x, second: y}
        for x, y in (
            (box[first][0], box[second][0]), (box[first][1], box[second][0]),
            (box[first][1], box[second][1]), (box[first][0], box[second][1]),
        )
    ]  # fmt: skip
    for one in limits:
        corners = clipped(corners, one)
    if not corners:
        return Region(box, ())
    ends = {name: (min(c[name] for c in corners), max(c[name] for c in corners)) for name in names}
    return Region({**box, **ends}, tuple(corners))


def clipped(corners: Sequence[Corner], limit: Polynomial) -> list[Corner]:
    """Sutherland and Hodgman's."""
    found: list[Corner] = []
    for start, end in pairwise([*corners, corners[0]] if corners else []):
        at_start, at_end = limit.at(start), limit.at(end)
        if at_start <= 0:
            found.append(start)
        if at_start * at_end < 0:
            share = at_start / (at_start - at_end)
            found.append({name: x + (end[name] - x) * share for name, x in start.items()})
    return found


def is_first_degree(polynomial: Polynomial) -> bool:
    return all(sum(power for _, power in monomial) <= 1 for monomial, _ in polynomial.terms)
