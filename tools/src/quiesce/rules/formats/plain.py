"""From rules as they stand to those of a plain rule base, or why not.

A rule of the model joins its conditions with one connective. A mixed expression becomes the rules
of its disjunctive form, one for each conjunction; that is exact where an output takes the greatest
strength of a term's rules, as the strength of an expression is a maximum of minima, but not where
each rule adds to a sum.
"""

from collections.abc import Sequence

from quiesce.rules.formats.logic import Draft, Names, join
from quiesce.rules.formats.scan import Source, Token
from quiesce.rules.model import (
    AND,
    MAX_CONDITIONS,
    MAX_RULES,
    OR,
    WEIGHTED_SUM,
    Condition,
    Output,
    Rule,
)
from quiesce.rules.system.fold import propositions
from quiesce.rules.system.model import Complement, Expression, Join, Proposition
from quiesce.rules.system.norms import NOT


def plain_rules(
    source: Source, draft: Draft, outputs: Sequence[Output], names: Sequence[Names]
) -> list[Rule]:
    """The rules of the model that mean this one. names: of all variables."""
    check_plain(source, draft, names)
    concluded = {one.output: one.term for one in draft.conclusions}
    conclusions = tuple(concluded.get(i) for i in range(len(outputs)))
    expression = without_complements(draft.expression, False)
    found = plain(expression)
    if found is None:
        summed = [outputs[i].name for i in concluded if outputs[i].method == WEIGHTED_SUM]
        if summed:
            raise source.error(
                draft.at,
                f"AND and OR are mixed, and output {summed[0]} adds up its rules one by one, "
                "so that they cannot be split",
                "one connective in a rule",
            )
        found = [(AND, part) for part in disjunctive(source, draft.at, expression)]
    longest = max(len(conditions) for _, conditions in found)
    if longest > MAX_CONDITIONS:
        raise source.error(draft.at, f"{longest} conditions", f"at most {MAX_CONDITIONS} in a rule")
    return [Rule(tuple(c), conclusions, connective, draft.weight) for connective, c in found]


def check_plain(source: Source, draft: Draft, names: Sequence[Names]) -> None:
    """Conditions name inputs, and nothing has a hedge but NOT."""
    for one in propositions(draft.expression):
        if not one.is_input:
            shown = next(n.shown for n in names if not n.is_input and n.index == one.variable)
            known = ", ".join(n.shown for n in names if n.is_input)
            raise source.error(one.at[0], f"not an input: '{shown}'", f"one of {known}")
        refuse_hedges(source, one.at[1], [hedge for hedge in one.hedges if hedge != NOT])
    for conclusion in draft.conclusions:
        refuse_hedges(source, conclusion.at, conclusion.hedges)


def refuse_hedges(source: Source, at: int, hedges: Sequence[str]) -> None:
    if hedges:
        raise source.error(at, f"hedge '{hedges[0]}' is not supported", "a term or 'not'")


def without_complements(expression: Expression, is_negated: bool) -> Condition | Join:
    """1 - min(a, b) = max(1 - a, 1 - b), and the other way round."""
    if isinstance(expression, Complement):
        return without_complements(expression.part, not is_negated)
    if isinstance(expression, Proposition):
        times = expression.hedges.count(NOT) + is_negated
        return Condition(expression.variable, expression.term, times % 2 == 1)
    other = OR if expression.connective == AND else AND
    connective = other if is_negated else expression.connective
    return join(connective, [without_complements(part, is_negated) for part in expression.parts])


def plain(expression: Condition | Join) -> list[tuple[str, tuple[Condition, ...]]] | None:
    """None where connectives are mixed."""
    if isinstance(expression, Condition):
        return [(AND, (expression,))]
    if all(isinstance(part, Condition) for part in expression.parts):
        return [(expression.connective, expression.parts)]
    return None


def disjunctive(
    source: Source, at: Token, expression: Condition | Join
) -> list[tuple[Condition, ...]]:
    """Conjunctions whose maximum is the expression; each without repeats."""
    if isinstance(expression, Condition):
        return [(expression,)]
    parts = [disjunctive(source, at, part) for part in expression.parts]
    found: list[tuple[Condition, ...]] = [] if expression.connective == OR else [()]
    for part in parts:
        if expression.connective == OR:
            found = [*found, *part]
        else:
            found = [tuple(dict.fromkeys((*a, *b))) for a in found for b in part]
        found = list(dict.fromkeys(found))
        if len(found) > MAX_RULES:
            raise source.error(at, f"more than {MAX_RULES} rules once split", "a simpler rule")
    return found
