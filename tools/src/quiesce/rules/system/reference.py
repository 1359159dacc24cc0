"""What a fuzzy system answers, in float64: the yardstick of the firmware's integers.

Straight from the text of model.py, with the same places but nothing else of how the firmware
computes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.rules.model import AND
from quiesce.rules.system.formula import value_of as formula_value
from quiesce.rules.system.model import (
    BISECTOR,
    BY_TERM,
    CENTROID,
    LARGEST,
    SMALLEST,
    VALUE_METHODS,
    WEIGHTED,
    Complement,
    Conclusion,
    ConstantTerm,
    Curve,
    Expression,
    FormulaTerm,
    InputTerm,
    LinearTerm,
    Proposition,
    StrengthTerm,
    System,
    SystemOutput,
    SystemRule,
    ValueTerm,
)
from quiesce.rules.system.norms import ANY, HEDGES, NORMS

CHUNK_POINTS = 256
ALIKE = 2.0**-18  # heights that count as the same
WEAKEST = 2.0**-10  # of an output's strongest rule: below, rounding is all that there is to see


@dataclass(frozen=True)
class Answers:
    """All [output, point]: values in the output's unit (its default where it has none, NaN where
    that is not said), whether that is so, and the greatest strength of its rules."""

    outputs: np.ndarray
    is_default: np.ndarray
    strongest: np.ndarray


@dataclass(frozen=True)
class Fired:
    """A conclusion with its rule's strength at every point."""

    rule: SystemRule
    term: int
    strength: np.ndarray


def evaluate(system: System, inputs: Sequence[np.ndarray]) -> Answers:
    """inputs: [point] of each, in its unit."""
    x = [
        np.clip(np.asarray(values, dtype=float), one.minimum, one.maximum)
        for one, values in zip(system.inputs, inputs, strict=True)
    ]
    parts = [
        evaluate_some(system, [one[first : first + CHUNK_POINTS] for one in x])
        for first in range(0, len(x[0]), CHUNK_POINTS)
    ]
    return Answers(*(np.concatenate(both, axis=1) for both in zip(*parts, strict=True)))


