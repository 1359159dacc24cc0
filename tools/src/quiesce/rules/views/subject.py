"""What pictures and tables ask of a rule base, plain or a system of any kind."""

from collections.abc import Sequence

import numpy as np

from quiesce.rules.analysis.systems.reach import ends_of
from quiesce.rules.analysis.systems.support import places_of_terms
from quiesce.rules.model import FuzzySet, Input, Output, RuleBase, Singleton
from quiesce.rules.reference import Reference
from quiesce.rules.reference import evaluate as evaluate_plain
from quiesce.rules.reference import membership as membership_of_set
from quiesce.rules.system.formula import value_of
from quiesce.rules.system.model import (
    SET_METHODS,
    ConstantTerm,
    FormulaTerm,
    InputTerm,
    SetTerm,
    StrengthTerm,
    System,
    SystemInput,
    SystemOutput,
    ValueTerm,
)
from quiesce.rules.system.reference import evaluate as evaluate_system
from quiesce.rules.system.reference import fired_at
from quiesce.rules.system.reference import membership as membership_of_curve
from quiesce.rules.system.rule_text import rule_text

Subject = RuleBase | System
AnyInput = Input | SystemInput
AnyOutput = Output | SystemOutput
AnySet = FuzzySet | SetTerm

STEPS = 400  # of a smooth set's curve
VALUE_STEPS = 257  # of an input, or of the strength, along which values are taken
FORMULA_POINTS = 4096
STRENGTHS = (0.01, 0.99)


def terms_of(variable: AnyInput | AnyOutput) -> tuple:
    return variable.sets if isinstance(variable, Input) else variable.terms


def answer_at(subject: Subject, points: Sequence[np.ndarray]) -> Reference:
    """Over arrays in shapes that numpy broadcasts together, one for each input."""
    if isinstance(subject, RuleBase):
        return evaluate_plain(subject, points)
    grid = np.broadcast_arrays(*(np.atleast_1d(np.asarray(x, dtype=float)) for x in points))
    answer = evaluate_system(subject, [one.ravel() for one in grid])
    shape = (-1, *grid[0].shape)
    return Reference(answer.outputs.reshape(shape), answer.is_default.reshape(shape))


def strengths(subject: Subject, inputs: np.ndarray) -> np.ndarray:
    """[rule, point]; inputs: [input, point]."""
    if isinstance(subject, RuleBase):
        found = evaluate_plain(subject, list(inputs), want_strengths=True).strengths
        assert found is not None
        return found
    clipped = [
        np.clip(x, one.minimum, one.maximum) for x, one in zip(inputs, subject.inputs, strict=True)
    ]
    return fired_at(subject, clipped)[1]


def rule_line(subject: Subject, index: int) -> str:
    if isinstance(subject, RuleBase):
        return subject.rule_text(subject.rules[index])
    return rule_text(subject, subject.rules[index])


def edges(variable: AnyInput | AnyOutput) -> np.ndarray:
    """Where sets may bend or jump."""
    if isinstance(variable, Input | Output):
        return np.array([x for one in terms_of(variable) for x, _ in one.points])
    return np.array(places_of_terms(variable.terms))


def set_places(variable: AnyInput | AnyOutput, one: AnySet) -> np.ndarray:
    """Places within the universe at which straight lines show a set as it is."""
    ends = [variable.minimum, variable.maximum]
    if isinstance(one, FuzzySet):
        at = np.array([x for x, _ in one.points])
    else:
        at = np.array(places_of_terms([one]))
    sides = np.concatenate([np.nextafter(at, -np.inf), at, np.nextafter(at, np.inf)])
    is_straight = isinstance(one, FuzzySet) or one.curve.points is not None
    steps = np.array(ends) if is_straight else np.linspace(*ends, STEPS + 1)
    return np.unique(np.clip(np.concatenate([sides, steps]), *ends))


def membership(one: AnySet, x: np.ndarray) -> np.ndarray:
    if isinstance(one, FuzzySet):
        return membership_of_set(one, x)
    return membership_of_curve(one.curve, x)


def values_of(subject: Subject, term: Singleton | ValueTerm) -> tuple[float, float]:
    """The least and the largest that a term of a weighted output can say; of a function of the
    strength within STRENGTHS, as some have no end."""
    if isinstance(term, Singleton | ConstantTerm):
        return term.value, term.value
    assert isinstance(subject, System)
    known = ends_of(subject, term)
    if known is not None:
        return known
    if isinstance(term, FormulaTerm):
        return reach_of_formula(subject, term)
    assert isinstance(term, InputTerm | StrengthTerm)
    ends = STRENGTHS
    if isinstance(term, InputTerm):
        ends = (subject.inputs[term.input].minimum, subject.inputs[term.input].maximum)
    with np.errstate(all="ignore"):
        values = np.asarray(term.curve.function(np.linspace(*ends, VALUE_STEPS)), dtype=float)
    return ends_of_values(values)


def reach_of_formula(system: System, term: FormulaTerm) -> tuple[float, float]:
    """At random inputs, and at random values of the outputs that it names."""
    rng = np.random.default_rng(1)
    variables = [(name, system.inputs[i]) for name, i in term.inputs]
    variables += [(name, system.outputs[i]) for name, i in term.outputs]
    drawn = {name: rng.uniform(one.minimum, one.maximum, FORMULA_POINTS) for name, one in variables}
    return ends_of_values(value_of(term.tree, drawn))


def ends_of_values(values: np.ndarray) -> tuple[float, float]:
    found = values[np.isfinite(values)]
    return (float(found.min()), float(found.max())) if found.size else (0.0, 0.0)


def is_slow(subject: Subject) -> bool:
    """Whether sets are looked at place by place."""
    return isinstance(subject, System) and any(
        output.method in SET_METHODS for output in subject.outputs
    )
