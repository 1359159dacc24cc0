"""A rule base over one or two of its inputs, the others held: what plots and comparisons show."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.rules.model import Input, RuleBase
from quiesce.rules.reference import Reference, evaluate

CURVE_POINTS = 801
GRID_POINTS = 241


@dataclass(frozen=True)
class Slice:
    """Which inputs vary, and where the others stand."""

    axes: tuple[int, ...]  # one or two inputs
    held: tuple[float, ...]  # of every input; of those in axes without meaning

    def text(self, base: RuleBase) -> str:
        """`b = 2, c = 5` of the inputs that are held."""
        return ", ".join(
            f"{variable.name} = {self.held[i]:g}"
            for i, variable in enumerate(base.inputs)
            if i not in self.axes
        )


def input_index(base: RuleBase, name: str) -> int:
    for index, variable in enumerate(base.inputs):
        if variable.name == name:
            return index
    names = ", ".join(variable.name for variable in base.inputs)
    raise UsageError(f"{base.name}: no input '{name}'; there are: {names}")


def make_slice(base: RuleBase, axes: Sequence[str], settings: Sequence[str]) -> Slice:
    """From names of the inputs that vary (none: the first two) and `NAME=VALUE` of others.

    Inputs that neither names stand in the middle of their universe. UsageError for names and values
    that do not fit.
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
    return Slice(tuple(chosen), tuple(held))


def held_value(variable: Input, setting: str, text: str) -> float:
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


def axis_points(variable: Input, count: int) -> np.ndarray:
    """Evenly spaced over the universe, with every breakpoint and both of its sides beside them."""
    edges = np.array([x for one in variable.sets for x, _ in one.points])
    sides = np.concatenate([np.nextafter(edges, -np.inf), edges, np.nextafter(edges, np.inf)])
    inside = sides[(sides >= variable.minimum) & (sides <= variable.maximum)]
    return np.union1d(np.linspace(variable.minimum, variable.maximum, count), inside)


def even_points(variable: Input, count: int = GRID_POINTS) -> np.ndarray:
    return np.linspace(variable.minimum, variable.maximum, count)


def evaluate_slice(base: RuleBase, cut: Slice, points: Sequence[np.ndarray]) -> Reference:
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
    return evaluate(base, inputs)
