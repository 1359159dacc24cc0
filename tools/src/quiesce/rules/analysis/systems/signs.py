"""Three-valued signs: whether a membership is above 0, and whether it is below 1.

YES and NO are certain, of all that a cell holds; MAYBE is neither. Arrays of int8, so that "and" is
the minimum, "or" the maximum, and the opposite the negative. Rounding is none here: a Gaussian is
above 0 everywhere, though float64 runs out of numbers for it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.rules.formats.shapes import (
    FCL_SHAPES,
    FIS_SHAPES,
    FLL_SHAPES,
    arc,
    bell,
    concave,
    cosine,
    gaussian,
    pi_shape,
    s_shape,
    semi_ellipse,
    sigmoid,
    sigmoid_product,
    spike,
    two_gaussians,
    z_shape,
)
from quiesce.rules.model import Point
from quiesce.rules.system.model import Curve
from quiesce.rules.system.norms import (
    ALGEBRAIC_PRODUCT,
    MAXIMUM,
    MINIMUM,
    NOT,
    T_NORMS,
)

NO, MAYBE, YES = np.int8(-1), np.int8(0), np.int8(1)

ENDLESS = (gaussian, two_gaussians, bell, sigmoid, sigmoid_product, spike, concave)  # above 0
NEVER_ONE = (sigmoid, sigmoid_product)
# Between two neighbouring knots above 0 everywhere or nowhere; the first four only rise or fall.
STEADY = (s_shape, z_shape, pi_shape, arc)
COMPACT = (*STEADY, cosine, semi_ellipse)
# Above 0 wherever both are; and 1 only where one of them is. The others ask for more.
STRICT_T_NORMS = (MINIMUM, ALGEBRAIC_PRODUCT, "EinsteinProduct", "HamacherProduct")
STRICT_S_NORMS = (MAXIMUM, "AlgebraicSum", "EinsteinSum", "HamacherSum")


@dataclass(frozen=True)
class Signs:
    above_0: np.ndarray
    below_1: np.ndarray

    def opposite(self) -> "Signs":
        """Of 1 - membership."""
        return Signs(self.below_1, self.above_0)


NOTHING = Signs(np.array(NO), np.array(YES))
ALL = Signs(np.array(YES), np.array(NO))


def normed(norm: str, a: Signs, b: Signs) -> Signs:
    """norm: of norms.py. An S-norm is a T-norm of opposites."""
    if norm in T_NORMS:
        return conjunction(a, b, norm in STRICT_T_NORMS)
    return conjunction(a.opposite(), b.opposite(), norm in STRICT_S_NORMS).opposite()


def conjunction(a: Signs, b: Signs, is_strict: bool) -> Signs:
    """Of any T-norm: 1 where both are, 0 where one is; with 1 the other one."""
    above = np.minimum(a.above_0, b.above_0)
    if not is_strict:
        beside_one = np.maximum(
            np.minimum(-a.below_1, b.above_0), np.minimum(-b.below_1, a.above_0)
        )
        above = np.where(above == YES, np.maximum(beside_one, MAYBE), above)
    return Signs(above, np.maximum(a.below_1, b.below_1))


def hedged(hedge: str, a: Signs) -> Signs:
    """All but `not` keep 0 and 1, and nothing else becomes either."""
    return a.opposite() if hedge == NOT else a


def weighted(weight: float, a: Signs) -> Signs:
    if weight == 0.0:
        return NOTHING
    return Signs(a.above_0, np.full_like(a.below_1, YES) if weight < 1.0 else a.below_1)


# ---- of one curve -------------------------------------------------------------------------------


def makers() -> dict[str, Callable]:
    """Of every word that a file may have for a smooth shape."""
    found = {}
    for shapes in (FCL_SHAPES, FLL_SHAPES, FIS_SHAPES):
        found |= {word: shape.make for word, shape in shapes.items() if shape.is_smooth}
    return found


MAKERS = makers()


def maker_of(curve: Curve) -> Callable | None:
    """None: not known, such as a formula, or FCL's words for others."""
    return MAKERS.get(curve.word) or MAKERS.get(curve.word.upper())


def membership_at(curve: Curve, x: np.ndarray) -> np.ndarray:
    with np.errstate(all="ignore"):
        return np.clip(np.asarray(curve.function(x), dtype=float), 0.0, 1.0)


def signs_at(curve: Curve, x: np.ndarray) -> Signs:
    """At points."""
    if curve.points is not None:
        return signs_of_lines(curve.points, x)
    mu, make = membership_at(curve, x), maker_of(curve)
    above = np.where(mu > 0.0, YES, NO if make in COMPACT else MAYBE)
    below = np.where(mu < 1.0, YES, MAYBE)
    return Signs(
        np.full_like(above, YES) if make in ENDLESS else above,
        np.full_like(below, YES) if make in NEVER_ONE else below,
    )


def signs_between(curve: Curve, start: np.ndarray, end: np.ndarray) -> Signs:
    """All over open intervals in which it has no corner and no knot."""
    if curve.points is not None:
        return signs_of_lines(curve.points, start + 0.5 * (end - start))
    some = np.stack([membership_at(curve, start + k * (end - start)) for k in (0.25, 0.5, 0.75)])
    make = maker_of(curve)
    above = np.full(start.shape, YES if make in ENDLESS else MAYBE)
    below = np.full(start.shape, YES if make in NEVER_ONE else MAYBE)
    if make in COMPACT:
        above = np.where(some[1] > 0.0, YES, NO)
    if make in STEADY:
        below = np.where((some == 1.0).all(axis=0), NO, np.where(some[1] < 1.0, YES, MAYBE))
    return Signs(above, below)


def signs_of_lines(points: Sequence[Point], x: np.ndarray) -> Signs:
    """Exact: between two points it is 0, or 1, only where it is so at both."""
    at, mu = np.array(points, dtype=float).T
    greatest = np.array([mu[at == place].max() for place in at])
    found = np.searchsorted(at, x, side="right") - 1
    left, right = np.maximum(found, 0), np.minimum(found + 1, len(at) - 1)
    is_corner = (found >= 0) & (x == at[left])
    one = np.where(is_corner, greatest[left], np.where(found < 0, mu[0], mu[left]))
    other = np.where(is_corner, one, mu[right])
    return Signs(
        np.where(np.maximum(one, other) > 0.0, YES, NO),
        np.where(np.minimum(one, other) < 1.0, YES, NO),
    )
