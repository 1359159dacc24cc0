"""A rule base over one or two of its inputs, the others held: what plots and comparisons show."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.rules.reference import Reference
from quiesce.rules.views.subject import AnyInput, Subject, answer_at, edges, is_slow

CURVE_POINTS = 801
GRID_POINTS = 241
PANEL_POINTS = 121  # of one of several maps
SLOW_POINTS = 61
MOST_FREE = 2  # inputs of which each end and the middle have maps of their own


@dataclass(frozen=True)
class Slice:
    """Which inputs vary, and where the others stand."""

    axes: tuple[int, ...]  # one or two inputs
    held: tuple[float, ...]  # of every input; of those in axes without meaning
    free: tuple[int, ...] = ()  # held, but nobody said where: at their ends, too

    def text(self, base: Subject) -> str:
        """`b = 2, c = 5` of the inputs that are held."""
        return held_text(base, self.held, [*self.axes])

    def fixed_text(self, base: Subject) -> str:
        """Of those that are held in all pictures."""
        return held_text(base, self.held, [*self.axes, *self.free])

    def page_text(self, base: Subject) -> str:
        turns = [f"{base.inputs[i].name} at its ends and in its middle" for i in self.free]
        return "; ".join([*turns, *filter(None, [self.fixed_text(base)])])


def held_text(base: Subject, held: Sequence[float], others: Sequence[int]) -> str:
    return ", ".join(
        f"{variable.name} = {held[i]:g}"
        for i, variable in enumerate(base.inputs)
        if i not in others
    )


def panels(base: Subject, cut: Slice) -> list[list[Slice]]:
    """Rows and columns of slices: the first free input by column, the second one by row, from
    its high end down, as axes go."""
    columns, rows = (levels(base, cut, i) for i in range(MOST_FREE))
    found = []
    for row in reversed(rows):
        found.append([])
        for column in columns:
            held = list(cut.held)
            for index, value in (*column, *row):
                held[index] = value
            found[-1].append(replace(cut, held=tuple(held), free=()))
    return found


def levels(base: Subject, cut: Slice, number: int) -> list[list[tuple[int, float]]]:
    """Of a free input, each with the input; one without any where there is none."""
    if number >= len(cut.free):
        return [[]]
    index = cut.free[number]
    variable = base.inputs[index]
    middle = 0.5 * (variable.minimum + variable.maximum)
    return [[(index, x)] for x in (variable.minimum, middle, variable.maximum)]


def panel_points(base: Subject, cut: Slice) -> int:
    """Of a map along an axis."""
    if is_slow(base):
        return SLOW_POINTS
    return PANEL_POINTS if cut.free else GRID_POINTS


def input_index(base: Subject, name: str) -> int:
    for index, variable in enumerate(base.inputs):
        if variable.name == name:
            return index
    names = ", ".join(variable.name for variable in base.inputs)
    raise UsageError(f"{base.name}: no input '{name}'; there are: {names}")


def make_slice(base: Subject, axes: Sequence[str], settings: Sequence[str]) -> Slice:
    """From names of the inputs that vary (none: the first two) and `NAME=VALUE` of others.

    Inputs that neither names stand in the middle of their universe; where two vary, the first two
    of them are free. UsageError for names and values that do not fit.
    """
    held = [(variable.minimum + variable.maximum) / 2 for variable in base.inputs]
    named = set()
    for setting in settings:
        name, _, text = setting.partition("=")
        index = input_index(base, name)
        held[index] = held_value(base.inputs[index], setting, text)
        named.add(index)
    chosen = [input_index(base, name) for name in axes]
    if not chosen:
        chosen = [i for i in range(len(base.inputs)) if i not in named][:2]
    if not 1 <= len(set(chosen)) == len(chosen) <= 2:
        raise UsageError("one or two different inputs can vary in a picture; the others are held")
    for index in set(chosen) & named:
        raise UsageError(f"--at {base.inputs[index].name}: this input varies, it cannot be held")
    others = [i for i in range(len(base.inputs)) if i not in named and i not in chosen]
    free = others[:MOST_FREE] if len(chosen) == 2 else []
    return Slice(tuple(chosen), tuple(held), tuple(free))


def held_value(variable: AnyInput, setting: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise UsageError(f"--at {setting}: expected NAME=VALUE with a number")
    if not variable.minimum <= value <= variable.maximum:
        raise UsageError(
            f"--at {setting}: outside {variable.name}'s {variable.minimum:g} .. "
            f"{variable.maximum:g}"
        )
    return value


def axis_points(variable: AnyInput, count: int) -> np.ndarray:
    """Evenly spaced over the universe, with every breakpoint and both of its sides beside them."""
    at = edges(variable)
    sides = np.concatenate([np.nextafter(at, -np.inf), at, np.nextafter(at, np.inf)])
    inside = sides[(sides >= variable.minimum) & (sides <= variable.maximum)]
    return np.union1d(np.linspace(variable.minimum, variable.maximum, count), inside)


def even_points(variable: AnyInput, count: int = GRID_POINTS) -> np.ndarray:
    return np.linspace(variable.minimum, variable.maximum, count)


def evaluate_slice(base: Subject, cut: Slice, points: Sequence[np.ndarray]) -> Reference:
    """Over the grid of `points`, one array for each input that varies; [.., first, second]."""
    inputs: list[np.ndarray] = []
    for index, value in enumerate(cut.held):
        if index not in cut.axes:
            inputs.append(np.full((1,) * len(points), value))
            continue
        place = cut.axes.index(index)
        shape = [1] * len(points)
        shape[place] = -1
        inputs.append(points[place].reshape(shape))
    return answer_at(base, inputs)
