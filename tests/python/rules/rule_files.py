"""Rule files for tests: one controller in each format, and random ones that every format holds."""

from dataclasses import replace

import numpy as np
from quiesce.rules.model import (
    AND,
    CENTROID,
    OR,
    WEIGHTED_SUM,
    Condition,
    FuzzySet,
    Input,
    Output,
    Rule,
    RuleBase,
    Singleton,
    ramp,
    trapezoid,
    triangle,
)

FCL = """FUNCTION_BLOCK tank
VAR_INPUT
    level : REAL;
    flow : REAL;
END_VAR
VAR_OUTPUT
    valve : REAL;
END_VAR
FUZZIFY level
    TERM low := (0, 1) (5, 0);
    TERM high := (2, 0) (8, 1);
    RANGE := (0 .. 10);
END_FUZZIFY
FUZZIFY flow
    TERM outward := (-2, 1) (0, 0);
    TERM inward := (-1, 0) (0, 1) (1.5, 1) (2.5, 0);
    RANGE := (-2 .. 2);
END_FUZZIFY
DEFUZZIFY valve
    TERM shut := 0.125;
    TERM open := 1;
    METHOD : COGS;
    ACCU : SUM;
    DEFAULT := 0.5;
    RANGE := (0 .. 1);
END_DEFUZZIFY
RULEBLOCK rules
    AND : MIN;
    OR : MAX;
    ACT : MIN;
    RULE 1 : IF level IS low AND flow IS NOT inward THEN valve IS open WITH 0.75;
    RULE 2 : IF level IS high OR flow IS inward THEN valve IS shut;
END_RULEBLOCK
END_FUNCTION_BLOCK
"""

FLL = """Engine: tank
InputVariable: level
  enabled: true
  range: 0.000 10.000
  lock-range: false
  term: low Ramp 5.000 0.000
  term: high Ramp 2.000 8.000
InputVariable: flow
  enabled: true
  range: -2.000 2.000
  lock-range: false
  term: outward Ramp 0.000 -2.000
  term: inward Trapezoid -1.000 0.000 1.500 2.500
OutputVariable: valve
  enabled: true
  range: 0.000 1.000
  lock-range: false
  aggregation: UnboundedSum
  defuzzifier: WeightedAverage TakagiSugeno
  default: 0.500
  lock-previous: false
  term: shut Constant 0.125
  term: open Constant 1.000
RuleBlock: rules
  enabled: true
  conjunction: Minimum
  disjunction: Maximum
  implication: none
  activation: General
  rule: if level is low and flow is not inward then valve is open with 0.750
  rule: if level is high or flow is inward then valve is shut
"""

FIS = """[System]
Name='tank'
Type='sugeno'
Version=2.0
NumInputs=2
NumOutputs=1
NumRules=2
AndMethod='min'
OrMethod='max'
ImpMethod='prod'
AggMethod='sum'
DefuzzMethod='wtaver'

[Input1]
Name='level'
Range=[0 10]
NumMFs=2
MF1='low':'linzmf',[0 5]
MF2='high':'linsmf',[2 8]

[Input2]
Name='flow'
Range=[-2 2]
NumMFs=2
MF1='outward':'linzmf',[-2 0]
MF2='inward':'trapmf',[-1 0 1.5 2.5]

[Output1]
Name='valve'
Range=[0 1]
NumMFs=2
MF1='shut':'constant',[0.125]
MF2='open':'constant',[1]

[Rules]
1 -2, 2 (0.75) : 1
2 2, 1 (1) : 2
"""

TEXTS = {"fcl": FCL, "fll": FLL, "fis": FIS}

