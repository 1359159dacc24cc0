"""Writes a system as FIS, as far as its rows of rules hold one, with FuzzyLite's words for norms
and shapes that MATLAB does not have."""

from quiesce.base.errors import UsageError
from quiesce.rules.analysis.systems.support import support
from quiesce.rules.formats.fis import DEFUZZIFIERS, HEDGES, PLACES
from quiesce.rules.formats.norm_words import FIS_S_NORMS, FIS_T_NORMS
from quiesce.rules.formats.scan import number_text
from quiesce.rules.formats.shapes import FIS_SHAPES
from quiesce.rules.formats.write_fis import quoted
from quiesce.rules.formats.write_system_fll import tree_text
from quiesce.rules.model import OR
from quiesce.rules.system.model import (
    LARGEST,
    SET_METHODS,
    SMALLEST,
    ConstantTerm,
    Curve,
    Expression,
    FormulaTerm,
    Join,
    LinearTerm,
    Proposition,
    SetTerm,
    System,
    SystemInput,
    SystemOutput,
    SystemRule,
    ValueTerm,
)
from quiesce.rules.system.norms import NOT

T_WORDS = {norm: word for word, norm in FIS_T_NORMS.items()}
S_WORDS = {norm: word for word, norm in FIS_S_NORMS.items()}
METHODS = {method: word for word, method in DEFUZZIFIERS.items()}
DECIMALS = {(): "", **{words: f".{hundredths:02d}" for hundredths, words in HEDGES.items()}}
SHAPES = {shape.make: (word, shape) for word, shape in reversed(FIS_SHAPES.items())}


def fis_system_text(system: System) -> str:
    """UsageError, which names it, for what FIS cannot hold."""
    check_outputs(system)
    parts = [head_text(system)]
    for kind, variables in (("Input", system.inputs), ("Output", system.outputs)):
        parts += [variable_text(f"{kind}{k}", one) for k, one in enumerate(variables, start=1)]
    lines = [rule_line(system, k, rule) for k, rule in enumerate(system.rules, start=1)]
    parts.append("\n".join(["[Rules]", *lines]))
    return "\n\n".join(parts) + "\n"


# ---- what all have in common ---------------------------------------------------------------------


def check_outputs(system: System) -> None:
    if len({(one.method, one.aggregation) for one in system.outputs}) > 1:
        raise UsageError("FIS has one method and one aggregation for all outputs")
    if len(set(system.blocks)) > 1:
        raise UsageError("FIS has one block of rules, with one operator each for AND and OR")
    covered = support(system).covered
    for index, output in enumerate(system.outputs):
        check_output(output, covered[index])


def check_output(output: SystemOutput, is_covered: bool) -> None:
    of, is_sets = f"output {output.name}", output.method in SET_METHODS
    if output.method not in METHODS:
        raise UsageError(f"{of}: FIS has no {output.method}; its Sugeno systems add up the rules")
    if is_sets and output.places != PLACES:
        raise UsageError(f"{of}: FIS has no resolution; {PLACES} places, and here {output.places}")
    if output.clips and not is_sets:
        raise UsageError(f"{of}: FIS does not limit a weighted value to the range")
    if output.method in (SMALLEST, LARGEST) and output.minimum < 0:
        raise UsageError(f"{of}: som and lom of FIS are by magnitude, and its range is below 0")
    middle = 0.5 * (output.minimum + output.maximum)
    if output.default != middle and not is_covered:
        own = "none" if output.default is None else f"{output.default:g}"
        raise UsageError(
            f"{of}: FIS has no default; MATLAB answers {middle:g}, the middle of the range, where "
            f"no rule fires, and here the default is {own}"
        )


