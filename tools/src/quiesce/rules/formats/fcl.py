"""Reads FCL, the fuzzy control language of IEC 61131-7, and words of jFuzzyLogic's dialect."""

import re
from collections.abc import Sequence

from quiesce.rules.formats.build import Builder, Options, Smooth, Term, Variable
from quiesce.rules.formats.logic import RuleParser, Words, plain_rules
from quiesce.rules.formats.scan import (
    END,
    NAME,
    NUMBER,
    NUMBER_PATTERN,
    WORD_PATTERN,
    Source,
    Stream,
    Token,
    scan,
)
from quiesce.rules.formats.shapes import FCL_SHAPES
from quiesce.rules.model import (
    CENTROID,
    WEIGHTED_MAX,
    WEIGHTED_SUM,
    Output,
    Point,
    Rule,
    RuleBase,
)

PATTERN = re.compile(
    r"\s+|//[^\n]*|\(\*.*?\*\)|/\*.*?\*/|\{[^{}]*\}|(?P<unclosed>\(\*|/\*|\{)"
    rf"|(?P<number>{NUMBER_PATTERN})|(?P<name>{WORD_PATTERN})|(?P<symbol>:=|\.\.|[();:,])",
    re.DOTALL,
)
WORDS = Words(
    "IF", "THEN", "IS", "NOT", "AND", "OR", "WITH", separators=(",", "AND"), ignore_case=True
)
TYPES = ("REAL", "LREAL")
SECTIONS = ("VAR_INPUT", "VAR_OUTPUT", "FUZZIFY", "DEFUZZIFY", "RULEBLOCK")
RESERVED = {
    *SECTIONS, *(f"END_{word}" for word in ("VAR", *SECTIONS[2:])),
    "FUNCTION_BLOCK", "END_FUNCTION_BLOCK", "TERM", "RANGE", "METHOD", "ACCU", "DEFAULT", "NC",
    "RULE", "ACT", *TYPES, *WORDS.reserved(), *FCL_SHAPES,
}  # fmt: skip
MAX, SUM = "MAX", "SUM"
# The one operator of each kind that the model has.
OPERATORS = {"AND": ("MIN",), "OR": ("MAX",), "ACT": ("MIN",), "ACCU": (MAX, SUM)}
METHODS = ("COG", "COGS")


def read_fcl(source: Source, name: str, options: Options) -> RuleBase:
    """name: of the base where the file gives it none."""
    return FclReader(source, options).read(name)


