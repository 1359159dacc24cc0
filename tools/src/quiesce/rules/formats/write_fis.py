"""Writes FIS: Mamdani, or Sugeno with constants."""

from quiesce.base.errors import UsageError
from quiesce.rules.formats.build import FORBIDDEN
from quiesce.rules.formats.same import default_matters, plain_points
from quiesce.rules.formats.scan import number_text
from quiesce.rules.formats.shapes import FIS_SHAPES, ShapeError
from quiesce.rules.model import (
    CENTROID,
    OR,
    WEIGHTED_MAX,
    FuzzySet,
    Input,
    Output,
    Rule,
    RuleBase,
    Singleton,
)

BY_POINTS = {2: ("linsmf", "linzmf"), 3: ("trimf",), 4: ("trapmf",)}


def fis_text(base: RuleBase) -> str:
    check_methods(base)
    for index, output in enumerate(base.outputs):
        check_default(base, index, output)
    parts = [system_text(base)]
    parts += [
        variable_text(f"Input{number}", variable, variable.sets)
        for number, variable in enumerate(base.inputs, start=1)
    ]
    parts += [
        variable_text(f"Output{number}", output, output.terms)
        for number, output in enumerate(base.outputs, start=1)
    ]
    lines = [rule_line(base, number, rule) for number, rule in enumerate(base.rules, start=1)]
    parts.append("\n".join(["[Rules]", *lines]))
    return "\n\n".join(parts) + "\n"


def check_methods(base: RuleBase) -> None:
    methods = {output.method for output in base.outputs}
    if WEIGHTED_MAX in methods:
        raise UsageError(
            "FIS has no weighted average over the greatest strength of a term's rules; "
            "its Sugeno systems add up the rules (in FCL: ACCU : SUM)"
        )
    if len(methods) > 1:
        raise UsageError("FIS has one method for all outputs, not centroid and weighted average")


def check_default(base: RuleBase, index: int, output: Output) -> None:
    """A default that no input reaches may be any."""
    middle = 0.5 * (output.minimum + output.maximum)
    if output.default != middle and default_matters(base, index):
        own = "none" if output.default is None else f"{output.default:g}"
        raise UsageError(
            f"output {output.name}: FIS has no default; MATLAB answers {middle:g}, the middle of "
            f"the range, where no rule fires, and here the default is {own}"
        )


def quoted(name: str, what: str) -> str:
    if not name.strip() or FORBIDDEN.search(name):
        raise UsageError(f"{what} '{name}': FIS cannot hold it; rename it")
    return f"'{name}'"


def system_text(base: RuleBase) -> str:
    is_mamdani = base.outputs[0].method == CENTROID
    return "\n".join(
        [
            "[System]",
            f"Name={quoted(base.name, 'the name')}",
            f"Type='{'mamdani' if is_mamdani else 'sugeno'}'",
            "Version=2.0",
            f"NumInputs={len(base.inputs)}",
            f"NumOutputs={len(base.outputs)}",
            f"NumRules={len(base.rules)}",
            "AndMethod='min'",
            "OrMethod='max'",
            f"ImpMethod='{'min' if is_mamdani else 'prod'}'",
            f"AggMethod='{'max' if is_mamdani else 'sum'}'",
            f"DefuzzMethod='{'centroid' if is_mamdani else 'wtaver'}'",
        ]
    )


def variable_text(
    section: str, variable: Input | Output, terms: tuple[FuzzySet, ...] | tuple[Singleton, ...]
) -> str:
    lines = [
        f"[{section}]",
        f"Name={quoted(variable.name, 'variable')}",
        f"Range=[{number_text(variable.minimum)} {number_text(variable.maximum)}]",
        f"NumMFs={len(terms)}",
    ]
    lines += [
        f"MF{number}={quoted(term.name, 'term')}:{function_text(variable, term)}"
        for number, term in enumerate(terms, start=1)
    ]
    return "\n".join(lines)


def function_text(variable: Input | Output, term: FuzzySet | Singleton) -> str:
    if isinstance(term, Singleton):
        return f"'constant',[{number_text(term.value)}]"
    points = plain_points(term.points)
    x = [x for x, _ in points]
    for word in BY_POINTS.get(len(points), ()):
        try:
            if FIS_SHAPES[word](x) == points:
                return f"'{word}',[{' '.join(map(number_text, x))}]"
        except ShapeError:
            continue
    raise UsageError(
        f"{variable.name}, set {term.name}: FIS has no membership function through "
        f"{len(points)} points like these; it has triangles, trapezoids and ramps from 0 to 1"
    )


def rule_line(base: RuleBase, number: int, rule: Rule) -> str:
    places = [0] * len(base.inputs)
    for condition in rule.conditions:
        if places[condition.input]:
            name = base.inputs[condition.input].name
            raise UsageError(f"rule {number} names {name} twice; FIS has one set an input")
        places[condition.input] = (condition.set + 1) * (-1 if condition.negated else 1)
    terms = [0 if term is None else term + 1 for term in rule.conclusions]
    connective = 2 if rule.connective == OR else 1
    return (
        f"{' '.join(map(str, places))}, {' '.join(map(str, terms))} "
        f"({number_text(rule.weight)}) : {connective}"
    )