def evaluate_some(system: System, x: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    fired, _ = fired_at(system, x)
    filled: list[np.ndarray] = []
    missing = []
    for i, output in enumerate(system.outputs):
        value = value_of(system, i, fired[i], x, filled)
        missing.append(np.isnan(value))
        default = np.nan if output.default is None else output.default
        filled.append(np.where(missing[i], default, value))
    strongest = [
        np.max([one.strength for one in rules], axis=0, initial=0.0) if rules else 0.0 * x[0]
        for rules in fired
    ]
    return np.array(filled), np.array(missing), np.array(strongest)


def fired_at(system: System, x: list[np.ndarray]) -> tuple[list[list[Fired]], np.ndarray]:
    """x: [point] of each input, within its universe. What each output's rules conclude, and
    [rule, point] strengths."""
    fired: list[list[Fired]] = [[] for _ in system.outputs]
    strengths = np.zeros((len(system.rules), len(x[0])))
    for number, rule in enumerate(system.rules):
        strength = rule.weight * np.minimum(strength_of(system, rule, rule.expression, x, fired), 1)
        strengths[number] = strength
        for one in rule.conclusions:
            fired[one.output].append(Fired(rule, one.term, concluded(one, strength)))
    return fired, strengths


def concluded(one: Conclusion, strength: np.ndarray) -> np.ndarray:
    """A rule that does not fire concludes nothing, whatever its hedge makes of 0."""
    hedged = strength
    for hedge in one.hedges:
        hedged = HEDGES[hedge](hedged)
    return np.where(strength > 0, hedged, 0.0)


def strength_of(
    system: System, rule: SystemRule, expression: Expression, x: list[np.ndarray], fired: list
) -> np.ndarray:
    if isinstance(expression, Complement):
        return 1.0 - strength_of(system, rule, expression.part, x, fired)
    if isinstance(expression, Proposition):
        return proposed(system, expression, x, fired)
    block = system.blocks[rule.block]
    norm = NORMS[block.conjunction if expression.connective == AND else block.disjunction]
    first, *rest = (strength_of(system, rule, part, x, fired) for part in expression.parts)
    for other in rest:
        first = norm(first, other)
    return first


def proposed(system: System, one: Proposition, x: list[np.ndarray], fired: list) -> np.ndarray:
    if ANY in one.hedges:
        value = np.ones_like(x[0])
    elif one.is_input:
        term = system.inputs[one.variable].terms[one.term]
        value = membership(term.curve, x[one.variable])
    else:
        output = system.outputs[one.variable]
        value = np.minimum(activated(output, fired[one.variable], one.term, x[0].shape), 1.0)
    for hedge in reversed(one.hedges):
        value = value if hedge == ANY else HEDGES[hedge](value)
    return value


def membership(curve: Curve, x: np.ndarray) -> np.ndarray:
    with np.errstate(all="ignore"):
        return np.clip(curve.function(x), 0.0, 1.0)


def activated(
    output: SystemOutput, fired: Sequence[Fired], term: int, shape: tuple[int, ...]
) -> np.ndarray:
    """What a term has been activated with so far."""
    total = np.zeros(shape)
    for one in fired:
        if one.term == term:
            total = NORMS[output.aggregation](total, one.strength)
    return total


def value_of(
    system: System,
    index: int,
    fired: Sequence[Fired],
    x: list[np.ndarray],
    before: Sequence[np.ndarray],
) -> np.ndarray:
    """NaN where there is none. before: outputs before it."""
    output = system.outputs[index]
    if output.method not in VALUE_METHODS:
        return from_sets(system, output, fired, x[0].shape)
    if output.method == BY_TERM:
        pairs = [
            (term, activated(output, fired, i, x[0].shape)) for i, term in enumerate(output.terms)
        ]
    else:
        pairs = [(output.terms[one.term], one.strength) for one in fired]
    total = sum((strength for _, strength in pairs), np.zeros_like(x[0]))
    weighted = sum((s * term_value(term, s, x, before) for term, s in pairs), np.zeros_like(x[0]))
    safe = np.where(total > 0, total, 1.0)
    value = weighted if output.method == WEIGHTED else weighted / safe
    value = np.clip(value, output.minimum, output.maximum) if output.clips else value
    return np.where(total > 0, value, np.nan)


def term_value(
    term: ValueTerm, strength: np.ndarray, x: list[np.ndarray], before: Sequence[np.ndarray]
) -> np.ndarray:
    if isinstance(term, ConstantTerm):
        return np.full_like(x[0], term.value)
    if isinstance(term, LinearTerm):
        return term.constant + sum(a * b for a, b in zip(term.slopes, x, strict=True))
    if isinstance(term, InputTerm):
        return term.curve.function(x[term.input])
    if isinstance(term, FormulaTerm):
        names = {name: x[i] for name, i in term.inputs} | {
            name: before[i] for name, i in term.outputs
        }
        return np.broadcast_to(formula_value(term.tree, names), x[0].shape)
    assert isinstance(term, StrengthTerm)
    return term.curve.function(np.minimum(strength, 1.0))


def from_sets(
    system: System, output: SystemOutput, fired: Sequence[Fired], shape: tuple[int, ...]
) -> np.ndarray:
    part = (output.maximum - output.minimum) / output.places
    places = output.minimum + part * (np.arange(output.places) + 0.5)
    sets = [membership(term.curve, places) for term in output.terms]
    height = np.zeros((*shape, output.places))
    for one in fired:
        implication = NORMS[system.blocks[one.rule.block].implication]
        height = NORMS[output.aggregation](
            height, implication(sets[one.term], one.strength[:, None])
        )
    area = height.sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        if output.method == CENTROID:
            return height @ places / area
        if output.method == BISECTOR:
            return bisector(height, output.minimum, part)
        is_highest = height >= height.max(axis=1, keepdims=True) - ALIKE
        if output.method == SMALLEST:
            value = places[np.argmax(is_highest, axis=1)]
        elif output.method == LARGEST:
            value = places[::-1][np.argmax(is_highest[:, ::-1], axis=1)]
        else:
            value = is_highest @ places / is_highest.sum(axis=1)
        return np.where(area > 0, value, np.nan)


def bisector(height: np.ndarray, low: float, part: float) -> np.ndarray:
    """Straight between a place's ends."""
    area = np.cumsum(height, axis=1)
    half = 0.5 * area[:, -1:]
    found = np.argmax(area >= half, axis=1)[:, None]
    own = np.take_along_axis(height, found, axis=1)
    before = np.take_along_axis(area, found, axis=1) - own
    return (low + part * (found + (half - before) / own))[:, 0]
