"""Rules as text: conditions with AND, OR, NOT, hedges and parentheses. FCL and FLL share it."""

from collections.abc import Sequence
from dataclasses import dataclass

from quiesce.rules.formats.scan import NAME, Source, Stream, Token
from quiesce.rules.model import AND, OR
from quiesce.rules.system.model import Complement, Conclusion, Expression, Join, Proposition
from quiesce.rules.system.norms import ANY, NOT

MAX_DEPTH = 32  # of parentheses and NOTs
HEDGE_WORDS = (ANY, "very", "somewhat", "extremely", "seldom")


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
    hedges_last_on: bool = False  # those of a conclusion count for the ones behind it, too

    def reserved(self) -> set[str]:
        return {self.if_, self.then, self.is_, self.not_, self.and_, self.or_, self.with_}


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
    conclusions: tuple[Conclusion, ...]
    weight: float
    block: int = 0


class RuleParser:
    def __init__(
        self, stream: Stream, words: Words, names: dict[str, Names], block: int = 0
    ) -> None:
        self.stream = stream
        self.words = words
        self.names = names
        self.block = block
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
        return Draft(at, expression, conclusions, weight, self.block)

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
        found = complement(self.factor()) if is_not else self.alternatives()
        if opened:
            stream.expect(")")
        self.depth -= 1
        return found

    def condition(self) -> Proposition:
        start = self.stream.token
        variable = self.variable(is_input=None)
        self.stream.expect(self.words.is_)
        hedged = self.stream.token
        hedges = self.hedges(variable)
        is_complete = ANY in hedges and hedges[-1] == ANY
        term = 0 if is_complete else self.term(variable)
        return Proposition(
            variable.is_input, variable.index, term, hedges, (start.offset, hedged.offset)
        )

    def hedges(self, variable: Names) -> tuple[str, ...]:
        """Words before a term. `any` stands for all of the term."""
        found: list[str] = []
        while True:
            token = self.stream.token
            if self.stream.accept(self.words.not_):
                found.append(NOT)
            elif token.kind == NAME and self.is_hedge(token, variable):
                found.append(self.stream.take().text.lower())
                if found[-1] == ANY:
                    return tuple(found)
            else:
                return tuple(found)

    def is_hedge(self, token: Token, variable: Names) -> bool:
        """Where a format does not reserve the words a term may be called like one."""
        text = token.text.lower() if self.words.ignore_case else token.text
        return text in HEDGE_WORDS and self.key(token) not in variable.terms

    def conclusions(self) -> tuple[Conclusion, ...]:
        found: dict[int, Conclusion] = {}
        before: tuple[str, ...] = ()
        while True:
            at = self.stream.token
            variable = self.variable(is_input=False)
            if variable.index in found:
                raise self.stream.source.error(
                    at, f"output {at.text} is named twice", "each output once in a rule"
                )
            self.stream.expect(self.words.is_)
            hedged = self.stream.token
            words = self.hedges(variable)
            if ANY in words:
                raise self.stream.source.error(hedged, "'any' in a conclusion", "a term")
            hedges = (*before, *reversed(words))
            before = hedges if self.words.hedges_last_on else ()
            term = self.term(variable)
            found[variable.index] = Conclusion(variable.index, term, hedges, hedged.offset)
            if not self.stream.accept(*self.words.separators):
                return tuple(found.values())

    def variable(self, is_input: bool | None) -> Names:
        """is_input: None where it may be either."""
        kind = "an output" if is_input is False else "an input"
        token = self.name(f"the name of {kind}")
        found = self.names.get(self.key(token))
        if found is None or is_input not in (None, found.is_input):
            wanted = is_input is not False
            known = ", ".join(v.shown for v in self.names.values() if v.is_input == wanted)
            what = "no variable" if found is None else f"not {kind}:"
            raise self.stream.source.error(token, f"{what} {token.shown()}", f"one of {known}")
        return found

    def term(self, variable: Names) -> int:
        token = self.name(f"a term of {variable.shown}")
        found = variable.terms.get(self.key(token))
        if not variable.terms:
            raise self.stream.source.error(token, f"{variable.shown} has no terms", "terms")
        if found is None:
            terms = ", ".join(variable.shown_terms)
            raise self.stream.source.error(
                token, f"{variable.shown} has no term {token.shown()}", f"one of {terms}"
            )
        return found

    def name(self, expected: str) -> Token:
        token = self.stream.token
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
        merged += part.parts if same else [part]  # type: ignore[union-attr]
    return merged[0] if len(merged) == 1 else Join(connective, tuple(merged))


def complement(expression: Expression) -> Expression:
    """Of a condition: one that is negated once more."""
    if isinstance(expression, Complement):
        return expression.part
    return Complement(expression)


def uses(expression: Expression, connective: str) -> bool:
    if isinstance(expression, Proposition):
        return False
    if isinstance(expression, Complement):
        return uses(expression.part, connective)
    return expression.connective == connective or any(
        uses(part, connective) for part in expression.parts
    )