class FclReader:
    def __init__(self, source: Source, options: Options) -> None:
        self.source = source
        self.stream = Stream(source, scan(source, PATTERN, 0, len(source.text)), ignore_case=True)
        self.builder = Builder(source, options, ignore_case=True)
        self.filled: set[str] = set()  # variables with a FUZZIFY or DEFUZZIFY
        self.rule_blocks: list[int] = []  # where they begin
        self.accumulation: dict[str, Token] = {}  # of outputs
        self.common_accumulation: Token | None = None  # of the rule blocks

    def read(self, name: str) -> RuleBase:
        stream = self.stream
        start = stream.expect("FUNCTION_BLOCK")
        if stream.token.kind == NAME and stream.token.text.upper() not in RESERVED:
            name = stream.take().text
        while not stream.accept("END_FUNCTION_BLOCK"):
            self.section()
        if stream.token.kind != END:
            raise stream.unexpected("nothing more: one FUNCTION_BLOCK in a file")
        self.check_complete()
        return self.builder.finish(name, start, self.rules)

    def section(self) -> None:
        stream = self.stream
        if not stream.sees(*SECTIONS):
            raise stream.unexpected(f"{', '.join(SECTIONS)} or END_FUNCTION_BLOCK")
        word = stream.take().text.upper()
        if word in ("VAR_INPUT", "VAR_OUTPUT"):
            self.declarations(is_input=word == "VAR_INPUT")
        elif word == "FUZZIFY":
            self.fuzzify()
        elif word == "DEFUZZIFY":
            self.defuzzify()
        else:
            self.skip_rules()

    def new_name(self, what: str) -> Token:
        token = self.stream.token
        if token.kind != NAME or token.text.upper() in RESERVED:
            raise self.stream.unexpected(what)
        return self.stream.take()

    def declarations(self, is_input: bool) -> None:
        stream = self.stream
        while not stream.accept("END_VAR"):
            names = [self.new_name("the name of a variable, or END_VAR")]
            while stream.accept(","):
                names.append(self.new_name("the name of a variable"))
            stream.expect(":")
            stream.expect(*TYPES)
            stream.expect(";")
            for name in names:
                self.builder.add_variable(name, is_input)

    def declared(self, is_input: bool) -> Variable:
        """The variable that a FUZZIFY or DEFUZZIFY names."""
        token = self.new_name("the name of a variable")
        key = self.builder.key(token)
        for variable in self.builder.of_kind(is_input):
            if self.builder.key(variable.name) == key:
                if key in self.filled:
                    raise self.source.error(token, f"a second block of {variable.shown()}", "one")
                self.filled.add(key)
                return variable
        section = "VAR_INPUT" if is_input else "VAR_OUTPUT"
        raise self.source.error(token, f"no variable {token.shown()}", f"one of {section}")

    def fuzzify(self) -> None:
        stream, variable = self.stream, self.declared(is_input=True)
        while not stream.accept("END_FUZZIFY"):
            if not stream.sees("TERM", "RANGE"):
                raise stream.unexpected("TERM, RANGE or END_FUZZIFY")
            if stream.take().text.upper() == "TERM":
                self.term(variable)
            else:
                self.range(variable)

    def defuzzify(self) -> None:
        stream, variable = self.stream, self.declared(is_input=False)
        readers = {
            "TERM": self.term,
            "RANGE": self.range,
            "METHOD": self.method,
            "ACCU": self.accumulate,
            "DEFAULT": self.default,
        }
        while not stream.sees("END_DEFUZZIFY"):
            if not stream.sees(*readers):
                raise stream.unexpected(f"{', '.join(readers)} or END_DEFUZZIFY")
            readers[stream.take().text.upper()](variable)
        if variable.method_at is None:
            raise stream.unexpected("METHOD : COG or METHOD : COGS")
        stream.take()

    def term(self, variable: Variable) -> None:
        name = self.new_name("the name of a term")
        self.stream.expect(":=")
        at = self.stream.token
        content = self.content()
        self.stream.expect(";")
        self.builder.add_term(variable, Term(name, at, content))

    def content(self) -> tuple[Point, ...] | float | Smooth:
        stream = self.stream
        if stream.token.kind == NUMBER:
            return stream.number()
        if stream.sees("("):
            return self.points()
        if not stream.sees(*FCL_SHAPES):
            words = ", ".join(word.lower() for word in FCL_SHAPES)
            raise stream.unexpected(f"points as (x, membership), a number, or one of {words}")
        at = stream.take()
        shape = FCL_SHAPES[at.text.upper()]
        return self.builder.shape(at, shape, [stream.number() for _ in range(shape.parameters)])

    def points(self) -> tuple[Point, ...]:
        stream, at = self.stream, self.stream.token
        points, ats = [], []
        while stream.accept("("):
            ats.append(stream.token)
            x = stream.number()
            stream.expect(",")
            points.append((x, stream.number()))
            stream.expect(")")
        return self.builder.points(at, points, ats)

    def range(self, variable: Variable) -> None:
        stream, at = self.stream, self.stream.tokens[self.stream.at - 1]
        if variable.range_at is not None:
            raise self.source.error(at, f"a second RANGE of {variable.shown()}", "one")
        stream.expect(":=")
        stream.expect("(")
        low = stream.number()
        stream.expect("..")
        high = stream.number()
        stream.expect(")")
        stream.expect(";")
        self.builder.set_range(variable, at, low, high)

    def word(self, *allowed: str) -> Token:
        """Behind a keyword: `: WORD ;`."""
        self.stream.expect(":")
        token = self.stream.expect(*allowed)
        self.stream.expect(";")
        return token

    def method(self, variable: Variable) -> None:
        if variable.method_at is not None:
            raise self.stream.unexpected("one METHOD in a DEFUZZIFY")
        variable.method_at = self.word(*METHODS)

    def accumulate(self, variable: Variable) -> None:
        key = self.builder.key(variable.name)
        if key in self.accumulation:
            raise self.stream.unexpected("one ACCU in a DEFUZZIFY")
        self.accumulation[key] = self.word(*OPERATORS["ACCU"])

    def default(self, variable: Variable) -> None:
        stream = self.stream
        if variable.default_at is not None:
            raise stream.unexpected("one DEFAULT in a DEFUZZIFY")
        stream.expect(":=")
        variable.default_at = stream.token
        if stream.sees("NC"):
            raise stream.unexpected("a number: NC, which keeps the last value, is not supported")
        variable.default = stream.number()
        stream.expect(";")

    def skip_rules(self) -> None:
        """Rules are read once all variables are known."""
        self.rule_blocks.append(self.stream.at)
        while not self.stream.sees("END_RULEBLOCK"):
            if self.stream.token.kind == END:
                raise self.stream.unexpected("END_RULEBLOCK")
            self.stream.take()
        self.stream.take()

    def check_complete(self) -> None:
        for variable in self.builder.variables:
            if self.builder.key(variable.name) not in self.filled:
                block = "FUZZIFY" if variable.is_input else "DEFUZZIFY"
                what = f"{variable.shown()} has no {block}"
                raise self.source.error(variable.name, what, f"{block} {variable.name.text}")
        self.drafts = [draft for start in self.rule_blocks for draft in self.rule_block(start)]
        for variable in self.builder.of_kind(is_input=False):
            variable.method = self.method_of(variable)

    def method_of(self, variable: Variable) -> str:
        own = self.accumulation.get(self.builder.key(variable.name))
        common = self.common_accumulation
        if own and common and own.text.upper() != common.text.upper():
            raise self.source.error(
                own, f"ACCU : {own.text}, but the rule block has {common.text}", "the same"
            )
        accumulation = own or common
        is_sum = accumulation is not None and accumulation.text.upper() == SUM
        assert variable.method_at is not None
        if variable.method_at.text.upper() == "COGS":
            return WEIGHTED_SUM if is_sum else WEIGHTED_MAX
        if is_sum and accumulation:
            raise self.source.error(accumulation, "ACCU : SUM with METHOD : COG", "ACCU : MAX")
        return CENTROID

    def rule_block(self, start: int) -> list:
        stream = self.stream
        stream.at = start
        if not stream.sees(*OPERATORS, "RULE", "END_RULEBLOCK"):
            self.new_name("the name of the rule block")
        parser = RuleParser(stream, WORDS, self.builder.names())
        drafts, operators = [], set()
        while not stream.accept("END_RULEBLOCK"):
            if stream.sees(*OPERATORS):
                kind = stream.token.text.upper()
                if kind in operators:
                    raise stream.unexpected(f"one {kind} in a rule block")
                operators.add(kind)
                self.operator()
                continue
            stream.expect("RULE", after=", AND, OR, ACT, ACCU or END_RULEBLOCK")
            if stream.token.kind not in (NAME, NUMBER):
                raise stream.unexpected("the number of the rule")
            stream.take()
            stream.expect(":")
            drafts.append(parser.rule())
            stream.expect(";")
        return drafts

    def operator(self) -> None:
        kind = self.stream.take().text.upper()
        token = self.word(*OPERATORS[kind])
        if kind != "ACCU":
            return
        common = self.common_accumulation
        if common and common.text.upper() != token.text.upper():
            raise self.source.error(token, f"ACCU : {token.text} after {common.text}", "the same")
        self.common_accumulation = token

    def rules(self, outputs: Sequence[Output]) -> list[Rule]:
        return [rule for d in self.drafts for rule in plain_rules(self.source, d, outputs)]
