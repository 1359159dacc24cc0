"""From what a rule file says to a RuleBase: everything that the formats have to check alike."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from quiesce.rules.formats.logic import Names
from quiesce.rules.formats.scan import Source, Token
from quiesce.rules.formats.shapes import Curve, Shape, ShapeError, chain
from quiesce.rules.model import (
    CENTROID,
    MAX_INPUTS,
    MAX_OUTPUTS,
    MAX_RULES,
    MAX_SETS,
    MAX_SINGLETONS,
    FuzzySet,
    Input,
    Output,
    Point,
    Rule,
    RuleBase,
    Singleton,
)

MAX_POINTS = 256  # of a set
MAX_NAME = 64  # characters
FORBIDDEN = re.compile(r"[\"'\\*%#]")  # in names: they end texts and comments, here and in C


@dataclass(frozen=True)
class Smooth:
    """A curve that --approximate may replace. word: what the file calls it."""

    word: str
    curve: Curve
    height: float


@dataclass(frozen=True)
class Line:
    """A term of first order: constant + sum of slopes x inputs."""

    slopes: tuple[float, ...]
    constant: float


# What a file says of a term: points, a singleton's value, a smooth curve, or a straight line.
Content = tuple[Point, ...] | float | Smooth | Line


@dataclass(frozen=True)
class Term:
    name: Token
    at: Token  # where its shape begins
    content: Content


@dataclass
class Variable:
    """An input or output while its file is being read."""

    name: Token
    is_input: bool
    terms: list[Term] = field(default_factory=list)
    low: float | None = None
    high: float | None = None
    range_at: Token | None = None
    method: str = ""
    method_at: Token | None = None
    default: float | None = None
    default_at: Token | None = None

    @property
    def kind(self) -> str:
        return "input" if self.is_input else "output"

    def shown(self) -> str:
        return f"{self.kind} {self.name.text}"


@dataclass(frozen=True)
class Options:
    """approximate: straight segments that may stand for a smooth shape, None: none may.
    first_order: singletons may have slopes."""

    approximate: int | None = None
    first_order: bool = False


class Builder:
    """Collects the variables of one file and makes the checked model of them."""

    def __init__(self, source: Source, options: Options, ignore_case: bool = False) -> None:
        self.source = source
        self.options = options
        self.ignore_case = ignore_case
        self.variables: list[Variable] = []
        self.notes: list[str] = []

    def key(self, token: Token) -> str:
        return token.text.upper() if self.ignore_case else token.text

    def add_variable(self, name: Token, is_input: bool) -> Variable:
        self.check_name(name, [v.name for v in self.variables], "variable")
        variable = Variable(name, is_input)
        self.variables.append(variable)
        most = MAX_INPUTS if is_input else MAX_OUTPUTS
        if len(self.of_kind(is_input)) > most:
            raise self.source.error(name, f"more than {most} {variable.kind}s", f"at most {most}")
        return variable

    def add_term(self, variable: Variable, term: Term) -> None:
        self.check_name(term.name, [t.name for t in variable.terms], "term")
        variable.terms.append(term)
        is_set = variable.is_input or not isinstance(term.content, (float, Line))
        most = MAX_SETS if is_set else MAX_SINGLETONS
        if len(variable.terms) > most:
            raise self.source.error(
                term.name, f"more than {most} terms of {variable.shown()}", f"at most {most}"
            )

    def check_name(self, name: Token, others: Sequence[Token], what: str) -> None:
        if not name.text.strip() or len(name.text) > MAX_NAME:
            raise self.source.error(name, f"{what} name of {len(name.text)} characters", "1 to 64")
        if FORBIDDEN.search(name.text):
            raise self.source.error(name, f"{what} {name.shown()}", "a name without ' \" \\ * % #")
        if self.key(name) in [self.key(other) for other in others]:
            raise self.source.error(name, f"{what} {name.shown()} again", "a new name")

    def of_kind(self, is_input: bool) -> list[Variable]:
        return [v for v in self.variables if v.is_input == is_input]

    def set_range(self, variable: Variable, at: Token, low: float, high: float) -> None:
        if not low < high:
            raise self.source.error(at, f"range {low:g} .. {high:g}", "minimum < maximum")
        variable.low, variable.high, variable.range_at = low, high, at

    def names(self) -> dict[str, Names]:
        """Of all variables, for the rules."""
        found = {}
        for is_input in (True, False):
            for index, variable in enumerate(self.of_kind(is_input)):
                self.check_terms(variable)
                terms = {self.key(term.name): i for i, term in enumerate(variable.terms)}
                shown = tuple(term.name.text for term in variable.terms)
                found[self.key(variable.name)] = Names(
                    is_input, index, terms, variable.name.text, shown
                )
        return found

    def points(self, at: Token, points: Sequence[Point], ats: Sequence[Token]) -> tuple[Point, ...]:
        """Checked; ats: one token for each point. Equal neighbours become one."""
        kept: list[Point] = []
        for (x, mu), token in zip(points, ats, strict=True):
            if not 0 <= mu <= 1:
                raise self.source.error(token, f"membership {mu:g}", "0 to 1")
            if kept and x < kept[-1][0]:
                raise self.source.error(token, f"point {x:g} after {kept[-1][0]:g}", "ascending x")
            if not kept or (x, mu) != kept[-1]:
                kept.append((x, mu))
            if len(kept) > 2 and kept[-3][0] == x:
                raise self.source.error(token, f"a third point at {x:g}", "at most two")
        if not 1 <= len(kept) <= MAX_POINTS:
            raise self.source.error(at, f"{len(kept)} points", f"1 to {MAX_POINTS}")
        return tuple(kept)

    def shape(
        self, at: Token, shape: Shape, values: Sequence[float], height: float = 1.0
    ) -> tuple[Point, ...] | Smooth:
        """at: the shape's name in the file."""
        try:
            made = shape(values)
        except ShapeError as error:
            raise self.source.error(at, f"{at.text} of {numbers(values)}", str(error))
        if callable(made):
            return Smooth(at.text, made, height)
        return tuple((x, height * mu) for x, mu in made)

    def linear(self, at: Token, values: Sequence[float]) -> float | Line:
        """A first-order term: one whose slopes are all 0 is a constant, its last number."""
        count = len(self.of_kind(is_input=True)) + 1
        if len(values) != count:
            raise self.source.error(at, f"{len(values)} numbers of {at.text}", f"{count}")
        if not any(values[:-1]):
            return values[-1]
        if not self.options.first_order:
            raise self.source.error(at, f"{at.text} of {numbers(values)}", "slopes of 0")
        return Line(tuple(values[:-1]), values[-1])

    def finish(
        self, name: str, at: Token, make_rules: Callable[[Sequence[Output]], list[Rule]]
    ) -> RuleBase:
        """at: where a message about the whole file points; make_rules: from the outputs."""
        for is_input in (True, False):
            if not self.of_kind(is_input):
                kind = "input" if is_input else "output"
                raise self.source.error(at, f"no {kind}", f"at least one {kind}")
        inputs = tuple(self.input(variable) for variable in self.of_kind(True))
        outputs = tuple(self.output(variable) for variable in self.of_kind(False))
        rules = make_rules(outputs)
        if not rules:
            raise self.source.error(at, "no rules", "at least one rule")
        if len(rules) > MAX_RULES:
            raise self.source.error(at, f"{len(rules)} rules", f"at most {MAX_RULES}")
        return RuleBase(name, inputs, outputs, tuple(rules), tuple(self.notes))

    def input(self, variable: Variable) -> Input:
        low, high = self.universe(variable)
        return Input(variable.name.text, low, high, self.sets(variable, low, high))

    def output(self, variable: Variable) -> Output:
        low, high = self.universe(variable)
        if variable.method == CENTROID:
            terms: tuple = self.sets(variable, low, high)
        else:
            terms = self.singletons(variable, low, high)
        default, at = variable.default, variable.default_at
        if default is not None and not low <= default <= high:
            raise self.source.error(
                at or variable.name, f"default {default:g}", f"one within {low:g} .. {high:g}"
            )
        return Output(variable.name.text, low, high, terms, variable.method, default)

    def check_terms(self, variable: Variable) -> None:
        if not variable.terms:
            raise self.source.error(variable.name, f"{variable.shown()} has no terms", "terms")

    def universe(self, variable: Variable) -> tuple[float, float]:
        self.check_terms(variable)
        if variable.low is not None and variable.high is not None:
            return variable.low, variable.high
        x = extents(variable.terms)
        if not x or min(x) == max(x):
            raise self.source.error(variable.name, f"{variable.shown()} has no range", "a range")
        self.notes.append(
            f"{variable.shown()}: no range given; {min(x):g} .. {max(x):g}, the extent of its terms"
        )
        return min(x), max(x)

    def sets(self, variable: Variable, low: float, high: float) -> tuple[FuzzySet, ...]:
        return tuple(self.set(variable, term, low, high) for term in variable.terms)

    def set(self, variable: Variable, term: Term, low: float, high: float) -> FuzzySet:
        content = term.content
        if isinstance(content, (float, Line)):
            raise self.source.error(
                term.at, f"{variable.shown()} has a singleton", "a set: a method with points"
            )
        if isinstance(content, Smooth):
            content = self.approximated(variable, term, content, low, high)
        made = FuzzySet(term.name.text, content)
        if not is_above_zero(made, low, high):
            raise self.source.error(
                term.name,
                f"set {made.name} is 0 everywhere in {low:g} .. {high:g}, or all but single points",
                "a set inside the range",
            )
        return made

    def approximated(
        self, variable: Variable, term: Term, smooth: Smooth, low: float, high: float
    ) -> tuple[Point, ...]:
        segments = self.options.approximate
        if segments is None:
            raise self.source.error(
                term.at,
                f"{smooth.word} is not made of straight lines",
                "'--approximate N', which takes a chain of N segments for it, or a straight shape",
            )
        try:
            points, error = chain(smooth.curve, low, high, segments)
        except ShapeError as problem:
            what = f"{smooth.word} over {low:g} .. {high:g}"
            raise self.source.error(term.at, what, str(problem))
        self.notes.append(
            f"{variable.shown()}, set {term.name.text}: {smooth.word} as a chain of "
            f"{len(points) - 1} segments, largest error {smooth.height * error:.2g}"
        )
        return tuple((x, smooth.height * mu) for x, mu in points)

    def singletons(self, variable: Variable, low: float, high: float) -> tuple[Singleton, ...]:
        return tuple(self.singleton(variable, term, low, high) for term in variable.terms)

    def singleton(self, variable: Variable, term: Term, low: float, high: float) -> Singleton:
        """A straight line's values are bounded by nothing that a file says."""
        content = term.content
        if isinstance(content, Line):
            return Singleton(term.name.text, content.constant, content.slopes)
        if not isinstance(content, float):
            raise self.source.error(
                term.at, f"{variable.shown()} has a set", "a singleton: a weighted average"
            )
        if not low <= content <= high:
            raise self.source.error(
                term.at, f"singleton {content:g}", f"one within {low:g} .. {high:g}"
            )
        return Singleton(term.name.text, content)


def numbers(values: Sequence[float]) -> str:
    return ", ".join(f"{value:g}" for value in values)


def extents(terms: Sequence[Term]) -> list[float]:
    """All x that the terms name."""
    x: list[float] = []
    for term in terms:
        if isinstance(term.content, float):
            x.append(term.content)
        elif isinstance(term.content, tuple):
            x += [at for at, _ in term.content]
    return x


def is_above_zero(one: FuzzySet, low: float, high: float) -> bool:
    """Whether the set covers more than single points of the universe."""
    inside = sorted({low, high, *(x for x, _ in one.points if low < x < high)})
    return any(
        one.membership(a + 0.5 * (b - a)) > 0 for a, b in zip(inside, inside[1:], strict=False)
    )
