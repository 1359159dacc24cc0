"""Where no rule fires, and rules that never do: exact, from the breakpoints of the sets.

Between neighbouring breakpoints a membership is a straight line, so that it is either 0 all over
the open interval or nowhere in it. Breakpoints and the intervals between them therefore cut the
inputs into cells in which each rule fires everywhere or nowhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from quiesce.rules.analysis.findings import (
    ERROR,
    UNCOVERED,
    UNREACHABLE,
    WARNING,
    Finding,
    number,
    rule_place,
)
from quiesce.rules.model import AND, Condition, FuzzySet, Input, Output, Rule, RuleBase
from quiesce.rules.reference import limits
from quiesce.rules.system.model import System, SystemInput, SystemOutput

REGIONS_TOLD = 8  # of an output


@dataclass(frozen=True)
class Piece:
    """A breakpoint (start == end), an open interval, or several in a row."""

    start: float
    end: float

    def text(self, name: str) -> str:
        if self.start == self.end:
            return f"{name} = {number(self.start)}"
        return f"{name} {number(self.start)} .. {number(self.end)}"


class HasPieces(Protocol):
    @property
    def pieces(self) -> tuple[Piece, ...]: ...


@dataclass(frozen=True)
class Axis:
    """An input cut into pieces; in each a set's membership is positive everywhere or nowhere."""

    pieces: tuple[Piece, ...]
    positive: np.ndarray  # [set, negated, piece], bool

    def of(self, condition: Condition) -> np.ndarray:
        return self.positive[condition.set, int(condition.negated)]


@dataclass(frozen=True)
class Region:
    """A box of the inputs."""

    pieces: tuple[Piece, ...]  # of each input
    share: float  # of the volume of all inputs; 0 for a point or a line

    def text(self, base: RuleBase | System) -> str:
        named = [
            piece.text(variable.name)
            for variable, piece in zip(base.inputs, self.pieces, strict=True)
            if not is_whole(variable, piece)
        ]
        return ", ".join(named) or "any input"


def is_whole(variable: Input | SystemInput, piece: Piece) -> bool:
    return (piece.start, piece.end) == (variable.minimum, variable.maximum)


def make_axis(variable: Input) -> Axis:
    breakpoints = {x for one in variable.sets for x, _ in one.points}
    breakpoints |= {variable.minimum, variable.maximum}
    inside = sorted(x for x in breakpoints if variable.minimum <= x <= variable.maximum)
    pieces = [Piece(inside[0], inside[0])]
    for start, end in zip(inside, inside[1:], strict=False):
        pieces += [Piece(start, end), Piece(end, end)]
    positive = np.array([[signs(one, piece) for piece in pieces] for one in variable.sets])
    return merged(pieces, positive.reshape(len(variable.sets), len(pieces), 2).swapaxes(1, 2))


def signs(one: FuzzySet, piece: Piece) -> tuple[bool, bool]:
    """Whether membership, and 1 - membership, are positive in the piece."""
    if piece.start == piece.end:
        mu = one.membership(piece.start)
        return mu > 0, mu < 1
    ends = limits(one, piece.start, piece.end)
    return max(ends) > 0, min(ends) < 1


def merged(pieces: Sequence[Piece], positive: np.ndarray) -> Axis:
    """Neighbours in which the same sets are positive become one piece."""
    kept: list[Piece] = []
    columns: list[int] = []
    for index, piece in enumerate(pieces):
        if columns and np.array_equal(positive[..., columns[-1]], positive[..., index]):
            last = kept[-1]
            kept[-1] = Piece(last.start, piece.end)
        else:
            kept.append(piece)
            columns.append(index)
    return Axis(tuple(kept), positive[..., columns])


def fires(rule: Rule, axes: Sequence[Axis]) -> np.ndarray:
    """Bool over the cells, one index an input; of length 1 along inputs that do not matter."""
    is_and = rule.connective == AND
    result: np.ndarray | None = None
    for condition in rule.conditions:
        shape = [1] * len(axes)
        shape[condition.input] = -1
        one = axes[condition.input].of(condition).reshape(shape)
        if result is None:
            result = one
        else:
            result = result & one if is_and else result | one
    assert result is not None
    return result & (rule.weight > 0)


