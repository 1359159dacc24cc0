"""Random rule bases: what `./tools/benchmark fuzzy` and the tests feed to every engine and peer.

A base is a function of (seed, number) alone. Its kind, layout of the input sets, style of the rules
and method of the outputs, is drawn so that every combination occurs; about two in five are of the
kind that engineers write (two inputs, one rule for every pair of sets, at most two sets overlap).
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from quiesce.rules.model import (
    AND,
    CENTROID,
    METHODS,
    OR,
    Condition,
    Input,
    Output,
    Rule,
    RuleBase,
    Singleton,
)

from quiesce_benchmarks.fuzzy.sets import LAYOUTS, PAIRS, PARTITION, input_sets, output_sets

# How the rules are made: one for every combination of sets; some of these missing; with weights;
# any rules: OR, NOT, inputs that do not matter, the same conditions twice.
FULL, MISSING, WEIGHTED, MIXED = "full", "missing", "weighted", "mixed"
STYLES = (FULL, MISSING, WEIGHTED, MIXED)

UNIVERSES = ((0.0, 1.0), (0.0, 25.0), (-10.0, 10.0), (-3.7, 0.4), (0.0, 1e5), (1000.0, 1024.0))


@dataclass(frozen=True)
class RandomBase:
    number: int
    layout: str  # of LAYOUTS
    style: str  # of STYLES
    base: RuleBase


def random_base(seed: int, number: int) -> RandomBase:
    rng = np.random.default_rng([seed, number])
    if rng.random() < 0.4:
        layout, style, count = rng.choice([PARTITION, PAIRS], p=[0.7, 0.3]), FULL, 2
    else:
        layout, style = rng.choice(LAYOUTS), rng.choice(STYLES)
        count = 2 if rng.random() < 0.8 else 3
    inputs = tuple(make_input(rng, f"x{i}", str(layout), count) for i in range(count))
    outputs = make_outputs(rng, number)
    rules = make_rules(rng, str(style), inputs, outputs)
    base = RuleBase(f"random_{seed}_{number}", inputs, outputs, rules)
    return RandomBase(number, str(layout), str(style), base)


def make_input(rng: np.random.Generator, name: str, layout: str, inputs: int) -> Input:
    low, high = UNIVERSES[rng.integers(len(UNIVERSES))]
    count = int(rng.integers(2, 8 if inputs == 2 else 5))
    return Input(name, low, high, input_sets(rng, layout, count, low, high))


def make_outputs(rng: np.random.Generator, number: int) -> tuple[Output, ...]:
    """One, sometimes two; the methods take turns."""
    count = 2 if rng.random() < 0.1 else 1
    return tuple(
        make_output(rng, f"y{i}", METHODS[(number + i) % len(METHODS)]) for i in range(count)
    )


def make_output(rng: np.random.Generator, name: str, method: str) -> Output:
    low, high = UNIVERSES[rng.integers(len(UNIVERSES))]
    count = int(rng.integers(2, 8))
    if method == CENTROID:
        terms = output_sets(rng, count, low, high)
    else:
        values = np.sort(rng.uniform(low, high, count))
        if rng.random() < 0.5:
            values[0], values[-1] = low, high
        terms = tuple(Singleton(f"t{k}", float(value)) for k, value in enumerate(values))
    return Output(name, low, high, terms, method, float(rng.uniform(low, high)))


def make_rules(
    rng: np.random.Generator,
    style: str,
    inputs: tuple[Input, ...],
    outputs: tuple[Output, ...],
) -> tuple[Rule, ...]:
    if style == MIXED:
        return mixed_rules(rng, inputs, outputs)
    rules = full_rules(rng, inputs, outputs, is_weighted=style == WEIGHTED)
    if style == FULL:
        return rules
    share = 0.25 if style == MISSING else 0.0
    kept = tuple(rule for rule in rules if rng.random() >= share)
    return kept or rules[:1]


def full_rules(
    rng: np.random.Generator,
    inputs: tuple[Input, ...],
    outputs: tuple[Output, ...],
    is_weighted: bool,
) -> tuple[Rule, ...]:
    """One for every combination of sets; terms rise along the inputs, or are anything."""
    is_monotone = rng.random() < 0.5
    combinations = list(product(*(range(len(variable.sets)) for variable in inputs)))
    longest = sum(len(variable.sets) - 1 for variable in inputs)
    rules = []
    for sets in combinations:
        share = sum(sets) / longest if is_monotone else float(rng.random())
        conditions = tuple(Condition(i, k) for i, k in enumerate(sets))
        terms = tuple(min(int(share * len(o.terms)), len(o.terms) - 1) for o in outputs)
        weight = random_weight(rng) if is_weighted else 1.0
        rules.append(Rule(conditions, terms, AND, weight))
    return tuple(rules)


def mixed_rules(
    rng: np.random.Generator, inputs: tuple[Input, ...], outputs: tuple[Output, ...]
) -> tuple[Rule, ...]:
    rules: list[Rule] = []
    for _ in range(int(rng.integers(3, 25))):
        if rules and rng.random() < 0.15:  # the same conditions again
            again = rules[rng.integers(len(rules))]
            conditions, connective = again.conditions, again.connective
        else:
            conditions = random_conditions(rng, inputs)
            connective = OR if rng.random() < 0.3 else AND
        weight = random_weight(rng) if rng.random() < 0.3 else 1.0
        rules.append(Rule(conditions, random_terms(rng, outputs), connective, weight))
    return tuple(rules)


def random_conditions(rng: np.random.Generator, inputs: tuple[Input, ...]) -> tuple[Condition, ...]:
    """Of some of the inputs."""
    chosen = np.flatnonzero(rng.random(len(inputs)) < 0.75)
    if len(chosen) == 0:
        chosen = [rng.integers(len(inputs))]
    return tuple(
        Condition(int(i), int(rng.integers(len(inputs[i].sets))), bool(rng.random() < 0.2))
        for i in chosen
    )


def random_terms(rng: np.random.Generator, outputs: tuple[Output, ...]) -> tuple[int | None, ...]:
    """A term of each output; where there are several, one of them may be left out."""
    terms: list[int | None] = [int(rng.integers(len(output.terms))) for output in outputs]
    if len(terms) > 1 and rng.random() < 0.2:
        terms[rng.integers(len(terms))] = None
    return tuple(terms)


def random_weight(rng: np.random.Generator) -> float:
    """Two decimals, sometimes any; above 0."""
    weight = float(rng.uniform(0.05, 1.0))
    return round(weight, 2) if rng.random() < 0.7 else weight
