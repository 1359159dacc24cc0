"""Where the output turns back between neighbouring sets of an input.

Between the cores of two neighbouring sets of an input a user expects the output to go from one
set's level to the other's. Minimum and maximum do not promise that: it may go the wrong way first.
Found on the reference, at the corners and middles of the cells of the other inputs.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.rules.analysis.findings import (
    NON_MONOTONE,
    NOTE,
    SAMPLED,
    WARNING,
    Finding,
    number,
)
from quiesce.rules.model import Input, RuleBase
from quiesce.rules.reference import evaluate
from quiesce.rules.system.model import System

STEPS = 32  # along an input, between two cores
MAX_POINTS = 200_000  # of one sweep; places of the other inputs are thinned out to keep to it
TOLERANCE = 1e-9  # of the output's universe
TOLD = 0.01  # of the output's universe: a turn as large as this is a warning


Core = tuple[float, float, str]  # where a set is greatest: start, end, name


@dataclass(frozen=True)
class View:
    """What is looked at: each input's cores, ascending, and its corners; values [output, ...] over
    a grid of open axes, NaN where no rule fires. tolerances: of each output, of its universe."""

    cores: tuple[list[Core], ...]
    corners: tuple[np.ndarray, ...]
    values: Callable[[Sequence[np.ndarray]], np.ndarray]
    tolerances: tuple[float, ...]
    most_points: int = MAX_POINTS


@dataclass(frozen=True)
class Gap:
    """From one set's core to the next one's, along an input."""

    input: int
    start: float
    end: float
    names: tuple[str, str]


@dataclass(frozen=True)
class Reversal:
    """The largest turn of an output within a gap, and how many places of the others have one."""

    gap: Gap
    output: int
    height: float  # in the output's unit: how far it goes the wrong way
    at: tuple[float, ...]  # inputs at which it turns
    places: int
    of_places: int


def view_of(base: RuleBase) -> View:
    def values(axes: Sequence[np.ndarray]) -> np.ndarray:
        # Where nothing fires the default stands: told as uncovered, not as a turn.
        answer = evaluate(base, axes)
        return np.where(answer.is_default, np.nan, answer.outputs)

    tolerances = (TOLERANCE,) * len(base.outputs)
    return View(
        tuple(map(cores, base.inputs)), tuple(map(corners, base.inputs)), values, tolerances
    )


def cores(variable: Input) -> list[Core]:
    """Where each set is greatest inside the universe, in ascending order: start, end, name.

    A set that is as great everywhere has no core.
    """
    found = []
    for one in variable.sets:
        inside = [variable.minimum, variable.maximum]
        inside += [x for x, _ in one.points if variable.minimum < x < variable.maximum]
        values = [(one.membership(x), x) for x in inside]
        top = max(mu for mu, _ in values)
        at_top = [x for mu, x in values if mu == top]
        is_everywhere = min(at_top) == variable.minimum and max(at_top) == variable.maximum
        if top > 0 and not is_everywhere:
            found.append((min(at_top), max(at_top), one.name))
    return sorted(found)


def gaps(base: RuleBase | System, view: View) -> Iterator[Gap]:
    for index, variable in enumerate(base.inputs):
        end, name = variable.maximum, ""
        for next_start, next_end, next_name in view.cores[index]:
            if end < next_start:
                yield Gap(index, end, next_start, (name, next_name))
            if not name or next_end > end:
                end, name = next_end, next_name


def corners(variable: Input) -> np.ndarray:
    """Breakpoints inside the universe, its ends, and the middles between them."""
    places = {x for one in variable.sets for x, _ in one.points}
    places |= {variable.minimum, variable.maximum}
    inside = np.array(sorted(x for x in places if variable.minimum <= x <= variable.maximum))
    return np.sort(np.concatenate([inside, (inside[1:] + inside[:-1]) / 2]))


def sweep_axes(view: View, gap: Gap) -> list[np.ndarray]:
    """Places of each input: the gap's own steps, the corners of the others."""
    axes = list(view.corners)
    inside = axes[gap.input]
    inside = inside[(inside > gap.start) & (inside < gap.end)]
    axes[gap.input] = np.union1d(np.linspace(gap.start, gap.end, STEPS + 1), inside)
    others = [i for i in range(len(axes)) if i != gap.input]
    while others and np.prod([float(len(axis)) for axis in axes]) > view.most_points:
        widest = max(others, key=lambda i: len(axes[i]))
        axes[widest] = axes[widest][::2]
    return axes


