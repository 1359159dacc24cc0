"""Writes a system of any kind as FLL, as fuzzylite 7 and 8 read it."""

from collections.abc import Iterator

from quiesce.base.errors import UsageError
from quiesce.rules.formats.fll import DEFUZZIFIERS, NONE, RESERVED
from quiesce.rules.formats.scan import check_identifier, number_text
from quiesce.rules.formats.shapes import FLL_SHAPES
from quiesce.rules.formats.write_fll import engine_line, shape_text, variable_lines
from quiesce.rules.model import FuzzySet
from quiesce.rules.system.fold import is_named, propositions
from quiesce.rules.system.formula import NEGATE, Apply, Name, Number, Tree
from quiesce.rules.system.model import (
    BY_RULE,
    BY_TERM,
    SET_METHODS,
    ConstantTerm,
    Curve,
    FormulaTerm,
    InputTerm,
    LinearTerm,
    SetTerm,
    StrengthTerm,
    System,
    SystemOutput,
    SystemRule,
    ValueTerm,
)
from quiesce.rules.system.norms import UNBOUNDED_SUM
from quiesce.rules.system.rule_text import rule_text

HEDGES = ("not", "very", "somewhat", "extremely", "seldom", "any")
WORDS = {shape.make: word for word, shape in FLL_SHAPES.items()}
OPERATORS = ("+", "-", "*", "/", "%", "^")


def fll_system_text(system: System) -> str:
    """UsageError, which names it, for what FLL cannot hold."""
    lines = [engine_line(system.name)]
    for variable in system.inputs:
        lines += variable_lines("InputVariable", variable)
        lines += [set_line(term) for term in variable.terms]
    for index in range(len(system.outputs)):
        lines += output_lines(system, index)
    for number in range(len(system.blocks)):
        lines += block_lines(system, number)
    return "\n".join(lines) + "\n"


# ---- terms ---------------------------------------------------------------------------------------


def set_line(term: SetTerm) -> str:
    check_identifier(term.name, "term", "FLL", RESERVED)
    return f"  term: {term.name} {curve_text(term.name, term.curve)}"


def curve_text(name: str, curve: Curve) -> str:
    """By its shape's word, its points, or its formula."""
    origin = curve.origin
    if origin is not None and origin.tree is not None:
        return f"Function {tree_text(origin.tree)}"
    if origin is not None and origin.make in WORDS:
        word = WORDS[origin.make]
        values = FLL_SHAPES[word].as_in_file(origin.parameters)
        height = [] if origin.height == 1.0 else [origin.height]
        return " ".join([word, *map(number_text, [*values, *height])])
    if curve.points is None:
        raise UsageError(f"term {name}: FLL has no {curve.word}")
    return shape_text(FuzzySet(name, curve.points))


def value_line(system: System, term: ValueTerm) -> str:
    check_identifier(term.name, "term", "FLL", RESERVED)
    return f"  term: {term.name} {value_text(term)}"


def value_text(term: ValueTerm) -> str:
    if isinstance(term, ConstantTerm):
        return f"Constant {number_text(term.value)}"
    if isinstance(term, LinearTerm):
        return f"Linear {' '.join(map(number_text, (*term.slopes, term.constant)))}"
    if isinstance(term, FormulaTerm):
        return f"Function {tree_text(term.tree)}"
    assert isinstance(term, InputTerm | StrengthTerm)
    return curve_text(term.name, term.curve)


def tree_text(tree: Tree) -> str:
    """FuzzyLite takes no sign but before a number."""
    if isinstance(tree, Number):
        text = number_text(abs(tree.value))
        return text if tree.value >= 0 else f"(0 - {text})"
    if isinstance(tree, Name):
        return tree.text
    assert isinstance(tree, Apply)
    parts = [tree_text(part) for part in tree.parts]
    if tree.word == NEGATE:
        return f"(0 - {parts[0]})"
    if tree.word in OPERATORS:
        return f"({parts[0]} {tree.word} {parts[1]})"
    return f"{tree.word}({', '.join(parts)})"


