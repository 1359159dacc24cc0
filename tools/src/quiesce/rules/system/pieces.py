"""A curve over integers in pieces: straight lines, or polynomials of third degree.

A piece holds for n in first .. last and is, with t = (n - first) << shift in Q31,

    value Q30 = c0 + t (c1 + t (c2 + t c3)),  c0 Q30, the others Q24, each product rounded down

and then limited to 0 .. 2^30. Its value at every integer is within the tolerance of the curve's.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.rules.system.model import Curve

ONE_q30 = 1 << 30
MAX_SLOPE_q24 = 1 << 29
SAMPLES = 257  # of a piece, at which its error is taken; all of them where there are fewer
GRID = 1 << 16  # and of the whole curve: every integer, where there are no more
MAX_PIECES = 255
NODES = np.cos(np.pi * (2 * np.arange(4) + 1) / 8)  # Chebyshev's, of four points


class PieceError(Exception):
    """A curve that no pieces can follow; says why."""


@dataclass(frozen=True)
class Piece:
    """Both ends inclusive."""

    first: int
    last: int
    shift: int
    coefficients: tuple[int, ...]  # c0, c1, or c0 .. c3

    def values_q30(self, n: np.ndarray) -> np.ndarray:
        """As the firmware computes them."""
        t = (n.astype(np.int64) - self.first) << self.shift
        c = [*self.coefficients, 0, 0][:4]
        bent = ((c[2] + ((c[3] * t) >> 31)) * t) >> 31
        return np.clip(c[0] + (((c[1] + bent) * t) >> 25), 0, ONE_q30)


@dataclass(frozen=True)
class Pieces:
    """In rising order; error: the largest of a value, 0 .. 1."""

    degree: int
    pieces: tuple[Piece, ...]
    error: float

    def values_q30(self, n: np.ndarray) -> np.ndarray:
        out = np.zeros(n.shape, dtype=np.int64)
        left = np.ones(n.shape, dtype=bool)
        for piece in self.pieces:
            own = left & (n <= piece.last) if piece is not self.pieces[-1] else left
            out[own] = piece.values_q30(n[own])
            left &= ~own
        return out


def shift_for(length: int) -> int:
    """So that length << shift is just below 2^31."""
    return 31 - max(1, length).bit_length() if length < 1 << 31 else 0


def pieces_of(
    curve: Curve, position: Callable, x_at: Callable, low: int, high: int, tolerance: float
) -> Pieces:
    """position: from the curve's x to integers, real; x_at: back; low .. high: those that count;
    tolerance: of a smooth curve's value, of 1.

    PieceError for a curve that is not finite, or steeper than the pieces can be.
    """
    if curve.points is not None:
        return lines_of(curve, position, x_at, low, high)
    return cubics_of(curve, position, x_at, low, high, tolerance)


def lines_of(curve: Curve, position: Callable, x_at: Callable, low: int, high: int) -> Pieces:
    assert curve.points is not None
    ends = [(float(position(x)), mu) for x, mu in curve.points]
    made: list[Piece] = []
    start = low
    for n, last_value, slope in spans_of(ends, low, high):
        if n >= start:
            made.append(line_piece(start, n, last_value, slope))
            start = n + 1
    pieces = merged(made)
    return Pieces(1, pieces, error_of(curve, x_at, pieces, low, high))


def spans_of(ends: Sequence[tuple[float, float]], low: int, high: int) -> list:
    """(last integer, (place, value) on the line, slope) of each stretch, in order."""
    spans = [(below(ends[0][0], high), ends[0], 0.0)]
    for (a, mu_a), (b, mu_b) in zip(ends, ends[1:], strict=False):
        if a == b:
            # The greater value holds at the edge itself.
            at = math.floor(a)
            if at == a and low <= at <= high:
                spans.append((at, (a, max(mu_a, mu_b)), 0.0))
            continue
        spans.append((below(b, high), (a, mu_a), (mu_b - mu_a) / (b - a)))
    spans.append((high, ends[-1], 0.0))
    return spans


def below(place: float, high: int) -> int:
    """The last integer before it."""
    return min(math.ceil(place) - 1, high) if math.isfinite(place) else high


def line_piece(start: int, last: int, on: tuple[float, float], slope: float) -> Piece:
    shift = shift_for(last - start)
    at = on[1] + slope * (start - on[0])
    c1 = round(slope * 2.0 ** (31 - shift) * 2.0**24) if last > start else 0
    if abs(c1) > MAX_SLOPE_q24:
        raise PieceError("too steep for its integers")
    return Piece(start, last, shift, (round(min(max(at, 0.0), 1.0) * ONE_q30), c1))


def merged(pieces: Sequence[Piece]) -> tuple[Piece, ...]:
    """Neighbours that stay at the same value become one."""
    out: list[Piece] = []
    for piece in pieces:
        before = out[-1] if out else None
        if (
            before is not None
            and before.coefficients[1] == piece.coefficients[1] == 0
            and (before.coefficients[0] == piece.coefficients[0])
        ):
            shift = shift_for(piece.last - before.first)
            out[-1] = Piece(before.first, piece.last, shift, before.coefficients)
        else:
            out.append(piece)
    return tuple(out)


def cubics_of(
    curve: Curve, position: Callable, x_at: Callable, low: int, high: int, tolerance: float
) -> Pieces:
    cuts = sorted({min(max(math.floor(float(position(k))), low - 1), high) for k in curve.knots})
    stretches = zip([low - 1, *cuts], [*cuts, high], strict=True)
    target = Target(curve, x_at, low, high, tolerance)
    pieces: list[Piece] = []
    for before, last in stretches:
        start = before + 1
        while start <= last:
            piece = longest(target, start, last)
            pieces.append(piece)
            start = piece.last + 1
            if len(pieces) > MAX_PIECES:
                raise PieceError(f"more than {MAX_PIECES} pieces")
    made = tuple(pieces)
    return Pieces(3, made, target.error_of(made))


class Target:
    """What pieces must follow: a curve, known on a grid over all that counts, and anywhere."""

    def __init__(self, curve: Curve, x_at: Callable, low: int, high: int, tolerance: float) -> None:
        self.curve, self.x_at, self.tolerance = curve, x_at, tolerance
        self.grid = spread(low, high, GRID)
        values = self.at(self.grid)
        if values is None:
            raise PieceError("not a number everywhere")
        self.values = values

    def at(self, n: np.ndarray) -> np.ndarray | None:
        return values_at(self.curve, self.x_at, n)

    def error(self, piece: Piece) -> float | None:
        """The largest, at the grid's integers in the piece and at SAMPLES of its own."""
        inside = slice(*np.searchsorted(self.grid, [piece.first, piece.last + 1]))
        own = spread(piece.first, piece.last, SAMPLES)
        wanted = self.at(own)
        if wanted is None:
            return None
        n = np.concatenate([self.grid[inside], own])
        off = piece.values_q30(n) / ONE_q30 - np.concatenate([self.values[inside], wanted])
        return float(np.abs(off).max())

    def error_of(self, pieces: Sequence[Piece]) -> float:
        return max(self.error(piece) or 0.0 for piece in pieces)


