"""Writes a system of any kind as FCL, with FuzzyLite's words for what the standard lacks."""

from quiesce.base.errors import UsageError
from quiesce.rules.formats.fcl import METHODS, PLACES
from quiesce.rules.formats.norm_words import FCL_S_NORMS, FCL_T_NORMS
from quiesce.rules.formats.scan import number_text
from quiesce.rules.formats.write_fcl import check_names, declarations, range_line
from quiesce.rules.formats.write_system_fll import check_hedges, curve_text, value_text
from quiesce.rules.system.fold import is_named
from quiesce.rules.system.model import (
    BY_RULE,
    BY_TERM,
    SET_METHODS,
    ConstantTerm,
    SetTerm,
    StrengthTerm,
    System,
    SystemInput,
    ValueTerm,
)
from quiesce.rules.system.norms import UNBOUNDED_SUM
from quiesce.rules.system.rule_text import rule_text


def first_words(norms: dict[str, str]) -> dict[str, str]:
    """Of each norm the first of its words."""
    return {norm: word for word, norm in reversed(norms.items())}


T_WORDS, S_WORDS = first_words(FCL_T_NORMS), first_words(FCL_S_NORMS)


def fcl_system_text(system: System) -> str:
    """UsageError, which names it, for what FCL cannot hold."""
    check_names(system)
    blocks = [
        f"FUNCTION_BLOCK {system.name}",
        declarations("VAR_INPUT", system.inputs),
        declarations("VAR_OUTPUT", system.outputs),
        *(fuzzify(variable) for variable in system.inputs),
        *(defuzzify(system, index) for index in range(len(system.outputs))),
        *(rule_block(system, number) for number in range(len(system.blocks))),
        "END_FUNCTION_BLOCK\n",
    ]
    return "\n\n".join(blocks)


def term_line(term: SetTerm | ValueTerm) -> str:
    return f"    TERM {term.name} := {term_text(term)};"


def term_text(term: SetTerm | ValueTerm) -> str:
    if isinstance(term, ConstantTerm):
        return number_text(term.value)
    if isinstance(term, SetTerm) and term.curve.points is not None:
        return " ".join(f"({number_text(x)}, {number_text(mu)})" for x, mu in term.curve.points)
    return curve_text(term.name, term.curve) if isinstance(term, SetTerm) else value_text(term)


def fuzzify(variable: SystemInput) -> str:
    lines = [f"FUZZIFY {variable.name}", *map(term_line, variable.terms), range_line(variable)]
    return "\n".join([*lines, "END_FUZZIFY"])


def defuzzify(system: System, index: int) -> str:
    output = system.outputs[index]
    check_output(system, index)
    words = {method: word for word, method in METHODS.items() if method}
    norm = UNBOUNDED_SUM if output.method == BY_RULE else output.aggregation
    lines = [
        f"DEFUZZIFY {output.name}",
        *map(term_line, output.terms),
        f"    METHOD : {words.get(output.method, 'COGS')};",
        f"    ACCU : {S_WORDS[norm]};",
    ]
    if output.default is not None:
        lines.append(f"    DEFAULT := {number_text(output.default)};")
    return "\n".join([*lines, range_line(output), "END_DEFUZZIFY"])


def check_output(system: System, index: int) -> None:
    output = system.outputs[index]
    of, is_sets = f"output {output.name}", output.method in SET_METHODS
    if is_sets and output.places != PLACES:
        raise UsageError(f"{of}: FCL has no resolution; {PLACES} places, and here {output.places}")
    if output.clips and not is_sets:
        raise UsageError(f"{of}: FCL does not limit a weighted value to the range")
    is_sum = output.aggregation == UNBOUNDED_SUM
    of_strength = any(isinstance(term, StrengthTerm) for term in output.terms)
    if (output.method == BY_TERM and is_sum and of_strength) or (
        output.method == BY_RULE and not is_sum and is_named(system, index)
    ):
        raise UsageError(f"{of}: FCL has no {output.method} with {output.aggregation}")


def rule_block(system: System, number: int) -> str:
    block = system.blocks[number]
    lines = [
        f"RULEBLOCK rules{number + 1}",
        f"    AND : {T_WORDS[block.conjunction]};",
        f"    OR : {S_WORDS[block.disjunction]};",
        f"    ACT : {T_WORDS[block.implication]};",
    ]
    for i, rule in enumerate(system.rules, start=1):
        if rule.block == number:
            check_hedges(rule, i, "FCL")
            lines.append(f"    RULE {i} : IF {rule_text(system, rule, number=number_text)};")
    return "\n".join([*lines, "END_RULEBLOCK"])
