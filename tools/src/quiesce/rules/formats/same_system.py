"""Whether two systems answer the same, at random points and at corners."""

from collections.abc import Sequence

import numpy as np

from quiesce.rules.analysis.systems.sample import draw, place_text
from quiesce.rules.analysis.systems.support import support
from quiesce.rules.system.model import SET_METHODS, System, SystemInput, SystemOutput
from quiesce.rules.system.reference import evaluate

POINTS, POINTS_OF_SETS = 2000, 400
ROUNDING = 1e-9  # of an output's range

Variables = Sequence[SystemInput | SystemOutput]


def name_difference(one: Variables, other: Variables) -> str | None:
    if [v.name for v in one] != [w.name for w in other]:
        return "names of variables"
    for v, w in zip(one, other, strict=True):
        if (v.minimum, v.maximum) != (w.minimum, w.maximum):
            return f"the range of {v.name}"
        if [term.name for term in v.terms] != [term.name for term in w.terms]:
            return f"the terms of {v.name}"
    return None


def system_difference(one: System, other: System) -> str | None:
    """What they differ in, in words; None where they answer the same."""
    named = name_difference((*one.inputs, *one.outputs), (*other.inputs, *other.outputs))
    if named:
        return named
    has_sets = any(output.method in SET_METHODS for output in one.outputs)
    x = draw(one, POINTS_OF_SETS if has_sets else POINTS)
    covered = support(one).covered
    answers = [evaluate(system, list(x)) for system in (one, other)]
    for index, output in enumerate(one.outputs):
        first, second = (np.nan_to_num(answer.outputs[index]) for answer in answers)
        apart = np.abs(first - second) > ROUNDING * (output.maximum - output.minimum)
        apart |= answers[0].is_default[index] != answers[1].is_default[index]
        if apart.any():
            at = place_text(one, x[:, np.argmax(apart)])
            return f"answers of output {output.name}, such as at {at}"
        if output.default != other.outputs[index].default and not covered[index]:
            return f"the default of output {output.name}"
    return None
