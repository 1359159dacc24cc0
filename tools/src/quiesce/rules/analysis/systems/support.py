"""Where rules of a system fire, and where they cannot: proved for cells of the inputs.

Corners and knots of an input's terms cut it into points and open intervals; in each of them every
term has its signs (signs.py). What rules make of those holds all over a cell, whatever the numbers.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.rules.analysis.coverage import Piece, Region, boxes
from quiesce.rules.analysis.systems.signs import (
    ALL,
    MAYBE,
    NO,
    NOTHING,
    YES,
    Signs,
    hedged,
    normed,
    signs_at,
    signs_between,
    weighted,
)
from quiesce.rules.model import AND
from quiesce.rules.system.model import (
    Complement,
    Conclusion,
    Expression,
    Proposition,
    SetTerm,
    System,
    SystemInput,
    SystemRule,
    ValueTerm,
)
from quiesce.rules.system.norms import ANY

MAX_CELLS = 1 << 17


@dataclass(frozen=True)
class CutAxis:
    """An input in pieces; signs: of each term, [piece]."""

    pieces: tuple[Piece, ...]
    signs: tuple[Signs, ...]


@dataclass(frozen=True)
class Fires:
    """Signs of what they are above 0: [cell, ...] of each output's strongest rule, of each rule."""

    outputs: tuple[np.ndarray, ...]
    rules: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class Support:
    """is_whole: from the product of all inputs' pieces, else from each input's alone. uncovered:
    boxes in which no rule of an output fires, disjoint where is_whole; covered: whether one fires
    everywhere; silent: rules that fire nowhere; empty: (input, term) that are 0 everywhere."""

    is_whole: bool
    cells: int
    uncovered: tuple[tuple[Region, ...], ...]
    covered: tuple[bool, ...]
    silent: frozenset[int]
    empty: tuple[tuple[int, int], ...]


# ---- rules --------------------------------------------------------------------------------------


def fires(system: System, terms: Sequence[Sequence[Signs]]) -> Fires:
    """terms: of each input's terms, in shapes that numpy broadcasts together."""
    concluded: dict[tuple[int, int], list[Signs]] = {}
    outputs: list[np.ndarray] = [np.array(NO) for _ in system.outputs]
    rules = []
    for rule in system.rules:
        strength = weighted(rule.weight, signs_of(system, rule, rule.expression, terms, concluded))
        rules.append(strength.above_0)
        for one in rule.conclusions:
            found = conclusion_signs(one, strength)
            concluded.setdefault((one.output, one.term), []).append(found)
            outputs[one.output] = np.maximum(outputs[one.output], found.above_0)
    return Fires(tuple(outputs), tuple(rules))


def conclusion_signs(one: Conclusion, strength: Signs) -> Signs:
    found = strength
    for hedge in one.hedges:
        found = hedged(hedge, found)
    return Signs(np.minimum(strength.above_0, found.above_0), found.below_1)


def signs_of(
    system: System, rule: SystemRule, expression: Expression, terms: Sequence, concluded: dict
) -> Signs:
    if isinstance(expression, Complement):
        return signs_of(system, rule, expression.part, terms, concluded).opposite()
    if isinstance(expression, Proposition):
        return proposed(system, expression, terms, concluded)
    block = system.blocks[rule.block]
    norm = block.conjunction if expression.connective == AND else block.disjunction
    first, *rest = (signs_of(system, rule, one, terms, concluded) for one in expression.parts)
    for other in rest:
        first = normed(norm, first, other)
    return first


def proposed(system: System, one: Proposition, terms: Sequence, concluded: dict) -> Signs:
    if ANY in one.hedges:
        found = ALL
    elif one.is_input:
        found = terms[one.variable][one.term]
    else:
        found = NOTHING
        for other in concluded.get((one.variable, one.term), []):
            found = normed(system.outputs[one.variable].aggregation, found, other)
    for hedge in reversed(one.hedges):
        found = found if hedge == ANY else hedged(hedge, found)
    return found


def fires_at(system: System, x: Sequence[np.ndarray]) -> Fires:
    """x: [point] of each input, within its universe."""
    terms = [
        [signs_at(term.curve, values) for term in one.terms]
        for one, values in zip(system.inputs, x, strict=True)
    ]
    return fires(system, terms)


# ---- cells --------------------------------------------------------------------------------------


def corners(variable: SystemInput) -> list[float]:
    """Ends of the universe, and corners and knots of the terms within it."""
    found = {variable.minimum, variable.maximum, *places_of_terms(variable.terms)}
    return sorted(float(x) for x in found if variable.minimum <= x <= variable.maximum)