def head_text(system: System) -> str:
    block, output = system.blocks[0], system.outputs[0]
    is_sets = output.method in SET_METHODS
    return "\n".join(
        [
            "[System]",
            f"Name={quoted(system.name, 'the name')}",
            f"Type='{'mamdani' if is_sets else 'sugeno'}'",
            "Version=2.0",
            f"NumInputs={len(system.inputs)}",
            f"NumOutputs={len(system.outputs)}",
            f"NumRules={len(system.rules)}",
            f"AndMethod='{T_WORDS[block.conjunction]}'",
            f"OrMethod='{S_WORDS[block.disjunction]}'",
            f"ImpMethod='{T_WORDS[block.implication]}'",
            f"AggMethod='{S_WORDS[output.aggregation]}'",
            f"DefuzzMethod='{METHODS[output.method]}'",
        ]
    )


# ---- terms ---------------------------------------------------------------------------------------


def variable_text(section: str, variable: SystemInput | SystemOutput) -> str:
    lines = [
        f"[{section}]",
        f"Name={quoted(variable.name, 'variable')}",
        f"Range=[{number_text(variable.minimum)} {number_text(variable.maximum)}]",
        f"NumMFs={len(variable.terms)}",
    ]
    lines += [
        f"MF{number}={quoted(term.name, 'term')}:{term_text(term)}"
        for number, term in enumerate(variable.terms, start=1)
    ]
    return "\n".join(lines)


def term_text(term: SetTerm | ValueTerm) -> str:
    if isinstance(term, ConstantTerm):
        return function("constant", [term.value])
    if isinstance(term, LinearTerm):
        return function("linear", [*term.slopes, term.constant])
    if isinstance(term, FormulaTerm):
        return f"'function',[{tree_text(term.tree)}]"
    return curve_text(term.name, term.curve)


def function(word: str, values: list[float]) -> str:
    return f"'{word}',[{' '.join(map(number_text, values))}]"


def curve_text(name: str, curve: Curve) -> str:
    origin = curve.origin
    if origin is not None and origin.tree is not None:
        return f"'function',[{tree_text(origin.tree)}]"
    if origin is not None and origin.make in SHAPES and origin.height == 1.0:
        word, shape = SHAPES[origin.make]
        return function(word, shape.as_in_file(origin.parameters))
    if curve.points is None:
        raise UsageError(f"term {name}: FIS has no {curve.word} of another height than 1")
    return function("discretemf", [value for point in curve.points for value in point])


# ---- rules ---------------------------------------------------------------------------------------


def rule_line(system: System, number: int, rule: SystemRule) -> str:
    expression = rule.expression
    places = ["0"] * len(system.inputs)
    for part in expression.parts if isinstance(expression, Join) else (expression,):
        one = condition(number, part)
        if places[one.variable] != "0":
            name = system.inputs[one.variable].name
            raise UsageError(f"rule {number} names {name} twice; FIS has one set an input")
        places[one.variable] = signed(number, one.term, one.hedges)
    terms = ["0"] * len(system.outputs)
    for conclusion in rule.conclusions:
        terms[conclusion.output] = numbered(number, conclusion.term, conclusion.hedges[::-1])
    connective = 2 if isinstance(expression, Join) and expression.connective == OR else 1
    return f"{' '.join(places)}, {' '.join(terms)} ({number_text(rule.weight)}) : {connective}"


def condition(number: int, part: Expression) -> Proposition:
    if not isinstance(part, Proposition):
        raise UsageError(f"rule {number}: FIS has no parentheses, AND beside OR or NOT of several")
    if not part.is_input:
        raise UsageError(f"rule {number}: FIS has no conditions on outputs")
    return part


def signed(number: int, term: int, hedges: tuple[str, ...]) -> str:
    is_negated = hedges[:1] == (NOT,)
    return ("-" if is_negated else "") + numbered(
        number, term, hedges[1:] if is_negated else hedges
    )


def numbered(number: int, term: int, hedges: tuple[str, ...]) -> str:
    if hedges not in DECIMALS:
        raise UsageError(f"rule {number}: FIS has no hedges '{' '.join(hedges)}'")
    return f"{term + 1}{DECIMALS[hedges]}"
