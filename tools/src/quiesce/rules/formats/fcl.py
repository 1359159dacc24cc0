"""Reads FCL, the fuzzy control language of IEC 61131-7, with words of jFuzzyLogic's and FuzzyLite's
dialects."""

import re

from quiesce.rules.formats.build import Builder, Content, Options, Straight, Term, Variable
from quiesce.rules.formats.formula import read_formula
from quiesce.rules.formats.logic import RuleParser, Words, uses
from quiesce.rules.formats.norm_words import FCL_S_NORMS, FCL_T_NORMS
from quiesce.rules.formats.scan import (
    END,
    INFINITE_PATTERN,
    NAME,
    NUMBER,
    NUMBER_PATTERN,
    WORD_PATTERN,
    Source,
    Stream,
    Token,
    scan,
)
from quiesce.rules.formats.shapes import FCL_SHAPES, FLL_SHAPES, SHOULDERS, Shape
from quiesce.rules.model import CENTROID, OR, WEIGHTED_MAX, WEIGHTED_SUM
from quiesce.rules.system import model
from quiesce.rules.system.model import Block
from quiesce.rules.system.norms import MAXIMUM, MINIMUM, UNBOUNDED_SUM

PATTERN = re.compile(
    r"\s+|//[^\n]*|\(\*.*?\*\)|/\*.*?\*/|\{[^{}]*\}|(?P<unclosed>\(\*|/\*|\{)"
    rf"|(?P<number>{NUMBER_PATTERN}|[+-]{INFINITE_PATTERN})|(?P<name>{WORD_PATTERN})"
    r"|(?P<symbol>:=|\.\.|[();:,|]|[-+*/^%](?=[^;\n]*;))",
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
# FuzzyLite's shapes are written as in FLL, with their numbers in that order.
SHAPES: dict[str, Shape] = {**{word.upper(): one for word, one in FLL_SHAPES.items()}, **FCL_SHAPES}
SHOULDER_WORDS = {word.upper() for word in SHOULDERS}
OPERATORS = {"AND": FCL_T_NORMS, "OR": FCL_S_NORMS, "ACT": FCL_T_NORMS, "ACCU": FCL_S_NORMS}
# What a plain base has of each.
PLAIN = {"AND": ("MIN",), "OR": ("MAX",), "ACT": ("MIN",), "ACCU": ("MAX", "SUM")}
METHODS = {
    "COG": model.CENTROID, "COGS": "", "COA": model.BISECTOR, "LM": model.SMALLEST,
    "RM": model.LARGEST, "MM": model.MEAN, "COGSS": model.WEIGHTED,
}  # fmt: skip
PLAIN_METHODS = ("COG", "COGS")
PLACES = 1000  # of sets that are looked at


def read_fcl(source: Source, name: str, options: Options) -> tuple[Builder, str, Token]:
    """name: of the base where the file gives it none. Returns with it and where it begins."""
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

    def read(self, name: str) -> tuple[Builder, str, Token]:
        stream = self.stream
        start = stream.expect("FUNCTION_BLOCK")
        if stream.token.kind == NAME and stream.token.text.upper() not in RESERVED:
            name = stream.take().text
        while not stream.accept("END_FUNCTION_BLOCK"):
            self.section()
        if stream.token.kind != END:
            raise stream.unexpected("nothing more: one FUNCTION_BLOCK in a file")
        self.check_complete()
        return self.builder, name, start

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

    def content(self) -> Content:
        stream = self.stream
        if stream.token.kind == NUMBER:
            return stream.number()
        if stream.sees("("):
            return self.points()
        others = {"LINEAR": self.linear, "FUNCTION": self.function, "DISCRETE": self.discrete}
        if stream.sees(*others):
            at = stream.take()
            return others[at.text.upper()](at)
        if not stream.sees(*SHAPES):
            words = ", ".join(word.lower() for word in (*FCL_SHAPES, *FLL_SHAPES))
            raise stream.unexpected(f"points as (x, membership), a number, or one of {words}")
        at = stream.take()
        shape = SHAPES[at.text.upper()]
        is_shoulder = at.text.upper() in SHOULDER_WORDS
        values = [stream.number(or_infinite=is_shoulder) for _ in range(shape.parameters)]
        height = stream.number() if stream.token.kind == NUMBER else 1.0
        if not 0 < height <= 1:
            raise self.source.error(at, f"height {height:g}", "above 0, at most 1")
        return self.builder.shape(at, shape, values, height)

    def numbers(self) -> list[float]:
        """As many as there are."""
        found = []
        while self.stream.token.kind == NUMBER:
            found.append(self.stream.number())
        return found

    def linear(self, at: Token) -> Content:
        return self.builder.linear(at, self.numbers())

    def discrete(self, at: Token) -> Content:
        values = self.numbers()
        if len(values) < 2 or len(values) % 2:
            raise self.source.error(at, f"{len(values)} numbers of {at.text}", "pairs")
        pairs = list(zip(values[::2], values[1::2], strict=True))
        return Straight(at.text, self.builder.points(at, pairs, [at] * len(pairs)))

    def function(self, at: Token) -> Content:
        """Up to the semicolon."""
        stream, start = self.stream, self.stream.token.offset
        while not stream.sees(";"):
            if stream.token.kind == END:
                raise stream.unexpected("';'")
            stream.take()
        self.builder.not_plain(at, "a formula", "a shape")
        return read_formula(self.source, start, stream.token.offset)

    def points(self) -> Straight:
        stream, at = self.stream, self.stream.token
        points, ats = [], []
        while stream.accept("("):
            ats.append(stream.token)
            x = stream.number()
            stream.expect(",")
            points.append((x, stream.number()))
            stream.expect(")")
        return Straight("points", self.builder.points(at, points, ats))

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
        token = variable.method_at = self.word(*METHODS)
        if token.text.upper() not in PLAIN_METHODS:
            self.builder.not_plain(token, f"METHOD : {token.text}", "'COG' or 'COGS'")

    def accumulate(self, variable: Variable) -> None:
        key = self.builder.key(variable.name)
        if key in self.accumulation:
            raise self.stream.unexpected("one ACCU in a DEFUZZIFY")
        self.accumulation[key] = self.norm("ACCU")

    def norm(self, kind: str) -> Token:
        """Behind its keyword."""
        token = self.word(*OPERATORS[kind])
        plain = PLAIN[kind]
        if token.text.upper() not in plain:
            words = " or ".join(f"'{word}'" for word in plain)
            self.builder.not_plain(token, f"{kind} : {token.text}", words)
        return token

    def default(self, variable: Variable) -> None:
        """A number, nan for none, NC for the last value."""
        stream = self.stream
        if variable.default_at is not None:
            raise stream.unexpected("one DEFAULT in a DEFUZZIFY")
        stream.expect(":=")
        variable.default_at = stream.token
        if not stream.sees("NAN", "NC"):
            variable.default = stream.number()
        elif stream.sees("NAN"):
            stream.take()
        if stream.accept("|") or stream.sees("NC"):
            self.keep_last(variable, stream.expect("NC"))
        stream.expect(";")

    def keep_last(self, variable: Variable, at: Token) -> None:
        self.builder.not_plain(at, f"{at.text}, which keeps the last value", "a number")
        self.builder.notes.append(
            f"{variable.shown()} keeps its last value where no rule fires: that is left to the "
            "caller, who is told so by a bit"
        )

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
        for start in self.rule_blocks:
            self.rule_block(start)
        for variable in self.builder.of_kind(is_input=False):
            self.set_method(variable)

    def set_method(self, variable: Variable) -> None:
        own = self.accumulation.get(self.builder.key(variable.name))
        common = self.common_accumulation
        if own and common and own.text.upper() != common.text.upper():
            raise self.source.error(
                own, f"ACCU : {own.text}, but the rule block has {common.text}", "the same"
            )
        token = own or common
        norm = FCL_S_NORMS[token.text.upper()] if token else MAXIMUM
        assert variable.method_at is not None
        word = variable.method_at.text.upper()
        is_sum = norm == UNBOUNDED_SUM
        variable.system_method = METHODS[word] or (model.BY_RULE if is_sum else model.BY_TERM)
        variable.aggregation, variable.places = norm, PLACES
        if word == "COGS":
            variable.method = WEIGHTED_SUM if is_sum else WEIGHTED_MAX
        else:
            variable.method = CENTROID
            if is_sum and token:
                self.builder.not_plain(
                    token, f"ACCU : SUM with METHOD : {variable.method_at.text}", "ACCU : MAX"
                )

    def rule_block(self, start: int) -> None:
        stream, builder = self.stream, self.builder
        stream.at = start
        if not stream.sees(*OPERATORS, "RULE", "END_RULEBLOCK"):
            self.new_name("the name of the rule block")
        parser = RuleParser(stream, WORDS, builder.names(), len(builder.blocks))
        operators: dict[str, str] = {}
        drafts = []
        while not stream.accept("END_RULEBLOCK"):
            if stream.sees(*OPERATORS):
                kind = stream.token.text.upper()
                if kind in operators:
                    raise stream.unexpected(f"one {kind} in a rule block")
                operators[kind] = self.operator()
                continue
            stream.expect("RULE", after=", AND, OR, ACT, ACCU or END_RULEBLOCK")
            if stream.token.kind not in (NAME, NUMBER):
                raise stream.unexpected("the number of the rule")
            stream.take()
            stream.expect(":")
            drafts.append(parser.rule())
            # FuzzyLite writes none.
            if not stream.sees("RULE", "END_RULEBLOCK"):
                stream.expect(";")
        builder.drafts += drafts
        self.check_dual(drafts, operators)
        builder.blocks.append(
            Block(
                operators.get("AND", MINIMUM),
                operators.get("OR", MAXIMUM),
                operators.get("ACT", MINIMUM),
            )
        )

    def check_dual(self, drafts: list, operators: dict[str, str]) -> None:
        """A sum without a bound is no OR."""
        for draft in drafts:
            if operators.get("OR") == UNBOUNDED_SUM and uses(draft.expression, OR):
                raise self.source.error(draft.at, "OR : SUM", "a norm, such as BSUM")

    def operator(self) -> str:
        """Its norm."""
        kind = self.stream.take().text.upper()
        token = self.norm(kind)
        if kind == "ACCU":
            common = self.common_accumulation
            if common and common.text.upper() != token.text.upper():
                raise self.source.error(
                    token, f"ACCU : {token.text} after {common.text}", "the same"
                )
            self.common_accumulation = token
        return OPERATORS[kind][token.text.upper()]
