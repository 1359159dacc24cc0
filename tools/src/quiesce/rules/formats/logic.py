"""Rules as text: conditions with AND, OR, NOT and parentheses, and their split into plain rules.

FCL and FLL share it. A rule of the model joins its conditions with one connective. A mixed
expression becomes the rules of its disjunctive form, one for each conjunction; that is exact where
an output takes the greatest strength of a term's rules, as the strength of an expression is a
maximum of minima, but not where each rule adds to a sum.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from quiesce.rules.formats.scan import NAME, Source, Stream, Token
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

MAX_DEPTH = 32  # of parentheses and NOTs


@dataclass(frozen=True)
class Join:
    connective: str
    parts: tuple["Expression", ...]


Expression = Condition | Join


@dataclass(frozen=True)
class Words:
    """The keywords of a format."""

    if_: str
    then: str
    is_: str
    not_: str
    and_: str
    or_: str
    with_: str
    separators: tuple[str, ...]  # of conclusions
    ignore_case: bool
    refused: tuple[str, ...] = ()  # hedges that the format knows and the model does not

    def reserved(self) -> set[str]:
        own = {self.if_, self.then, self.is_, self.not_, self.and_, self.or_, self.with_}
        return own | set(self.refused)


@dataclass(frozen=True)
class Names:
    """Of one variable and its terms, each with its index."""

    is_input: bool
    index: int
    terms: dict[str, int]
    shown: str
    shown_terms: tuple[str, ...]


@dataclass(frozen=True)
class Draft:
    """A rule as it stands in the file. at: where its expression begins."""

    at: Token
    expression: Expression
    conclusions: dict[int, int]  # output -> term
    weight: float


class RuleParser:
    def __init__(self, stream: Stream, words: Words, names: dict[str, Names]) -> None:
        self.stream = stream
        self.words = words
        self.names = names
        self.depth = 0

    def rule(self) -> Draft:
        words, stream = self.words, self.stream
        stream.expect(words.if_)
        at = stream.token
        expression = self.alternatives()
        if not stream.sees(words.then):
            raise stream.unexpected(f"'{words.and_}', '{words.or_}' or '{words.then}'")
        stream.take()
        conclusions = self.conclusions()
        weight = self.weight() if stream.accept(words.with_) else 1.0
        return Draft(at, expression, conclusions, weight)

    def alternatives(self) -> Expression:
        parts = [self.conjunction()]
        while self.stream.accept(self.words.or_):
            parts.append(self.conjunction())
        return join(OR, parts)

    def conjunction(self) -> Expression:
        parts = [self.factor()]
        while self.stream.accept(self.words.and_):
            parts.append(self.factor())
        return join(AND, parts)

    def factor(self) -> Expression:
        stream = self.stream
        is_not = stream.accept(self.words.not_)
        opened = None if is_not else stream.accept("(")
        if not (is_not or opened):
            return self.condition()
        self.depth += 1
        if self.depth > MAX_DEPTH:
            at = is_not or opened
            assert at is not None
            expected = f"at most {MAX_DEPTH} nested NOTs and parentheses"
            raise stream.source.error(at, f"found {at.shown()}", expected)
        found = negated(self.factor()) if is_not else self.alternatives()
        if opened:
            stream.expect(")")
        self.depth -= 1
        return found

    def condition(self) -> Condition:
        variable = self.variable(is_input=True)
        self.stream.expect(self.words.is_)
        is_negated = False
        while self.stream.accept(self.words.not_):
            is_negated = not is_negated
        return Condition(variable.index, self.term(variable), is_negated)

    def conclusions(self) -> dict[int, int]:
        found: dict[int, int] = {}
        while True:
            at = self.stream.token
            variable = self.variable(is_input=False)
            if variable.index in found:
                raise self.stream.source.error(
                    at, f"output {at.text} is named twice", "each output once in a rule"
                )
            self.stream.expect(self.words.is_)
            found[variable.index] = self.term(variable)
            if not self.stream.accept(*self.words.separators):
                return found

    def variable(self, is_input: bool) -> Names:
        kind = "input" if is_input else "output"
        token = self.name(f"the name of an {kind}")
        found = self.names.get(self.key(token))
        if found is None or found.is_input != is_input:
            known = ", ".join(v.shown for v in self.names.values() if v.is_input == is_input)
            what = "no variable" if found is None else f"not an {kind}:"
            raise self.stream.source.error(token, f"{what} {token.shown()}", f"one of {known}")
        return found

    def term(self, variable: Names) -> int:
        token = self.name(f"a term of {variable.shown}")
        found = variable.terms.get(self.key(token))
        if found is None:
            terms = ", ".join(variable.shown_terms)
            raise self.stream.source.error(
                token, f"{variable.shown} has no term {token.shown()}", f"one of {terms}"
            )
        return found

    def name(self, expected: str) -> Token:
        token = self.stream.token
        if token.kind == NAME and self.key(token) in self.words.refused:
            raise self.stream.source.error(
                token, f"hedge {token.shown()} is not supported", f"a term or '{self.words.not_}'"
            )
        if token.kind != NAME or self.key(token) in self.words.reserved():
            raise self.stream.unexpected(expected)
        return self.stream.take()

    def key(self, token: Token) -> str:
        return token.text.upper() if self.words.ignore_case else token.text

    def weight(self) -> float:
        at = self.stream.token
        return checked_weight(self.stream.source, at, self.stream.number("a weight"))


def checked_weight(source: Source, at: Token, weight: float) -> float:
    if not 0 <= weight <= 1:
        raise source.error(at, f"weight {at.text}", "0 to 1")
    return weight


def join(connective: str, parts: Sequence[Expression]) -> Expression:
    """Parts with the same connective merge; one part stands alone."""
    merged: list[Expression] = []
    for part in parts:
        same = isinstance(part, Join) and part.connective == connective
        merged += part.parts if same else [part]
    return merged[0] if len(merged) == 1 else Join(connective, tuple(merged))


def negated(expression: Expression) -> Expression:
    """1 - min(a, b) = max(1 - a, 1 - b), and the other way round."""
    if isinstance(expression, Condition):
        return Condition(expression.input, expression.set, not expression.negated)
    other = OR if expression.connective == AND else AND
    return join(other, [negated(part) for part in expression.parts])


def uses(expression: Expression, connective: str) -> bool:
    if isinstance(expression, Condition):
        return False
    return expression.connective == connective or any(
        uses(part, connective) for part in expression.parts
    )


def plain_rules(source: Source, draft: Draft, outputs: Sequence[Output]) -> list[Rule]:
    """The rules of the model that mean this one."""
    conclusions = tuple(draft.conclusions.get(i) for i in range(len(outputs)))
    found = plain(draft.expression)
    if found is None:
        summed = [outputs[i].name for i in draft.conclusions if outputs[i].method == WEIGHTED_SUM]
        if summed:
            raise source.error(
                draft.at,
                f"AND and OR are mixed, and output {summed[0]} adds up its rules one by one, "
                "so that they cannot be split",
                "one connective in a rule",
            )
        found = [(AND, part) for part in disjunctive(source, draft.at, draft.expression)]
    longest = max(len(conditions) for _, conditions in found)
    if longest > MAX_CONDITIONS:
        raise source.error(draft.at, f"{longest} conditions", f"at most {MAX_CONDITIONS} in a rule")
    return [Rule(tuple(c), conclusions, connective, draft.weight) for connective, c in found]


def plain(expression: Expression) -> list[tuple[str, tuple[Condition, ...]]] | None:
    """None where connectives are mixed."""
    if isinstance(expression, Condition):
        return [(AND, (expression,))]
    if all(isinstance(part, Condition) for part in expression.parts):
        return [(expression.connective, expression.parts)]
    return None


def disjunctive(source: Source, at: Token, expression: Expression) -> list[tuple[Condition, ...]]:
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