def longest(target: Target, start: int, last: int) -> Piece:
    """From start as far as one polynomial is good enough, by halving."""
    good = fitted(target, start, start)
    if good is None:
        raise PieceError("not a number everywhere")
    most, least = last, start
    while least < most:
        end = most if most == last and least == start else (least + most + 1) // 2
        found = fitted(target, start, end)
        if found is not None:
            good, least = found, end
        else:
            most = end - 1
    return good


def fitted(target: Target, first: int, last: int) -> Piece | None:
    """None where the error is above the tolerance, or a coefficient too large."""
    length = last - first
    shift = shift_for(length)
    places = np.arange(first, last + 1) if length < 4 else first + 0.5 * length * (1.0 + NODES)
    values = target.at(places)
    if values is None:
        return None
    coefficients = through(places - first, values, shift)
    if max(map(abs, coefficients[1:])) > MAX_SLOPE_q24:
        return None
    piece = Piece(first, last, shift, coefficients)
    error = target.error(piece)
    return piece if error is not None and error <= target.tolerance else None


def spread(first: int, last: int, most: int) -> np.ndarray:
    """Integers first .. last: all, or so many."""
    if last - first < most:
        return np.arange(first, last + 1)
    return np.unique(np.rint(np.linspace(first, last, most + 1)).astype(np.int64))


def values_at(curve: Curve, x_at: Callable, n: np.ndarray) -> np.ndarray | None:
    with np.errstate(all="ignore"):
        values = np.asarray(curve.function(x_at(n)), dtype=float)
    return np.clip(values, 0.0, 1.0) if np.all(np.isfinite(values)) else None


def through(distance: np.ndarray, values: np.ndarray, shift: int) -> tuple[int, ...]:
    """The polynomial through up to four points, in the firmware's formats."""
    t = [float(one) * 2.0 ** (shift - 31) for one in distance]
    # Newton's divided differences, in plain arithmetic: the same words on every machine.
    divided = [float(one) for one in values]
    for order in range(1, len(t)):
        for i in range(len(t) - 1, order - 1, -1):
            divided[i] = (divided[i] - divided[i - 1]) / (t[i] - t[i - order])
    c = [0.0] * 4
    for at, one in zip(reversed(t), reversed(divided), strict=True):
        c = [one - at * c[0], *(c[k - 1] - at * c[k] for k in range(1, 4))]
    return (round(c[0] * ONE_q30), *(round(k * 2.0**24) for k in c[1:]))


def error_of(curve: Curve, x_at: Callable, pieces: Sequence[Piece], low: int, high: int) -> float:
    """The largest, at each piece's samples."""
    worst = 0.0
    for piece in pieces:
        n = spread(max(piece.first, low), min(piece.last, high), SAMPLES)
        wanted = values_at(curve, x_at, n)
        if wanted is None:
            raise PieceError("not a number everywhere")
        worst = max(worst, float(np.abs(piece.values_q30(n) / ONE_q30 - wanted).max()))
    return worst
