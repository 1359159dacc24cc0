"""Reads FIS, the files of MATLAB's Fuzzy Logic Toolbox, with words of FuzzyLite's dialect.

Comments begin with % as in MATLAB or # as in Octave.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from quiesce.rules.formats.build import (
    Builder,
    Content,
    Formula,
    Line,
    Options,
    Straight,
    Term,
    Variable,
)
from quiesce.rules.formats.formula import read_formula
from quiesce.rules.formats.logic import Draft, checked_weight, uses
from quiesce.rules.formats.norm_words import FIS_S_NORMS, FIS_T_NORMS
from quiesce.rules.formats.scan import (
    END,
    INFINITE_PATTERN,
    MAX_NUMBER,
    NAME,
    NUMBER,
    NUMBER_PATTERN,
    STRING,
    WORD_PATTERN,
    Source,
    Stream,
    Token,
    scan,
)
from quiesce.rules.formats.shapes import FIS_SHAPES, SHOULDERS, Shape
from quiesce.rules.model import AND, CENTROID, OR, WEIGHTED_SUM
from quiesce.rules.system import model
from quiesce.rules.system.model import Block, Conclusion, Expression, Join, Proposition
from quiesce.rules.system.norms import ANY, MAXIMUM, MINIMUM, NOT

PATTERN = re.compile(
    rf"\s+|(?P<number>{NUMBER_PATTERN}|{INFINITE_PATTERN})|(?P<name>{WORD_PATTERN})|(?P<string>'[^'\n]*'|\"[^\"\n]*\")"
    r"|(?P<unclosed>['\"])|(?P<symbol>[\[\]=(),:]|[-+*/^%](?=[^\[\]\n]*\]))"
)
SYSTEM, RULES = "System", "Rules"
COUNTS = ("NumInputs", "NumOutputs", "NumRules")
DEFUZZIFIERS = {
    "centroid": model.CENTROID, "bisector": model.BISECTOR, "mom": model.MEAN,
    "lom": model.LARGEST, "som": model.SMALLEST, "wtaver": model.BY_RULE,
    "wtsum": model.WEIGHTED,
}  # fmt: skip
METHODS = {
    "AndMethod": FIS_T_NORMS,
    "OrMethod": FIS_S_NORMS,
    "ImpMethod": FIS_T_NORMS,
    "AggMethod": FIS_S_NORMS,
    "DefuzzMethod": DEFUZZIFIERS,
}
TYPES = ("mamdani", "sugeno", "larsen", "tsukamoto", "inverse tsukamoto", "hybrid", "unknown")
# What a plain base has of each type. Sugeno systems use neither implication nor aggregation.
PLAIN = {
    "mamdani": {"ImpMethod": "min", "AggMethod": "max", "DefuzzMethod": "centroid"},
    "sugeno": {"DefuzzMethod": "wtaver"},
}
# Decimals of a term's number in a rule, in hundredths, as Octave has them; FuzzyLite writes others
# of the same names.
HEDGES = {5: ("somewhat",), 20: ("very",), 30: ("cubed",), 40: ("very", "very")}
FUZZYLITE_HEDGES = {
    **HEDGES, 1: ("seldom",), 30: ("extremely",), 99: (ANY,),
}  # fmt: skip
PLACES = 1000  # of sets that are looked at
SYSTEM_KEYS = ("Name", "Type", "Version", *COUNTS, *METHODS)


@dataclass
class Section:
    """head: what stands in brackets; lines: tokens of each, an END last."""

    head: Token
    lines: list[list[Token]] = field(default_factory=list)


def read_fis(source: Source, name: str, options: Options) -> tuple[Builder, str, Token]:
    """name: of the base where the file gives it none. Returns with it and where it begins."""
    return FisReader(source, options).read(name)


def split_sections(source: Source) -> list[Section]:
    sections: list[Section] = []
    for start, line_end in source.lines():
        end = start + len(re.split("[%#]", source.text[start:line_end])[0].rstrip())
        tokens = scan(source, PATTERN, start, end)
        stream = Stream(source, tokens)
        if stream.token.kind == END:
            continue
        if stream.sees("[") or not sections:
            sections.append(Section(head_of(stream)))
        else:
            sections[-1].lines.append(tokens)
    return sections


def head_of(stream: Stream) -> Token:
    stream.expect("[", after=" and a section, such as '[System]'")
    token = stream.expect_kind(NAME, "the name of a section")
    stream.expect("]")
    if stream.token.kind != END:
        raise stream.unexpected("the end of the line")
    return token


class FisReader:
    """of_system, of_output: keys besides those that every variable has."""

    of_system: tuple[str, ...] = SYSTEM_KEYS
    of_output: tuple[str, ...] = ("Enabled", "Default", "LockPrevious", "LockRange")
    is_term = re.compile("MF[0-9]+")

    def __init__(self, source: Source, options: Options) -> None:
        self.source = source
        self.builder = Builder(source, options)
        self.title: Token | None = None
        self.type: Token | None = None
        self.methods: dict[str, Token] = {}
        self.counts: dict[str, Token] = {}
        self.rule_lines: list[list[Token]] | None = None
        head = source.text[: source.starts[min(3, len(source.starts) - 1)]]
        self.is_from_fuzzylite = "fuzzylite" in head

    def read(self, name: str) -> tuple[Builder, str, Token]:
        sections = split_sections(self.source)
        if not sections:
            raise self.source.error(0, "no section", "'[System]'")
        first = sections[0].head
        if first.text != SYSTEM:
            raise self.source.error(first, f"found {first.shown()}", "'[System]' first")
        self.system(sections[0])
        for section in sections[1:]:
            self.section(section)
        self.check_complete(first)
        self.check_counts()
        drafts = [draft for line in self.rule_lines or [] for draft in self.drafts(line)]
        for draft in drafts:
            self.check_operator(draft, AND, "AndMethod", "min")
            self.check_operator(draft, OR, "OrMethod", "max")
        self.builder.drafts += drafts
        self.builder.blocks.append(
            Block(
                self.norm("AndMethod", MINIMUM),
                self.norm("OrMethod", MAXIMUM),
                self.norm("ImpMethod", MINIMUM),
            )
        )
        title = self.title.text if self.title and self.title.text else name
        return self.builder, title, first

    def norm(self, key: str, otherwise: str) -> str:
        token = self.methods.get(key)
        return METHODS[key][token.text] if token else otherwise

    def section(self, section: Section) -> None:
        head = section.head
        if head.text == RULES:
            if self.rule_lines is not None:
                raise self.source.error(head, "a second [Rules]", "one")
            self.rule_lines = section.lines
            return
        inputs = len(self.builder.of_kind(is_input=True))
        outputs = len(self.builder.of_kind(is_input=False))
        allowed = {f"Input{inputs + 1}": True, f"Output{outputs + 1}": False}
        if head.text not in allowed:
            words = ", ".join(f"[{word}]" for word in (*allowed, RULES))
            raise self.source.error(head, f"section {head.shown()}", f"one of {words}")
        self.variable(section, is_input=allowed[head.text])

    def entries(self, section: Section, allowed: Sequence[str]) -> dict[str, Stream]:
        """Of each key its line, behind the `=`. MF stands for MF1, MF2 and so on."""
        found: dict[str, Stream] = {}
        for tokens in section.lines:
            stream = Stream(self.source, tokens)
            key = stream.expect_kind(NAME, "'KEY=VALUE'")
            is_term = "MF" in allowed and self.is_term.fullmatch(key.text)
            if key.text not in allowed and not is_term:
                words = ", ".join(allowed)
                raise self.source.error(key, f"no key {key.shown()} here", f"one of {words}")
            if key.text in found:
                raise self.source.error(key, f"{key.shown()} again", "it once")
            stream.expect("=")
            found[key.text] = stream
        return found

    def finish_line(self, stream: Stream) -> None:
        if stream.token.kind != END:
            raise stream.unexpected("the end of the line")

    def text(self, stream: Stream, what: str) -> Token:
        token = stream.expect_kind(STRING, what)
        return Token(STRING, token.text[1:-1], token.offset)

    def system(self, section: Section) -> None:
        for key, stream in self.entries(section, self.of_system).items():
            if key in COUNTS:
                self.counts[key] = stream.expect_kind(NUMBER, "a number")
            elif key == "Version":
                stream.number()
            else:
                self.system_text(key, self.text(stream, "text in quotes"))
            self.finish_line(stream)

    def system_text(self, key: str, token: Token) -> None:
        if key == "Name":
            self.title = token
            if token.text:
                self.builder.check_name(token, [], "system")
            return
        if not token.text and key in ("AndMethod", "OrMethod", "ImpMethod", "AggMethod"):
            return  # none: no rule needs it
        allowed = TYPES if key == "Type" else METHODS[key]
        if token.text not in allowed:
            words = " or ".join(f"'{word}'" for word in allowed)
            raise self.source.error(token, f"{key} {token.shown()}", words)
        if key == "Type":
            self.type = token
            if token.text not in PLAIN:
                self.builder.not_plain(
                    token, f"Type '{token.text}'", " or ".join(f"'{one}'" for one in PLAIN)
                )
        else:
            self.methods[key] = token

    def variable(self, section: Section, is_input: bool) -> None:
        others = ("Enabled",) if is_input else self.of_output
        entries = self.entries(section, ("Name", "Range", "NumMFs", "MF", *others))
        for key in ("Name", "Range"):
            if key not in entries:
                raise self.source.error(section.head, f"no {key}", f"'{key}=...'")
        name = self.text(entries["Name"], "a name in quotes")
        self.finish_line(entries["Name"])
        variable = self.builder.add_variable(name, is_input)
        stream = entries["Range"]
        at = stream.token
        values = self.vector(stream, 2)
        self.builder.set_range(variable, at, *values)
        self.terms(variable, entries)
        self.others(variable, entries)

    def others(self, variable: Variable, entries: dict[str, Stream]) -> None:
        """FuzzyLite's keys."""
        if "Default" in entries:
            stream = entries["Default"]
            variable.default_at = stream.token
            if not stream.accept("nan"):
                variable.default = stream.number("a number or nan")
            self.finish_line(stream)
        if self.flag(entries, "Enabled", True) is False:
            raise self.source.error(variable.name, "'Enabled=0'", "what is disabled taken out")
        variable.clips = self.flag(entries, "LockRange", False)
        if self.flag(entries, "LockPrevious", False):
            self.builder.not_plain(variable.name, "'LockPrevious=1' keeps a value", "0")
            self.builder.notes.append(
                f"{variable.shown()} keeps its last value where no rule fires: that is left to the "
                "caller, who is told so by a bit"
            )

    def flag(self, entries: dict[str, Stream], key: str, otherwise: bool) -> bool:
        if key not in entries:
            return otherwise
        token = entries[key].expect_kind(NUMBER, "0 or 1")
        if token.text not in ("0", "1"):
            raise self.source.error(token, f"{key}={token.text}", "0 or 1")
        self.finish_line(entries[key])
        return token.text == "1"

    def terms(self, variable: Variable, entries: dict[str, Stream]) -> None:
        """Each MF in its turn."""
        streams = [(k, s) for k, s in entries.items() if k.startswith("MF")]
        sides = self.sides(variable)
        for i, (key, stream) in enumerate(streams):
            expected = f"MF{i // len(sides) + 1}{sides[i % len(sides)]}"
            if key != expected:
                raise self.source.error(stream.tokens[0], f"found '{key}'", f"'{expected}'")
            self.term(variable, stream)
        if len(streams) % len(sides):
            last, at = streams[-1][0], streams[-1][1].tokens[0]
            raise self.source.error(at, f"'{last}' alone", f"'{last[:-1]}{sides[-1]}' behind it")
        if "NumMFs" in entries:
            stream = entries["NumMFs"]
            count = stream.expect_kind(NUMBER, "a number")
            self.finish_line(stream)
            self.check_count("NumMFs", count, len(streams) // len(sides))

    def sides(self, variable: Variable) -> tuple[str, ...]:
        """What follows the number of a term, for each of its sets."""
        return ("",)

    def term(self, variable: Variable, stream: Stream) -> None:
        name = self.text(stream, "a name in quotes")
        stream.expect(":")
        at = self.text(stream, "a membership function in quotes")
        stream.expect(",")
        self.builder.add_term(variable, Term(name, at, self.content(variable, at, stream)))

    def content(self, variable: Variable, at: Token, stream: Stream) -> Content:
        if at.text == "constant" and not variable.is_input:
            return self.vector(stream, 1)[0]
        if at.text == "linear" and not variable.is_input:
            inputs = len(self.builder.of_kind(is_input=True))
            return self.builder.linear(at, self.vector(stream, inputs + 1))
        if at.text == "function":
            return self.formula(at, stream)
        if at.text == "discretemf":
            values, _ = self.values(stream)
            if len(values) < 2 or len(values) % 2:
                raise self.source.error(at, f"{len(values)} numbers of {at.text}", "pairs")
            pairs = list(zip(values[::2], values[1::2], strict=True))
            return Straight(at.text, self.builder.points(at, pairs, [at] * len(pairs)))
        shape = self.shape_of(at, () if variable.is_input else ("constant", "linear"))
        values = self.vector(stream, shape.parameters, at.text in SHOULDERS)
        return self.builder.shape(at, shape, values)

    def shape_of(self, at: Token, others: tuple[str, ...]) -> Shape:
        if at.text not in FIS_SHAPES:
            words = ", ".join((*others, *FIS_SHAPES))
            raise self.source.error(at, f"membership function {at.shown()}", f"one of {words}")
        return FIS_SHAPES[at.text]

    def formula(self, at: Token, stream: Stream) -> Formula:
        """All between the brackets."""
        stream.expect("[")
        start = stream.token.offset
        while not stream.sees("]"):
            if stream.token.kind == END:
                raise stream.unexpected("']'")
            stream.take()
        self.builder.not_plain(at, "a formula", "a shape")
        found = read_formula(self.source, start, stream.take().offset)
        self.finish_line(stream)
        return found

    def vector(self, stream: Stream, count: int, or_infinite: bool = False) -> list[float]:
        """`[a b ...]`, also with commas, to the end of the line; one number may stand bare. Zeros
        that MATLAB pads it with are left out."""
        if count == 1 and stream.token.kind == NUMBER:
            values = [stream.number(f"{count} numbers", or_infinite)]
            self.finish_line(stream)
            return values
        values, ats = self.values(stream, count, or_infinite)
        if any(values[count:]):
            at = ats[count]
            raise self.source.error(at, f"found {at.shown()}", f"']' behind {count} numbers")
        return values[:count]

    def values(
        self, stream: Stream, least: int = 1, or_infinite: bool = False
    ) -> tuple[list[float], list[Token]]:
        """At least so many, and where each begins."""
        what = f"{least} numbers"
        stream.expect("[")
        found: list[float] = []
        ats: list[Token] = []
        while len(found) < least or not stream.sees("]"):
            stream.accept(*([","] if found else []))
            ats.append(stream.token)
            found.append(self.value(stream, what, or_infinite))
        stream.expect("]", after=f" behind {what}")
        self.finish_line(stream)
        return found, ats

    def value(self, stream: Stream, what: str, or_infinite: bool) -> float:
        """A number, or numbers with operators and no space between, such as -pi/4."""
        start = stream.token
        end = re.compile(r"[^\s,\]]+").match(self.source.text, start.offset)
        is_number = start.kind == NUMBER and (
            end is None or end.end() == start.offset + len(start.text)
        )
        if is_number or end is None or not re.search(r"[A-Za-z]|[-+*/^]", end.group()):
            return stream.number(what, or_infinite)
        formula = read_formula(self.source, start.offset, end.end())
        if formula.names:
            raise stream.unexpected(what)
        found = float(formula({}))
        if not abs(found) <= MAX_NUMBER:
            shown = f"number '{end.group()}'"
            raise self.source.error(start, shown, f"one within +-{MAX_NUMBER:g}")
        while stream.token.kind != END and stream.token.offset < end.end():
            stream.take()
        return found

    def check_complete(self, at: Token) -> None:
        if self.type is None:
            raise self.source.error(at, "no Type", "Type='mamdani' or Type='sugeno'")
        plain = PLAIN.get(self.type.text, {})
        for key in ("DefuzzMethod",) if self.type.text != "mamdani" else PLAIN["mamdani"]:
            if key not in self.methods:
                wanted = plain.get(key, "wtaver")
                raise self.source.error(at, f"no {key}", f"{key}='{wanted}'")
        for key, wanted in plain.items():
            token = self.methods[key]
            if token.text != wanted:
                what = f"{key} '{token.text}' of a {self.type.text} system"
                self.builder.not_plain(token, what, f"'{wanted}'")
        if self.rule_lines is None:
            raise self.source.error(at, "no section [Rules]", "'[Rules]'")
        for variable in self.builder.of_kind(is_input=False):
            self.set_method(variable)

    def set_method(self, variable: Variable) -> None:
        assert self.type is not None and variable.low is not None and variable.high is not None
        is_value = all(isinstance(t.content, float | Line | Formula) for t in variable.terms)
        method = DEFUZZIFIERS[self.methods["DefuzzMethod"].text]
        if is_value and method in model.SET_METHODS:
            method = model.BY_RULE
        method = self.by_magnitude(variable, method)
        variable.method = CENTROID if self.type.text == "mamdani" else WEIGHTED_SUM
        variable.system_method, variable.places = method, PLACES
        variable.aggregation = self.norm("AggMethod", MAXIMUM)
        if variable.default is None and variable.default_at is None:
            variable.default = 0.5 * (variable.low + variable.high)
            self.builder.notes.append(
                f"{variable.shown()}: where no rule fires {variable.default:g}, the middle of its "
                "range, as in MATLAB"
            )

    def by_magnitude(self, variable: Variable, method: str) -> str:
        """MATLAB and Octave have som and lom by the magnitude of x."""
        other = {model.SMALLEST: model.LARGEST, model.LARGEST: model.SMALLEST}
        assert variable.low is not None and variable.high is not None
        if method not in other or self.is_from_fuzzylite or variable.low >= 0:
            return method
        if variable.high > 0:
            token = self.methods["DefuzzMethod"]
            what = f"{token.text} is by magnitude, and {variable.shown()} has both signs"
            raise self.source.error(token, what, "'mom', or a range without 0 inside")
        return other[method]

    def check_counts(self) -> None:
        actual = {
            "NumInputs": len(self.builder.of_kind(is_input=True)),
            "NumOutputs": len(self.builder.of_kind(is_input=False)),
            "NumRules": len(self.rule_lines or []),
        }
        for key, token in self.counts.items():
            self.check_count(key, token, actual[key])

    def check_count(self, key: str, token: Token, actual: int) -> None:
        if self.source.number(token) != actual:
            what = f"{key} is {token.text}, there are {actual}"
            raise self.source.error(token, what, f"{actual}")

    def drafts(self, tokens: list[Token]) -> list[Draft]:
        """Of one line."""
        return [self.rule(tokens)]

    def rule(self, tokens: list[Token]) -> Draft:
        """`1 -2, 3 (0.5) : 1`: sets, terms, weight, connective."""
        stream = Stream(self.source, tokens)
        at = stream.token
        conditions: list[Expression] = []
        for index, variable in enumerate(self.builder.of_kind(is_input=True)):
            token = stream.token
            place, hedges = self.index(stream, variable)
            if place or ANY in hedges:
                term, places = max(0, abs(place) - 1), (token.offset, token.offset)
                conditions.append(Proposition(True, index, term, hedges, places))
        if not conditions:
            raise self.source.error(at, "a rule without a condition", "a set of an input")
        stream.expect(",", after=" and the terms of the outputs")
        conclusions = self.conclusions(stream)
        stream.expect("(")
        weight = checked_weight(self.source, stream.token, stream.number("a weight"))
        stream.expect(")")
        stream.expect(":")
        connective = self.connective(stream)
        self.finish_line(stream)
        expression = conditions[0] if len(conditions) == 1 else Join(connective, tuple(conditions))
        return Draft(at, expression, conclusions, weight)

    def conclusions(self, stream: Stream) -> tuple[Conclusion, ...]:
        at, found = stream.token, []
        for index, variable in enumerate(self.builder.of_kind(is_input=False)):
            token = stream.token
            place, hedges = self.index(stream, variable)
            if place < 0 or ANY in hedges:
                raise self.source.error(token, f"negated term {token.text}", "a term or 0")
            if place:
                found.append(Conclusion(index, place - 1, hedges[::-1], token.offset))
        if not found:
            raise self.source.error(at, "a rule without a conclusion", "a term of an output")
        return tuple(found)

    def index(self, stream: Stream, variable: Variable) -> tuple[int, tuple[str, ...]]:
        """The number of a term, negative where negated, 0 for none; hedges as written: NOT first,
        then what the decimals mean."""
        most = len(variable.terms)
        token = stream.expect_kind(NUMBER, f"the number of a term of {variable.shown()}")
        value = self.source.number(token)
        place = int(value)
        if abs(place) > most:
            what = f"no term {token.text} of {variable.shown()}"
            raise self.source.error(token, what, f"0 to {most}")
        hedges = (NOT,) if value < 0 else ()
        hundredths = 100 * (abs(value) - abs(place))
        decimals = round(hundredths)
        is_whole = abs(hundredths - decimals) <= 1e-6
        if decimals == 0 and is_whole:
            return place, hedges
        words = (FUZZYLITE_HEDGES if self.is_from_fuzzylite else HEDGES).get(decimals)
        if words is None or not is_whole:
            known = ", ".join(f".{one:02d}" for one in HEDGES)
            raise self.source.error(token, f"{token.text} has a hedge", f"one of {known}, or none")
        self.builder.not_plain(token, f"{token.text} has a hedge", "a whole number")
        return place, (*hedges, *words)

    def connective(self, stream: Stream) -> str:
        token = stream.expect_kind(NUMBER, "1 (and) or 2 (or)")
        if token.text not in ("1", "2"):
            raise self.source.error(token, f"connective {token.text}", "1 (and) or 2 (or)")
        return AND if token.text == "1" else OR

    def check_operator(self, draft: Draft, connective: str, key: str, wanted: str) -> None:
        """An operator that no rule needs may be any."""
        token = self.methods.get(key)
        if uses(draft.expression, connective) and (token is None or token.text != wanted):
            named = f"'{token.text}'" if token else "missing"
            what = f"{key} {named}, and a rule has '{connective}'"
            if token is None or (connective == OR and token.text == "sum"):
                raise self.source.error(token or draft.at, what, f"'{wanted}'")
            self.builder.not_plain(token, what, f"'{wanted}'")