def uncovered(base: RuleBase, output: int, axes: Sequence[Axis]) -> np.ndarray:
    """Bool over the cells: no rule of this output fires."""
    covered = np.zeros([len(axis.pieces) for axis in axes], dtype=bool)
    for rule in base.rules:
        if rule.conclusions[output] is not None:
            covered |= fires(rule, axes)
    return ~covered


def boxes(base: RuleBase | System, cells: np.ndarray, axes: Sequence[HasPieces]) -> list[Region]:
    """Disjoint boxes that make up the cells, largest share first."""
    left, found = cells.copy(), []
    while left.any():
        start = np.unravel_index(int(np.argmax(left)), left.shape)
        span = [slice(int(i), int(i) + 1) for i in start]
        for axis in reversed(range(left.ndim)):
            while span[axis].stop < left.shape[axis]:
                following = slice(span[axis].stop, span[axis].stop + 1)
                if not left[(*span[:axis], following, *span[axis + 1 :])].all():
                    break
                span[axis] = slice(span[axis].start, following.stop)
        left[tuple(span)] = False
        found.append(region_of(base, span, axes))
    return sorted(found, key=lambda region: -region.share)


def region_of(base: RuleBase | System, span: Sequence[slice], axes: Sequence[HasPieces]) -> Region:
    pieces, share = [], 1.0
    for variable, axis, part in zip(base.inputs, axes, span, strict=True):
        first, last = axis.pieces[part.start], axis.pieces[part.stop - 1]
        pieces.append(Piece(first.start, last.end))
        share *= (last.end - first.start) / (variable.maximum - variable.minimum)
    return Region(tuple(pieces), share)


def uncovered_regions(base: RuleBase, output: int) -> list[Region]:
    axes = [make_axis(variable) for variable in base.inputs]
    return boxes(base, uncovered(base, output, axes), axes)


def coverage_findings(base: RuleBase) -> list[Finding]:
    return [
        finding
        for number, _ in enumerate(base.outputs)
        for finding in output_coverage(base, number)
    ]


def output_coverage(base: RuleBase, index: int) -> list[Finding]:
    return region_findings(base.outputs[index], base, uncovered_regions(base, index))


def instead_of(default: float | None) -> tuple[str, str]:
    """What holds where no rule fires, and how bad that is."""
    if default is None:
        return "and it has no default", ERROR
    return f"it is its default {number(default)}", WARNING


def region_findings(
    output: Output | SystemOutput, base: RuleBase | System, regions: Sequence[Region]
) -> list[Finding]:
    """Of regions in which no rule of an output fires."""
    instead, severity = instead_of(output.default)
    findings = [
        Finding(
            UNCOVERED,
            severity,
            f"no rule for {output.name} fires where {region.text(base)} "
            f"({share_text(region.share)}): {instead}",
            region.text(base),
        )
        for region in regions[:REGIONS_TOLD]
    ]
    if len(regions) > REGIONS_TOLD:
        rest = regions[REGIONS_TOLD:]
        share = share_text(sum(region.share for region in rest))
        text = f"no rule for {output.name} fires in {len(rest)} more regions ({share}): {instead}"
        findings.append(Finding(UNCOVERED, severity, text, f"output {output.name}"))
    return findings


def share_text(share: float) -> str:
    return f"{100 * share:.3g} % of the inputs" if share > 0 else "no width"


def silent_rules(base: RuleBase) -> list[int]:
    """Rules whose strength is 0 everywhere."""
    axes = [make_axis(variable) for variable in base.inputs]
    return [i for i, rule in enumerate(base.rules) if not fires(rule, axes).any()]


def silent_findings(base: RuleBase) -> list[Finding]:
    return [
        Finding(
            UNREACHABLE,
            WARNING,
            f"{rule_place(i)} never fires: {base.rule_text(base.rules[i])}",
            rule_place(i),
        )
        for i in silent_rules(base)
    ]