def places_of_terms(terms: Sequence[SetTerm | ValueTerm]) -> list[float]:
    """Corners and knots of those that are sets."""
    curves = [term.curve for term in terms if isinstance(term, SetTerm)]
    return [x for one in curves for x in (*(x for x, _ in one.points or ()), *one.knots)]


def cut(variable: SystemInput) -> CutAxis:
    at = np.array(corners(variable))
    starts, ends = at[:-1], at[1:]
    pieces = [Piece(float(at[0]), float(at[0]))]
    for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
        pieces += [Piece(start, end), Piece(end, end)]
    signs = [
        Signs(mixed(a.above_0, b.above_0), mixed(a.below_1, b.below_1))
        for a, b in (
            (signs_at(term.curve, at), signs_between(term.curve, starts, ends))
            for term in variable.terms
        )
    ]
    return merged(pieces, signs)


def mixed(at: np.ndarray, between: np.ndarray) -> np.ndarray:
    """Points and the intervals behind them by turns."""
    out = np.empty(len(at) + len(between), dtype=np.int8)
    out[::2], out[1::2] = at, between
    return out


def merged(pieces: Sequence[Piece], signs: Sequence[Signs]) -> CutAxis:
    """Neighbours with the same signs become one piece."""
    rows = [part for one in signs for part in (one.above_0, one.below_1)]
    table = np.array(rows, dtype=np.int8).reshape(len(rows), len(pieces))
    firsts = [k for k in range(len(pieces)) if k == 0 or (table[:, k] != table[:, k - 1]).any()]
    lasts = [*(k - 1 for k in firsts[1:]), len(pieces) - 1]
    kept = tuple(Piece(pieces[a].start, pieces[b].end) for a, b in zip(firsts, lasts, strict=True))
    return CutAxis(kept, tuple(Signs(one.above_0[firsts], one.below_1[firsts]) for one in signs))


def collapsed(axis: CutAxis) -> CutAxis:
    """As one piece: certain is only what is so all over it."""

    def one(signs: np.ndarray) -> np.ndarray:
        return np.array([signs[0] if (signs == signs[0]).all() else MAYBE], dtype=np.int8)

    whole = Piece(axis.pieces[0].start, axis.pieces[-1].end)
    return CutAxis((whole,), tuple(Signs(one(s.above_0), one(s.below_1)) for s in axis.signs))


def cells_of(axes: Sequence[CutAxis]) -> int:
    return int(np.prod([float(len(axis.pieces)) for axis in axes]))


def fires_in_cells(system: System, axes: Sequence[CutAxis]) -> Fires:
    """Each of the product of the pieces: [piece of input 0, piece of input 1, ...]."""
    terms = []
    for i, axis in enumerate(axes):
        shape = [1] * len(axes)
        shape[i] = -1
        terms.append(
            [Signs(s.above_0.reshape(shape), s.below_1.reshape(shape)) for s in axis.signs]
        )
    return fires(system, terms)


def support(system: System) -> Support:
    axes = [cut(variable) for variable in system.inputs]
    is_whole = cells_of(axes) <= MAX_CELLS
    grids = [axes] if is_whole else one_by_one(axes)
    uncovered: list[list[Region]] = [[] for _ in system.outputs]
    covered = [False] * len(system.outputs)
    silent: set[int] = set()
    for grid in grids:
        shape = [len(axis.pieces) for axis in grid]
        found = fires_in_cells(system, grid)
        silent |= {i for i, above in enumerate(found.rules) if (above == NO).all()}
        for i, above in enumerate(found.outputs):
            cells = np.broadcast_to(above, shape)
            uncovered[i] += boxes(system, cells == NO, grid)
            covered[i] |= bool((cells == YES).all())
    empty = tuple(
        (i, k)
        for i, axis in enumerate(axes)
        for k, one in enumerate(axis.signs)
        if (one.above_0 == NO).all()
    )
    return Support(
        is_whole, sum(map(cells_of, grids)), tuple(map(tuple, uncovered)), tuple(covered),
        frozenset(silent), empty,
    )  # fmt: skip


def one_by_one(axes: Sequence[CutAxis]) -> list[list[CutAxis]]:
    """A grid for each input, the others in one piece."""
    wide = [collapsed(axis) for axis in axes]
    return [[*wide[:i], axis, *wide[i + 1 :]] for i, axis in enumerate(axes)]
