"""Jumps of a system's outputs, found on lines through its inputs: float64, sampled.

Along each input, the others held at random places, the steps with the largest differences are
halved, the half with the larger difference kept, until their ends are as good as one point. What
is left of the difference there is a jump, or steeper than anybody would call smooth.
"""

from dataclasses import dataclass

import numpy as np

from quiesce.rules.analysis.systems.sample import draw
from quiesce.rules.analysis.systems.support import corners
from quiesce.rules.system.model import SET_METHODS, System
from quiesce.rules.system.reference import WEAKEST, evaluate

STEPS = 128  # along an input, beside its corners and both of their sides
LINES, LINES_OF_SETS = 12, 3  # of an input; sets take long
CLOSE = 1e-9  # of the universe: no farther apart are a jump's ends
BESIDE = 2.0**-32  # of the universe: a corner's two sides
LEAST = 1e-3  # of the output's range
TRIED = 3  # steps of a line and an output
SEED = 2


@dataclass(frozen=True)
class Jump:
    """Of an output by height, in its unit, at a place along an input."""

    output: int
    input: int
    height: float
    at: tuple[float, ...]
    to_default: bool


@dataclass(frozen=True)
class Jumps:
    """The largest of each output along each input, where there is one."""

    lines: int
    found: tuple[Jump, ...]


def jumps(system: System) -> Jumps:
    has_sets = any(one.method in SET_METHODS for one in system.outputs)
    lines = LINES_OF_SETS if has_sets else LINES
    found: dict[tuple[int, int], Jump] = {}
    for index in range(len(system.inputs)):
        for held in draw(system, lines, SEED + index).T:
            for jump in jumps_along(system, index, held):
                key = (jump.output, index)
                if key not in found or jump.height > found[key].height:
                    found[key] = jump
    order = sorted(found)
    return Jumps(lines * len(system.inputs), tuple(found[key] for key in order))


def places_along(system: System, index: int) -> np.ndarray:
    variable = system.inputs[index]
    at = np.array(corners(variable))
    aside = BESIDE * (variable.maximum - variable.minimum)
    sides = np.concatenate([at - aside, at, at + aside])
    steps = np.linspace(variable.minimum, variable.maximum, STEPS + 1)
    return np.unique(np.clip(np.concatenate([sides, steps]), variable.minimum, variable.maximum))


def values_along(system: System, index: int, held: np.ndarray, places: np.ndarray) -> tuple:
    """Outputs [output, place], and whether they are defaults, which are 0 where not said; NaN where
    rules fire too weakly to tell."""
    x = [np.full(places.shape, value) for value in held]
    x[index] = places
    answer = evaluate(system, x)
    values = np.nan_to_num(answer.outputs, nan=0.0)
    is_known = answer.is_default | (answer.strongest >= WEAKEST)
    return np.where(is_known, values, np.nan), answer.is_default


def differences(values: np.ndarray) -> np.ndarray:
    """Of neighbours; 0 where one is not known."""
    return np.nan_to_num(np.abs(np.diff(values)), nan=0.0)


def jumps_along(system: System, index: int, held: np.ndarray) -> list[Jump]:
    places = places_along(system, index)
    values, _ = values_along(system, index, held, places)
    found = []
    for output, one in enumerate(system.outputs):
        least = LEAST * (one.maximum - one.minimum)
        steps = differences(values[output])
        for k in np.argsort(-steps, kind="stable")[:TRIED]:
            if steps[k] > least:
                jump = closed_in(system, output, index, held, places[k : k + 2], least)
                found += [jump] if jump else []
    return found


def closed_in(
    system: System, output: int, index: int, held: np.ndarray, ends: np.ndarray, least: float
) -> Jump | None:
    """None where less than that is left before the ends are close."""
    low, high = ends
    variable = system.inputs[index]
    close = CLOSE * (variable.maximum - variable.minimum)
    while high - low > close:
        middle = low + 0.5 * (high - low)
        values, _ = values_along(system, index, held, np.array([low, middle, high]))
        first, second = differences(values[output])
        if max(first, second) <= least or not low < middle < high:
            return None
        low, high = (low, middle) if first >= second else (middle, high)
    values, is_default = values_along(system, index, held, np.array([low, high]))
    at = [float(value) for value in held]
    at[index] = float(high)
    (height,) = differences(values[output]).tolist()
    return Jump(output, index, height, tuple(at), bool(is_default[output].any()))
