"""A system's rules as text, in the words of a format."""

from collections.abc import Callable, Sequence

from quiesce.rules.model import AND
from quiesce.rules.system.model import (
    Complement,
    Conclusion,
    Expression,
    Join,
    Proposition,
    System,
    SystemRule,
)
from quiesce.rules.system.norms import ANY

Word = Callable[[str], str]


def rule_text(
    system: System,
    rule: SystemRule,
    word: Word = str.upper,
    joint: str = ", ",
    number: Callable[[float], str] = "{:g}".format,
) -> str:
    """`a IS x AND NOT (b IS very y OR c IS z) THEN u IS p WITH 0.5`, without IF; word: of
    keywords; joint: between conclusions."""
    conditions = expression_text(system, rule.expression, word)
    conclusions = joint.join(conclusion_text(system, one, word) for one in rule.conclusions)
    weight = "" if rule.weight == 1.0 else f" {word('with')} {number(rule.weight)}"
    return f"{conditions} {word('then')} {conclusions}{weight}"


def expression_text(system: System, expression: Expression, word: Word = str.upper) -> str:
    if isinstance(expression, Proposition):
        return proposition_text(system, expression, word)
    if isinstance(expression, Complement):
        return f"{word('not')} ({expression_text(system, expression.part, word)})"
    parts = [part_text(system, expression, part, word) for part in expression.parts]
    return f" {word(expression.connective)} ".join(parts)


def part_text(system: System, whole: Join, part: Expression, word: Word) -> str:
    """In parentheses where OR stands within AND, or the same within the same."""
    text = expression_text(system, part, word)
    is_bare = not isinstance(part, Join) or (part.connective == AND and whole.connective != AND)
    return text if is_bare else f"({text})"


def proposition_text(system: System, one: Proposition, word: Word = str.upper) -> str:
    variables = system.inputs if one.is_input else system.outputs
    variable = variables[one.variable]
    is_complete = ANY in one.hedges and one.hedges[-1] == ANY
    term = () if is_complete else (variable.terms[one.term].name,)
    return f"{variable.name} {word('is')} {spoken(one.hedges, term)}"


def conclusion_text(system: System, one: Conclusion, word: Word = str.upper) -> str:
    output = system.outputs[one.output]
    hedges = tuple(reversed(one.hedges))
    return f"{output.name} {word('is')} {spoken(hedges, (output.terms[one.term].name,))}"


def spoken(hedges: Sequence[str], term: tuple[str, ...]) -> str:
    return " ".join((*hedges, *term))