# ---- outputs -------------------------------------------------------------------------------------


def output_lines(system: System, index: int) -> list[str]:
    output = system.outputs[index]
    default = "nan" if output.default is None else number_text(output.default)
    head = variable_lines("OutputVariable", output)
    lock = f"  lock-range: {'true' if output.clips else 'false'}"
    return [
        *(lock if line.startswith("  lock-range:") else line for line in head),
        f"  aggregation: {aggregation(system, index)}",
        f"  defuzzifier: {defuzzifier(output)}",
        f"  default: {default}",
        "  lock-previous: false",
        *(
            set_line(term) if isinstance(term, SetTerm) else value_line(system, term)
            for term in output.terms
        ),
    ]


def aggregation(system: System, index: int) -> str:
    """With a norm fuzzylite 7 weighs terms, without rules."""
    output = system.outputs[index]
    norm = output.aggregation
    if output.method == BY_TERM and norm == UNBOUNDED_SUM:
        if any(isinstance(term, StrengthTerm) for term in output.terms):
            raise UsageError(f"output {output.name}: FLL has no sum of a term's strengths")
        return NONE
    if output.method != BY_RULE:
        return NONE if norm == UNBOUNDED_SUM and output.method not in SET_METHODS else norm
    if norm != UNBOUNDED_SUM and is_named(system, index):
        raise UsageError(
            f"output {output.name}: FLL has no average rule by rule with aggregation {norm}, "
            "which a condition on it asks for"
        )
    return NONE


def defuzzifier(output: SystemOutput) -> str:
    words = {method: word for word, method in DEFUZZIFIERS.items() if method}
    if output.method in SET_METHODS:
        return f"{words[output.method]} {output.places}"
    kind = "Tsukamoto" if any(is_inverse(term) for term in output.terms) else "TakagiSugeno"
    return f"{words.get(output.method, 'WeightedAverage')} {kind}"


def is_inverse(term: SetTerm | ValueTerm) -> bool:
    return isinstance(term, StrengthTerm) and term.is_inverse


# ---- rules ---------------------------------------------------------------------------------------


def block_lines(system: System, number: int) -> list[str]:
    block = system.blocks[number]
    rules = [
        (i, one)
        for i, rule in enumerate(system.rules, start=1)
        if rule.block == number
        for one in split(rule, i)
    ]
    return [
        "RuleBlock: rules" if number == 0 else f"RuleBlock: rules{number + 1}",
        "  enabled: true",
        f"  conjunction: {block.conjunction}",
        f"  disjunction: {block.disjunction}",
        f"  implication: {block.implication}",
        "  activation: General",
        *(f"  rule: if {line(system, i, rule)}" for i, rule in rules),
    ]


def line(system: System, number: int, rule: SystemRule) -> str:
    check_hedges(rule, number, "FLL")
    return rule_text(system, rule, str.lower, " and ", number_text)


def check_hedges(rule: SystemRule, number: int, format: str) -> None:
    hedges = {hedge for one in propositions(rule.expression) for hedge in one.hedges}
    hedges |= {hedge for one in rule.conclusions for hedge in one.hedges}
    unknown = sorted(hedges - set(HEDGES))
    if unknown:
        raise UsageError(f"rule {number}: {format} has no hedge '{unknown[0]}'")


def split(rule: SystemRule, number: int) -> Iterator[SystemRule]:
    """A hedge of a conclusion lasts on in FLL: conclusions with hedges of their own become rules
    of their own, which is the same but where a condition names an output."""
    if len(rule.conclusions) == 1 or not any(one.hedges for one in rule.conclusions):
        yield rule
        return
    if any(not one.is_input for one in propositions(rule.expression)):
        raise UsageError(
            f"rule {number}: FLL has no hedges of single conclusions, and a condition on an output"
        )
    for one in rule.conclusions:
        yield SystemRule(rule.block, rule.expression, (one,), rule.weight)