def reversals(base: RuleBase) -> list[Reversal]:
    return reversals_in(base, view_of(base))


def reversals_in(base: RuleBase | System, view: View) -> list[Reversal]:
    found = []
    for gap in gaps(base, view):
        axes = sweep_axes(view, gap)
        values = view.values(np.ix_(*axes))
        for output in range(len(base.outputs)):
            one = largest_turn(base, gap, output, axes, values[output], view.tolerances[output])
            if one is not None:
                found.append(one)
    return found


def largest_turn(
    base: RuleBase | System,
    gap: Gap,
    output: int,
    axes: Sequence[np.ndarray],
    values: np.ndarray,
    tolerance: float,
) -> Reversal | None:
    along = np.moveaxis(values, gap.input, 0)
    turn = np.nan_to_num(wrong_way(along), nan=0.0)
    span = base.outputs[output].maximum - base.outputs[output].minimum
    has_turn = turn > tolerance * span
    if not has_turn.any():
        return None
    worst = np.unravel_index(int(np.argmax(turn)), turn.shape)
    others = [i for i in range(len(axes)) if i != gap.input]
    place = {i: float(axes[i][k]) for i, k in zip(others, worst, strict=True)}
    place[gap.input] = float(axes[gap.input][turning_point(along[(slice(None), *worst)])])
    return Reversal(
        gap,
        output,
        float(turn[worst]),
        tuple(place[i] for i in range(len(axes))),
        int(has_turn.sum()),
        has_turn.size,
    )


def wrong_way(along: np.ndarray) -> np.ndarray:
    """How far each sequence (first index) goes against its main direction.

    The main direction is that of the larger of its greatest rise and its greatest fall.
    """
    fall = (np.maximum.accumulate(along, axis=0) - along).max(axis=0)
    rise = (along - np.minimum.accumulate(along, axis=0)).max(axis=0)
    return np.minimum(fall, rise)


def turning_point(along: np.ndarray) -> int:
    """Index inside the sequence at which its way back ends, or starts if it lasts to the end."""
    falls = np.maximum.accumulate(along) - along
    rises = along - np.minimum.accumulate(along)
    is_fall = falls.max() < rises.max()
    end = int(np.argmax(falls if is_fall else rises))
    if end < len(along) - 1:
        return end
    return int(np.argmax(along[: end + 1]) if is_fall else np.argmin(along[: end + 1]))


def monotone_findings(base: RuleBase) -> list[Finding]:
    return [finding_of(base, reversal) for reversal in reversals(base)]


def finding_of(base: RuleBase | System, reversal: Reversal) -> Finding:
    output, gap = base.outputs[reversal.output], reversal.gap
    name = base.inputs[gap.input].name
    place = ", ".join(
        f"{variable.name} = {number(x)}"
        for variable, x in zip(base.inputs, reversal.at, strict=True)
    )
    height = reversal.height / (output.maximum - output.minimum)
    text = (
        f"{output.name} turns back along {name} between {gap.names[0]} and {gap.names[1]} "
        f"({number(gap.start)} .. {number(gap.end)}) by up to {reversal.height:.3g} "
        f"({100 * height:.2g} % of its range), at {place}; "
        f"in {reversal.places} of {reversal.of_places} places"
    )
    return Finding(NON_MONOTONE, WARNING if height >= TOLD else NOTE, text, place, SAMPLED)