TANK = RuleBase(
    "tank",
    (
        Input("level", 0.0, 10.0, (ramp("low", 5.0, 0.0), ramp("high", 2.0, 8.0))),
        Input(
            "flow", -2.0, 2.0,
            (ramp("outward", 0.0, -2.0), trapezoid("inward", -1.0, 0.0, 1.5, 2.5)),
        ),
    ),
    (
        Output(
            "valve", 0.0, 1.0, (Singleton("shut", 0.125), Singleton("open", 1.0)),
            WEIGHTED_SUM, 0.5,
        ),
    ),
    (
        Rule((Condition(0, 0), Condition(1, 1, negated=True)), (1,), AND, 0.75),
        Rule((Condition(0, 1), Condition(1, 1)), (0,), OR),
    ),
)  # fmt: skip


def random_shape(random: np.random.Generator, name: str, low: float, high: float) -> FuzzySet:
    """A triangle, trapezoid or ramp that reaches into the universe."""
    margin = 0.3 * (high - low)
    x = sorted(random.uniform(low - margin, high + margin, 4).tolist())
    x[1] = float(random.uniform(low, high))
    x = sorted(x)
    kind = random.integers(4)
    if kind == 0:
        return triangle(name, x[0], x[1], x[3])
    if kind == 1:
        return ramp(name, *(x[1:3] if random.random() < 0.5 else x[2:0:-1]))
    if kind == 2:
        return trapezoid(name, x[0], x[0], x[2], x[3])
    return trapezoid(name, *x)


def is_above_zero(one: FuzzySet, low: float, high: float) -> bool:
    return max(one.membership(x) for x in np.linspace(low, high, 101)[1:-1].tolist()) > 0


def random_term(random: np.random.Generator, name: str, low: float, high: float) -> FuzzySet:
    while True:
        found = random_shape(random, name, low, high)
        if is_above_zero(found, low, high):
            return found


def random_file_base(seed: int, method: str) -> RuleBase:
    """1 to 3 inputs, 1 or 2 outputs; the default is the middle of the range, as in MATLAB."""
    random = np.random.default_rng(seed)
    inputs = tuple(random_input(random, f"x{i}") for i in range(random.integers(1, 4)))
    outputs = tuple(random_output(random, f"y{i}", method) for i in range(random.integers(1, 3)))
    rules = tuple(random_rule(random, inputs, outputs) for _ in range(random.integers(1, 12)))
    return RuleBase(f"random_{seed}", inputs, outputs, rules)


def random_input(random: np.random.Generator, name: str) -> Input:
    low = float(random.uniform(-1e3, 1e3))
    high = low + float(10 ** random.uniform(-3, 3))
    count = int(random.integers(1, 8))
    sets = tuple(random_term(random, f"s{i}", low, high) for i in range(count))
    return Input(name, low, high, sets)


def random_output(random: np.random.Generator, name: str, method: str) -> Output:
    low, width = float(random.uniform(-5, 5)), float(random.uniform(0.1, 9))
    high = low + width
    count = int(random.integers(1, 8))
    terms: tuple
    if method == CENTROID:
        terms = tuple(random_term(random, f"t{i}", low, high) for i in range(count))
    else:
        values = random.uniform(low, high, count).tolist()
        terms = tuple(Singleton(f"t{i}", value) for i, value in enumerate(values))
    return Output(name, low, high, terms, method, 0.5 * (low + high))


def random_rule(
    random: np.random.Generator, inputs: tuple[Input, ...], outputs: tuple[Output, ...]
) -> Rule:
    chosen = [i for i in range(len(inputs)) if random.random() < 0.8] or [0]
    conditions = tuple(
        Condition(i, int(random.integers(len(inputs[i].sets))), bool(random.random() < 0.2))
        for i in chosen
    )
    conclusions = [int(random.integers(len(output.terms))) for output in outputs]
    said = tuple(
        term if i == 0 or random.random() < 0.7 else None for i, term in enumerate(conclusions)
    )
    connective = OR if len(conditions) > 1 and random.random() < 0.3 else AND
    weight = 1.0 if random.random() < 0.6 else float(random.uniform(0, 1))
    return Rule(conditions, said, connective, weight)


def with_output(base: RuleBase, **changes: object) -> RuleBase:
    """The base with its first output changed."""
    return replace(base, outputs=(replace(base.outputs[0], **changes), *base.outputs[1:]))
