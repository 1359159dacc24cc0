"""Rule bases for tests: a published controller, and random ones."""

import numpy as np
from quiesce.rules.model import (
    CENTROID,
    OR,
    WEIGHTED_MAX,
    Condition,
    FuzzySet,
    Input,
    Output,
    Rule,
    RuleBase,
    Singleton,
    trapezoid,
    triangle,
)

# Terms Z S M L VL by frequency (rows) and acceleration (columns).
REFERENCE_TABLE = ((0, 1, 2, 3), (1, 2, 3, 3), (1, 2, 3, 4), (2, 3, 4, 4))


def reference_inputs() -> tuple[Input, Input]:
    freq = Input(
        "f", 0.0, 25.0,
        (
            trapezoid("S", 0, 0, 3, 8),
            triangle("M", 3, 8, 13),
            triangle("H", 8, 13, 18),
            trapezoid("VH", 13, 18, 25, 25),
        ),
    )  # fmt: skip
    accel = Input(
        "a", 0.0, 20.0,
        (
            trapezoid("S", 0, 0, 2, 6),
            triangle("M", 2, 6, 10),
            triangle("H", 6, 10, 15),
            trapezoid("VH", 10, 15, 20, 20),
        ),
    )  # fmt: skip
    return freq, accel


def reference_output(method: str, default: float | None = 0.0) -> Output:
    names = ("Z", "S", "M", "L", "VL")
    if method == CENTROID:
        places = (0.0, 0.0, 1.25, 2.5, 3.75, 5.0, 5.0)
        terms = tuple(triangle(name, *places[i : i + 3]) for i, name in enumerate(names))
        return Output("I", 0.0, 5.0, terms, method, default)
    singletons = tuple(Singleton(name, 1.25 * i) for i, name in enumerate(names))
    return Output("I", 0.0, 5.0, singletons, method, default)


def reference_base(method: str = WEIGHTED_MAX, default: float | None = 0.0) -> RuleBase:
    """The controller that peers are compared on: 4 x 4 sets, 16 rules, 5 terms."""
    rules = tuple(
        Rule((Condition(0, f), Condition(1, a)), (term,))
        for f, row in enumerate(REFERENCE_TABLE)
        for a, term in enumerate(row)
    )
    return RuleBase("reference", reference_inputs(), (reference_output(method, default),), rules)


def one_input_base(
    sets: tuple[FuzzySet, ...],
    terms: tuple,
    method: str,
    default: float | None = None,
    low: float = 0.0,
    high: float = 10.0,
) -> RuleBase:
    """Rule i: x IS set i THEN y IS term i."""
    output = Output("y", low, high, terms, method, default)
    rules = tuple(Rule((Condition(0, i),), (i % len(terms),)) for i in range(len(sets)))
    return RuleBase("one input", (Input("x", 0.0, 10.0, sets),), (output,), rules)


def random_set(random: np.random.Generator, name: str, low: float, high: float) -> FuzzySet:
    """Trapezoids and polygons, some beyond the universe, some with vertical edges."""
    margin = 0.2 * (high - low)
    count = int(random.integers(2, 6))
    x = np.sort(random.uniform(low - margin, high + margin, count))
    if random.random() < 0.4:
        x[1] = x[0]
    if random.random() < 0.3 and count > 3:
        x[-1] = x[-2]
    mu = random.uniform(0.0, 1.0, count)
    if random.random() < 0.7:
        mu[[0, -1]] = 0.0
    mu[int(random.integers(count))] = 1.0
    return FuzzySet(name, tuple(zip(x.tolist(), mu.tolist(), strict=True)))


def random_rule(random: np.random.Generator, inputs: tuple[Input, ...], output: Output) -> Rule:
    chosen = [i for i in range(len(inputs)) if random.random() < 0.8] or [0]
    if random.random() < 0.2:
        chosen.append(chosen[0])
    conditions = tuple(
        Condition(i, int(random.integers(len(inputs[i].sets))), bool(random.random() < 0.2))
        for i in chosen
    )
    weight = float(random.choice([1.0, 1.0, 0.5, 0.25]))
    connective = OR if random.random() < 0.2 else "and"
    return Rule(conditions, (int(random.integers(len(output.terms))),), connective, weight)


def random_base(seed: int, method: str, input_count: int = 2) -> RuleBase:
    random = np.random.default_rng(seed)
    inputs = tuple(
        Input(
            f"x{i}", -1.0, 3.0,
            tuple(random_set(random, f"s{k}", -1.0, 3.0) for k in range(random.integers(1, 5))),
        )
        for i in range(input_count)
    )  # fmt: skip
    count = int(random.integers(1, 6))
    if method == CENTROID:
        terms = tuple(random_set(random, f"t{k}", -2.0, 7.0) for k in range(count))
    else:
        terms = tuple(Singleton(f"t{k}", float(random.uniform(-2, 7))) for k in range(count))
    output = Output("y", -2.0, 7.0, terms, method, 0.5)
    rules = tuple(random_rule(random, inputs, output) for _ in range(random.integers(1, 10)))
    return RuleBase(f"random {seed}", inputs, (output,), rules)
