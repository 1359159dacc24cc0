"""Writes FCL."""

from collections.abc import Sequence

from quiesce.base.errors import UsageError
from quiesce.rules.formats.fcl import RESERVED
from quiesce.rules.formats.scan import check_identifier, number_text
from quiesce.rules.model import (
    CENTROID,
    WEIGHTED_SUM,
    FuzzySet,
    Input,
    Output,
    RuleBase,
    Singleton,
)
from quiesce.rules.system.model import System, SystemInput, SystemOutput


def fcl_text(base: RuleBase) -> str:
    check_names(base)
    blocks = [
        f"FUNCTION_BLOCK {base.name}",
        declarations("VAR_INPUT", base.inputs),
        declarations("VAR_OUTPUT", base.outputs),
        *(fuzzify(variable) for variable in base.inputs),
        *(defuzzify(variable) for variable in base.outputs),
        rule_block(base),
        "END_FUNCTION_BLOCK\n",
    ]
    return "\n\n".join(blocks)


def check_names(base: RuleBase | System) -> None:
    """Names differ by more than case, and are no words of FCL."""
    check_identifier_fcl(base.name, "the base's name")
    variables = [*base.inputs, *base.outputs]
    check_distinct([variable.name for variable in variables], "variable")
    for variable in variables:
        terms = variable.sets if isinstance(variable, Input) else variable.terms
        check_distinct([term.name for term in terms], f"term of {variable.name}")


def check_identifier_fcl(name: str, what: str) -> None:
    check_identifier(name, what, "FCL", {name} if name.upper() in RESERVED else set())


def check_distinct(names: list[str], what: str) -> None:
    seen: dict[str, str] = {}
    for name in names:
        check_identifier_fcl(name, what)
        other = seen.setdefault(name.upper(), name)
        if other != name:
            raise UsageError(f"{what} '{name}': FCL takes it for '{other}'; rename one of them")


def declarations(
    section: str, variables: Sequence[Input | Output | SystemInput | SystemOutput]
) -> str:
    lines = [f"    {variable.name} : REAL;" for variable in variables]
    return "\n".join([section, *lines, "END_VAR"])


def fuzzify(variable: Input) -> str:
    lines = [f"FUZZIFY {variable.name}", *map(term_line, variable.sets), range_line(variable)]
    return "\n".join([*lines, "END_FUZZIFY"])


def defuzzify(output: Output) -> str:
    lines = [
        f"DEFUZZIFY {output.name}",
        *map(term_line, output.terms),
        f"    METHOD : {'COG' if output.method == CENTROID else 'COGS'};",
        f"    ACCU : {'SUM' if output.method == WEIGHTED_SUM else 'MAX'};",
    ]
    if output.default is not None:
        lines.append(f"    DEFAULT := {number_text(output.default)};")
    return "\n".join([*lines, range_line(output), "END_DEFUZZIFY"])


def term_line(term: FuzzySet | Singleton) -> str:
    if isinstance(term, Singleton):
        return f"    TERM {term.name} := {number_text(term.value)};"
    points = " ".join(f"({number_text(x)}, {number_text(mu)})" for x, mu in term.points)
    return f"    TERM {term.name} := {points};"


def range_line(variable: Input | Output | SystemInput | SystemOutput) -> str:
    return f"    RANGE := ({number_text(variable.minimum)} .. {number_text(variable.maximum)});"


def rule_block(base: RuleBase) -> str:
    lines = ["RULEBLOCK rules", "    AND : MIN;", "    OR : MAX;", "    ACT : MIN;", ""]
    lines += [
        f"    RULE {number} : IF {base.rule_text(rule, number=number_text)};"
        for number, rule in enumerate(base.rules, start=1)
    ]
    return "\n".join([*lines, "END_RULEBLOCK"])
