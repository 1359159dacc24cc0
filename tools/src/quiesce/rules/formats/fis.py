"""Reads FIS, the files of MATLAB's Fuzzy Logic Toolbox: Mamdani and zero-order Sugeno.

Comments begin with % as in MATLAB or # as in Octave.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from quiesce.rules.formats.build import Builder, Content, Options, Term, Variable
from quiesce.rules.formats.logic import Draft, Join, checked_weight, plain_rules, uses
from quiesce.rules.formats.scan import (
    END,
    INFINITE_PATTERN,
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
from quiesce.rules.formats.shapes import FIS_SHAPES, SHOULDERS
from quiesce.rules.model import (
    AND,
    CENTROID,
    OR,
    WEIGHTED_SUM,
    Condition,
    Output,
    Rule,
    RuleBase,
)

PATTERN = re.compile(
    rf"\s+|(?P<number>{NUMBER_PATTERN}|{INFINITE_PATTERN})|(?P<name>{WORD_PATTERN})|(?P<string>'[^'\n]*'|\"[^\"\n]*\")"
    r"|(?P<unclosed>['\"])|(?P<symbol>[\[\]=(),:])"
)
SYSTEM, RULES = "System", "Rules"
COUNTS = ("NumInputs", "NumOutputs", "NumRules")
METHODS = {
    "AndMethod": ("min", "prod"),
    "OrMethod": ("max", "probor", "sum"),
    "ImpMethod": ("min", "prod"),
    "AggMethod": ("max", "sum", "probor"),
    "DefuzzMethod": ("centroid", "bisector", "mom", "lom", "som", "wtaver", "wtsum"),
}
# The ones that a type must have. Sugeno systems use neither implication nor aggregation.
REQUIRED = {
    "mamdani": {"ImpMethod": "min", "AggMethod": "max", "DefuzzMethod": "centroid"},
    "sugeno": {"DefuzzMethod": "wtaver"},
}
SYSTEM_KEYS = ("Name", "Type", "Version", *COUNTS, *METHODS)


@dataclass
class Section:
    """head: what stands in brackets; lines: tokens of each, an END last."""

    head: Token
    lines: list[list[Token]] = field(default_factory=list)


def read_fis(source: Source, name: str, options: Options) -> RuleBase:
    """name: of the base where the file gives it none."""
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
    def __init__(self, source: Source, options: Options) -> None:
        self.source = source
        self.builder = Builder(source, options)
        self.title: Token | None = None
        self.type: Token | None = None
        self.methods: dict[str, Token] = {}
        self.counts: dict[str, Token] = {}
        self.rule_lines: list[list[Token]] | None = None

    def read(self, name: str) -> RuleBase:
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
        drafts = [self.rule(line) for line in self.rule_lines or []]
        for draft in drafts:
            self.check_operator(draft, AND, "AndMethod", "min")
            self.check_operator(draft, OR, "OrMethod", "max")
        title = self.title.text if self.title and self.title.text else name
        return self.builder.finish(title, first, lambda outputs: self.rules(drafts, outputs))

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
            if re.sub("^MF[0-9]+$", "MF", key.text) not in allowed:
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
        for key, stream in self.entries(section, SYSTEM_KEYS).items():
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
        allowed = tuple(REQUIRED) if key == "Type" else METHODS[key]
        if token.text not in allowed:
            words = " or ".join(f"'{word}'" for word in allowed)
            raise self.source.error(token, f"{key} {token.shown()}", words)
        if key == "Type":
            self.type = token
        else:
            self.methods[key] = token

    def variable(self, section: Section, is_input: bool) -> None:
        entries = self.entries(section, ("Name", "Range", "NumMFs", "MF"))
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

    def terms(self, variable: Variable, entries: dict[str, Stream]) -> None:
        streams = [(k, s) for k, s in entries.items() if k.startswith("MF")]
        for number, (key, stream) in enumerate(streams, start=1):
            if key != f"MF{number}":
                raise self.source.error(stream.tokens[0], f"found '{key}'", f"'MF{number}'")
            self.term(variable, stream)
        if "NumMFs" in entries:
            stream = entries["NumMFs"]
            count = stream.expect_kind(NUMBER, "a number")
            self.finish_line(stream)
            self.check_count("NumMFs", count, len(streams))

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
        if at.text not in FIS_SHAPES:
            words = ", ".join((*(() if variable.is_input else ("constant", "linear")), *FIS_SHAPES))
            raise self.source.error(at, f"membership function {at.shown()}", f"one of {words}")
        shape = FIS_SHAPES[at.text]
        values = self.vector(stream, shape.parameters, at.text in SHOULDERS)
        return self.builder.shape(at, shape, values)

    def vector(self, stream: Stream, count: int, or_infinite: bool = False) -> list[float]:
        """`[a b ...]`, also with commas, to the end of the line; one number may stand bare."""
        is_bare = count == 1 and stream.token.kind == NUMBER
        if not is_bare:
            stream.expect("[")
        values = [stream.number(f"{count} numbers", or_infinite)]
        while len(values) < count:
            stream.accept(",")
            values.append(stream.number(f"{count} numbers", or_infinite))
        if not is_bare:
            stream.expect("]", after=f" behind {count} numbers")
        self.finish_line(stream)
        return values

    def check_complete(self, at: Token) -> None:
        if self.type is None:
            raise self.source.error(at, "no Type", "Type='mamdani' or Type='sugeno'")
        for key, wanted in REQUIRED[self.type.text].items():
            token = self.methods.get(key)
            if token is None:
                raise self.source.error(at, f"no {key}", f"{key}='{wanted}'")
            if token.text != wanted:
                what = f"{key} '{token.text}' of a {self.type.text} system"
                raise self.source.error(token, what, f"'{wanted}'")
        if self.rule_lines is None:
            raise self.source.error(at, "no section [Rules]", "'[Rules]'")
        for variable in self.builder.of_kind(is_input=False):
            self.set_method(variable)

    def set_method(self, variable: Variable) -> None:
        assert self.type is not None and variable.low is not None and variable.high is not None
        variable.method = CENTROID if self.type.text == "mamdani" else WEIGHTED_SUM
        variable.default = 0.5 * (variable.low + variable.high)
        self.builder.notes.append(
            f"{variable.shown()}: where no rule fires {variable.default:g}, the middle of its "
            "range, as in MATLAB"
        )

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

    def rule(self, tokens: list[Token]) -> Draft:
        """`1 -2, 3 (0.5) : 1`: sets, terms, weight, connective."""
        stream = Stream(self.source, tokens)
        at = stream.token
        conditions = []
        for index, variable in enumerate(self.builder.of_kind(is_input=True)):
            place = self.index(stream, variable)
            if place:
                conditions.append(Condition(index, abs(place) - 1, place < 0))
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

    def conclusions(self, stream: Stream) -> dict[int, int]:
        at, found = stream.token, {}
        for index, variable in enumerate(self.builder.of_kind(is_input=False)):
            token = stream.token
            place = self.index(stream, variable)
            if place < 0:
                raise self.source.error(token, f"negated term {token.text}", "a term or 0")
            if place:
                found[index] = place - 1
        if not found:
            raise self.source.error(at, "a rule without a conclusion", "a term of an output")
        return found

    def index(self, stream: Stream, variable: Variable) -> int:
        """The number of a term, negative where negated, 0 for none."""
        most = len(variable.terms)
        token = stream.expect_kind(NUMBER, f"the number of a term of {variable.shown()}")
        value = self.source.number(token)
        if value != int(value):
            raise self.source.error(token, f"{token.text} has a hedge", "a whole number")
        if abs(value) > most:
            what = f"no term {token.text} of {variable.shown()}"
            raise self.source.error(token, what, f"0 to {most}")
        return int(value)

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
            raise self.source.error(token or draft.at, what, f"'{wanted}'")

    def rules(self, drafts: Sequence[Draft], outputs: Sequence[Output]) -> list[Rule]:
        return [rule for d in drafts for rule in plain_rules(self.source, d, outputs)]
