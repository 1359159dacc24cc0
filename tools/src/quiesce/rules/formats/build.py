"""From what a rule file says to a plain RuleBase, or to a System: what the formats check alike.

A reader refuses what is no rule file. What it reads and a plain rule base cannot hold it notes as
the reason why (Builder.not_plain).
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.rules.formats.formula import Formula
from quiesce.rules.formats.logic import Draft, Names
from quiesce.rules.formats.plain import plain_rules
from quiesce.rules.formats.scan import MAX_NUMBER, Source, Token
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
    RuleBase,
    Singleton,
    membership_of,
)
from quiesce.rules.system import model
from quiesce.rules.system.model import Block, System, SystemInput, SystemOutput, SystemRule
from quiesce.rules.system.norms import MAXIMUM, MINIMUM

MAX_POINTS = 256  # of a set
MAX_NAME = 64  # characters
LEAST_RANGE = 1e-12  # of the larger end, and that is at least so much
ENDLESS = ("Ramp", "rampmf")  # that go on beyond their height
ASIDE = 1e-8  # of a place at which a formula is no number
NEAREST = 2.0**-52  # of a strength to 0 or 1, of a shape that only rises or falls
FORBIDDEN = re.compile(r"[\"'\\*%#]")  # in names: they end texts and comments, here and in C


class NotPlain(UsageError):
    """A rule file that a plain rule base cannot hold; says why."""


@dataclass(frozen=True)
class Straight:
    """Points. word: what the file calls it; inverse: of one that only rises or falls, less its
    height, x of a membership."""

    word: str
    points: tuple[Point, ...]
    height: float = 1.0
    inverse: Curve | None = None
    origin: model.Origin | None = None


@dataclass(frozen=True)
class Smooth:
    """A curve that --approximate may replace."""

    word: str
    curve: Curve
    height: float
    knots: tuple[float, ...] = ()
    inverse: Curve | None = None
    origin: model.Origin | None = None


@dataclass(frozen=True)
class Line:
    """A term of first order: constant + sum of slopes x inputs."""

    word: str
    slopes: tuple[float, ...]
    constant: float


# What a file says of a term.
Content = Straight | Smooth | float | Line | Formula


@dataclass(frozen=True)
class Term:
    name: Token
    at: Token  # where its shape begins
    content: Content


@dataclass
class Variable:
    """An input or output while its file is being read. method: of a plain base; the next four: of
    a system."""

    name: Token
    is_input: bool
    terms: list[Term] = field(default_factory=list)
    low: float | None = None
    high: float | None = None
    range_at: Token | None = None
    method: str = ""
    method_at: Token | None = None
    system_method: str = ""
    aggregation: str = MAXIMUM
    places: int = 0
    clips: bool = False
    inverts: bool = True  # sets of a weighted output are Tsukamoto's where they can be
    infers_type: bool = False  # all its terms are of one type
    sums_terms: bool = False  # a weighted sum adds up terms, not rules
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
        self.plain_notes: list[str] = []  # of a plain base only
        self.blocks: list[Block] = []
        self.drafts: list[Draft] = []
        self.reasons: list[UsageError] = []  # why it is no plain base

    def not_plain(self, at: Token | int, what: str, expected: str = "") -> None:
        self.reasons.append(self.source.error(at, what, expected))

    def key(self, token: Token) -> str:
        return token.text.upper() if self.ignore_case else token.text

    def add_variable(self, name: Token, is_input: bool) -> Variable:
        self.check_name(name, [v.name for v in self.variables], "variable")
        variable = Variable(name, is_input)
        self.variables.append(variable)
        plain, most = (
            (MAX_INPUTS, model.MAX_INPUTS) if is_input else (MAX_OUTPUTS, model.MAX_OUTPUTS)
        )
        count, kind = len(self.of_kind(is_input)), f"{variable.kind}s"
        if count > most:
            raise self.source.error(name, f"more than {most} {kind}", f"at most {most}")
        if count > plain:
            self.not_plain(name, f"more than {plain} {kind}", f"at most {plain}")
        return variable

    def add_term(self, variable: Variable, term: Term) -> None:
        self.check_name(term.name, [t.name for t in variable.terms], "term")
        variable.terms.append(term)
        is_set = variable.is_input or not isinstance(term.content, (float, Line))
        plain, most = (MAX_SETS, model.MAX_TERMS) if is_set else (MAX_SINGLETONS, model.MAX_VALUES)
        count, of = len(variable.terms), f"terms of {variable.shown()}"
        if count > most:
            raise self.source.error(term.name, f"more than {most} {of}", f"at most {most}")
        if count > plain:
            self.not_plain(term.name, f"more than {plain} {of}", f"at most {plain}")

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
                if variable.terms or not is_input:
                    self.check_terms(variable)
                else:
                    self.not_plain(variable.name, f"{variable.shown()} has no terms", "terms")
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
    ) -> Straight | Smooth:
        """at: the shape's name in the file."""
        try:
            made = shape(values)
        except ShapeError as error:
            raise self.source.error(at, f"{at.text} of {numbers(values)}", str(error))
        ordered = shape.ordered(values)
        inverse = None if shape.inverse is None else shape.inverse(*ordered)
        origin = model.Origin(shape.make, tuple(ordered), height)
        if callable(made):
            return Smooth(at.text, made, height, shape.knots(*ordered), inverse, origin)
        points = tuple((x, height * mu) for x, mu in made)
        return Straight(at.text, points, height, inverse, origin)

    def linear(self, at: Token, values: Sequence[float]) -> float | Line:
        """A first-order term: one whose slopes are all 0 is a constant, its last number."""
        count = len(self.of_kind(is_input=True)) + 1
        if len(values) != count:
            raise self.source.error(at, f"{len(values)} numbers of {at.text}", f"{count}")
        return Line(at.text, tuple(values[:-1]), values[-1]) if any(values[:-1]) else values[-1]

    def check(self, at: Token) -> None:
        """at: where a message about the whole file points."""
        for is_input in (True, False):
            if not self.of_kind(is_input):
                kind = "input" if is_input else "output"
                raise self.source.error(at, f"no {kind}", f"at least one {kind}")
        if not self.drafts:
            raise self.source.error(at, "no rules", "at least one rule")
        inputs = len(self.of_kind(is_input=True))
        for variable in self.of_kind(is_input=False):
            for term in variable.terms:
                if isinstance(term.content, Line) and len(term.content.slopes) != inputs:
                    count = len(term.content.slopes) + 1
                    what = f"{count} numbers of {term.content.word}"
                    raise self.source.error(term.at, what, f"{inputs + 1}")
            low, high = self.universe(variable)
            default = variable.default
            if default is not None and not low <= default <= high:
                raise self.source.error(
                    variable.default_at or variable.name,
                    f"default {default:g}",
                    f"one within {low:g} .. {high:g}",
                )

    def plain(self, name: str, at: Token) -> RuleBase:
        """NotPlain where it is none."""
        self.check(at)
        if self.reasons:
            raise NotPlain(str(self.reasons[0]))
        try:
            return self.made_plain(name, at)
        except UsageError as reason:
            raise NotPlain(str(reason)) from reason

    def made_plain(self, name: str, at: Token) -> RuleBase:
        inputs = tuple(self.input(variable) for variable in self.of_kind(True))
        outputs = tuple(self.output(variable) for variable in self.of_kind(False))
        names = list(self.names().values())
        rules = [rule for d in self.drafts for rule in plain_rules(self.source, d, outputs, names)]
        if len(rules) > MAX_RULES:
            raise self.source.error(at, f"{len(rules)} rules", f"at most {MAX_RULES}")
        notes = (*self.notes, *self.plain_notes)
        return RuleBase(name, inputs, outputs, tuple(rules), notes)

    def input(self, variable: Variable) -> Input:
        low, high = self.universe(variable)
        return Input(variable.name.text, low, high, self.sets(variable, low, high))

    def output(self, variable: Variable) -> Output:
        low, high = self.universe(variable)
        if variable.method == CENTROID:
            terms: tuple = self.sets(variable, low, high)
        else:
            terms = self.singletons(variable, low, high)
        return Output(variable.name.text, low, high, terms, variable.method, variable.default)

    def check_terms(self, variable: Variable) -> None:
        if not variable.terms:
            raise self.source.error(variable.name, f"{variable.shown()} has no terms", "terms")

    def universe(self, variable: Variable) -> tuple[float, float]:
        if variable.low is not None and variable.high is not None:
            return variable.low, variable.high
        self.check_terms(variable)
        x = extents(variable.terms)
        if not x or min(x) == max(x):
            raise self.source.error(variable.name, f"{variable.shown()} has no range", "a range")
        note = (
            f"{variable.shown()}: no range given; {min(x):g} .. {max(x):g}, the extent of its terms"
        )
        if note not in self.notes:
            self.notes.append(note)
        return min(x), max(x)

    def sets(self, variable: Variable, low: float, high: float) -> tuple[FuzzySet, ...]:
        return tuple(self.set(variable, term, low, high) for term in variable.terms)

    def set(self, variable: Variable, term: Term, low: float, high: float) -> FuzzySet:
        content = self.set_content(variable, term)
        if isinstance(content, Formula):
            raise self.source.error(term.at, "a formula", "a shape")
        points = (
            self.approximated(variable, term, content, low, high)
            if isinstance(content, Smooth)
            else content.points
        )
        made = FuzzySet(term.name.text, points)
        if not is_above_zero(made, low, high):
            raise self.source.error(
                term.name,
                f"set {made.name} is 0 everywhere in {low:g} .. {high:g}, or all but single points",
                "a set inside the range",
            )
        return made

    def set_content(self, variable: Variable, term: Term) -> Straight | Smooth | Formula:
        if isinstance(term.content, (float, Line)):
            raise self.source.error(
                term.at, f"{variable.shown()} has a singleton", "a set: a method with points"
            )
        return term.content

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
        self.plain_notes.append(
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
            if not self.options.first_order:
                values = numbers((*content.slopes, content.constant))
                raise self.source.error(term.at, f"{content.word} of {values}", "slopes of 0")
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

    # ---- systems --------------------------------------------------------------------------------

    def system(self, name: str, at: Token) -> System:
        """UsageError where a system cannot hold it either."""
        self.check(at)
        inputs = tuple(self.system_input(variable) for variable in self.of_kind(True))
        outputs = tuple(self.system_output(variable) for variable in self.of_kind(False))
        rules = tuple(
            SystemRule(d.block, d.expression, d.conclusions, d.weight) for d in self.drafts
        )
        if len(rules) > model.MAX_RULES:
            raise self.source.error(at, f"{len(rules)} rules", f"at most {model.MAX_RULES}")
        blocks = tuple(self.blocks) or (Block(MINIMUM, MAXIMUM, MINIMUM),)
        return System(name, inputs, outputs, blocks, rules, tuple(self.notes))

    def wide_universe(self, variable: Variable) -> tuple[float, float]:
        """One that integers can divide."""
        low, high = self.universe(variable)
        if high - low < LEAST_RANGE * max(abs(low), abs(high), LEAST_RANGE):
            at = variable.range_at or variable.name
            raise self.source.error(at, f"range {low:g} .. {high:g}", "a wider one")
        return low, high

    def system_input(self, variable: Variable) -> SystemInput:
        low, high = self.wide_universe(variable)
        terms = tuple(self.set_term(variable, term) for term in variable.terms)
        return SystemInput(variable.name.text, low, high, terms)

    def system_output(self, variable: Variable) -> SystemOutput:
        low, high = self.wide_universe(variable)
        self.check_weighted(variable)
        is_sets = variable.system_method in model.SET_METHODS
        make = self.set_term if is_sets else self.value_term
        terms = tuple(make(variable, term) for term in variable.terms)
        return SystemOutput(
            variable.name.text, low, high, terms, variable.system_method, variable.aggregation,
            variable.places, variable.default, variable.clips,
        )  # fmt: skip

    def check_weighted(self, variable: Variable) -> None:
        """What FuzzyLite refuses, or answers otherwise."""
        at = variable.method_at or variable.name
        kinds = {kind_of(term.content) for term in variable.terms}
        if variable.infers_type and len(kinds) > 1:
            what = f"{variable.shown()} has terms of several types"
            raise self.source.error(at, what, "one, or 'TakagiSugeno' or 'Tsukamoto'")
        index = self.of_kind(is_input=False).index(variable)
        terms = [c.term for d in self.drafts for c in d.conclusions if c.output == index]
        if variable.sums_terms and len(terms) != len(set(terms)):
            what = f"{variable.shown()}: a weighted sum with aggregation {variable.aggregation}"
            raise self.source.error(at, f"{what}, and two rules of a term", "aggregation: none")

    def set_term(self, variable: Variable, term: Term) -> model.SetTerm:
        return model.SetTerm(term.name.text, self.curve_of(variable, term))

    def curve_of(self, variable: Variable, term: Term) -> model.Curve:
        content = self.set_content(variable, term)
        if isinstance(content, Straight):
            points = content.points
            return model.Curve(
                content.word, lambda x: membership_of(points, x), points, (), content.origin
            )
        if isinstance(content, Formula):
            return formula_curve(content, self.formula_of_x(term, content))
        curve, height = content.curve, content.height
        return model.Curve(
            content.word, lambda x: height * curve(x), None, content.knots, content.origin
        )

    def formula_of_x(self, term: Term, formula: Formula) -> model.Function:
        if formula.names - {"x"}:
            shown = ", ".join(sorted(formula.names - {"x"}))
            raise self.source.error(term.at, f"a formula with {shown}", "a formula of x")
        return lambda x: formula({"x": x})

    def value_term(self, variable: Variable, term: Term) -> model.ValueTerm:
        name, content = term.name.text, term.content
        if isinstance(content, float):
            return model.ConstantTerm(name, content)
        if isinstance(content, Line):
            return model.LinearTerm(name, content.slopes, content.constant)
        if isinstance(content, Formula):
            own = self.of_kind(is_input=False).index(variable)
            return self.formula_term(term, content, own)
        is_inverse = content.inverse is not None and variable.inverts
        return model.StrengthTerm(name, self.tsukamoto_of(variable, term, content), is_inverse)

    def tsukamoto_of(
        self, variable: Variable, term: Term, content: Straight | Smooth
    ) -> model.Curve:
        """A set that only rises or falls: where it reaches the strength; any other one: its
        membership there, as FuzzyLite has it."""
        inverse, height = content.inverse, content.height
        if inverse is None or not variable.inverts:
            return self.curve_of(variable, term)

        def value(strength: np.ndarray) -> np.ndarray:
            # At 0 and 1 some shapes have no end.
            top = np.inf if content.word in ENDLESS else 1.0 - NEAREST
            return inverse(np.clip(strength / height, NEAREST, top))

        return model.Curve(content.word, value, None, (0.5 * height,), content.origin)

    def formula_term(self, term: Term, formula: Formula, own: int) -> model.ValueTerm:
        name = term.name.text
        inputs = {v.name.text: i for i, v in enumerate(self.of_kind(is_input=True))}
        used = formula.names & set(inputs)
        if not formula.names:
            value = float(formula({}))
            if not abs(value) <= MAX_NUMBER:
                raise self.source.error(term.at, "a formula that is no number", "a number")
            return model.ConstantTerm(name, value)
        if formula.names == {"x"} and "x" not in inputs:
            return model.StrengthTerm(name, formula_curve(formula, lambda x: formula({"x": x})))
        if len(used) == 1 and formula.names == used:
            (only,) = used
            function = lambda x: filled(lambda at: formula({only: at}), x)  # noqa: E731
            return model.InputTerm(name, inputs[only], formula_curve(formula, function))
        return self.formula_of_several(term, formula, inputs, own)

    def formula_of_several(
        self, term: Term, formula: Formula, inputs: dict[str, int], own: int
    ) -> model.FormulaTerm:
        """own: number of the term's output; only outputs before it have their values."""
        outputs = {v.name.text: i for i, v in enumerate(self.of_kind(is_input=False))}
        before = {name: i for name, i in outputs.items() if i < own}
        unknown = sorted(formula.names - set(inputs) - set(before))
        if unknown:
            known = ", ".join((*inputs, *before))
            raise self.source.error(
                term.at,
                f"a formula with {', '.join(unknown)}",
                f"inputs and outputs before it: {known}",
            )
        return model.FormulaTerm(
            term.name.text,
            formula.tree,
            tuple((one, i) for one, i in inputs.items() if one in formula.names),
            tuple((one, i) for one, i in before.items() if one in formula.names),
        )


def formula_curve(formula: Formula, function: model.Function) -> model.Curve:
    return model.Curve("Function", function, origin=model.Origin(tree=formula.tree))


def filled(function: model.Function, x: np.ndarray) -> np.ndarray:
    """A formula that is no number at a single place, as sin(x)/x at 0, has its limit there."""
    x = np.asarray(x, dtype=float)
    values = np.broadcast_to(np.asarray(function(x), dtype=float), x.shape)
    aside = ASIDE * np.maximum(np.abs(x), 1.0)
    beside = [np.broadcast_to(function(x + sign * aside), x.shape) for sign in (-1.0, 1.0)]
    is_hole = ~np.isfinite(values) & np.isclose(*beside, rtol=1e-6, atol=1e-6)
    return np.where(is_hole, 0.5 * (beside[0] + beside[1]), values)


def kind_of(content: Content) -> str:
    """Of a term of a weighted output: constant, straight line or formula; one that rises or falls;
    any other set."""
    if isinstance(content, float | Line | Formula):
        return "value"
    return "other" if content.inverse is None else "monotonic"


def numbers(values: Sequence[float]) -> str:
    return ", ".join(f"{value:g}" for value in values)


def extents(terms: Sequence[Term]) -> list[float]:
    """All x that the terms name."""
    x: list[float] = []
    for term in terms:
        if isinstance(term.content, float):
            x.append(term.content)
        elif isinstance(term.content, Straight):
            x += [at for at, _ in term.content.points]
    return x


def is_above_zero(one: FuzzySet, low: float, high: float) -> bool:
    """Whether the set covers more than single points of the universe."""
    inside = sorted({low, high, *(x for x, _ in one.points if low < x < high)})
    return any(
        one.membership(a + 0.5 * (b - a)) > 0 for a, b in zip(inside, inside[1:], strict=False)
    )
