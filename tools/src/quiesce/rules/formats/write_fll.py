"""Writes FLL, as fuzzylite 7 and 8 read it."""

from quiesce.base.errors import UsageError
from quiesce.rules.formats.build import FORBIDDEN
from quiesce.rules.formats.fll import RESERVED
from quiesce.rules.formats.scan import check_identifier, number_text
from quiesce.rules.formats.shapes import FLL_SHAPES
from quiesce.rules.model import (
    CENTROID,
    WEIGHTED_SUM,
    FuzzySet,
    Input,
    Output,
    RuleBase,
    Singleton,
)
from quiesce.rules.system.model import SystemInput, SystemOutput

# Samples that fuzzylite takes of a centroid; here it is exact.
RESOLUTION = 1000
BY_POINTS = {2: "Ramp", 3: "Triangle", 4: "Trapezoid"}


def fll_text(base: RuleBase) -> str:
    lines = [engine_line(base.name)]
    for variable in base.inputs:
        lines += input_lines(variable)
    for output in base.outputs:
        lines += output_lines(output)
    lines += block_lines(base)
    return "\n".join(lines) + "\n"


def engine_line(name: str) -> str:
    if name != name.strip() or not name or FORBIDDEN.search(name):
        raise UsageError(f"the base's name '{name}': FLL cannot hold it; rename it")
    return f"Engine: {name}"


def variable_lines(kind: str, variable: Input | Output | SystemInput | SystemOutput) -> list[str]:
    check_identifier(variable.name, "variable", "FLL", RESERVED)
    return [
        f"{kind}: {variable.name}",
        "  enabled: true",
        f"  range: {number_text(variable.minimum)} {number_text(variable.maximum)}",
        "  lock-range: true",
    ]


def input_lines(variable: Input) -> list[str]:
    return [*variable_lines("InputVariable", variable), *map(term_line, variable.sets)]


def output_lines(output: Output) -> list[str]:
    is_centroid = output.method == CENTROID
    return [
        *variable_lines("OutputVariable", output),
        f"  aggregation: {'UnboundedSum' if output.method == WEIGHTED_SUM else 'Maximum'}",
        f"  defuzzifier: {f'Centroid {RESOLUTION}' if is_centroid else 'WeightedAverage'}",
        f"  default: {'nan' if output.default is None else number_text(output.default)}",
        "  lock-previous: false",
        *map(term_line, output.terms),
    ]


def term_line(term: FuzzySet | Singleton) -> str:
    check_identifier(term.name, "term", "FLL", RESERVED)
    if isinstance(term, Singleton):
        return f"  term: {term.name} Constant {number_text(term.value)}"
    return f"  term: {term.name} {shape_text(term)}"


def shape_text(term: FuzzySet) -> str:
    """A shape that gives exactly these points, else all of them."""
    points = term.points
    word = BY_POINTS.get(len(points))
    height = max(mu for _, mu in points)
    if word and height > 0:
        x = [x for x, _ in points]
        if word == "Ramp" and points[0][1] > points[1][1]:
            x.reverse()
        if shape_points(word, x, height) == points:
            heights = [] if height == 1 else [height]
            return " ".join([word, *map(number_text, [*x, *heights])])
    pairs = [number_text(value) for point in points for value in point]
    return " ".join(["Discrete", *pairs])


def shape_points(word: str, x: list[float], height: float) -> tuple | None:
    if word == "Ramp" and x[0] == x[1]:
        return None
    made = FLL_SHAPES[word](x)
    return tuple((at, height * mu) for at, mu in made)


def block_lines(base: RuleBase) -> list[str]:
    return [
        "RuleBlock: rules",
        "  enabled: true",
        "  conjunction: Minimum",
        "  disjunction: Maximum",
        "  implication: Minimum",
        "  activation: General",
        *(
            f"  rule: if {base.rule_text(rule, str.lower, ' and ', number_text)}"
            for rule in base.rules
        ),
    ]
