"""Reads FLL, the FuzzyLite language, in the wording of versions 6 to 8."""

import re
from collections.abc import Sequence

from quiesce.rules.formats.build import Builder, Content, Options, Straight, Term, Variable
from quiesce.rules.formats.fll_lines import (
    BLOCK,
    ENGINE,
    INPUT,
    OUTPUT,
    Line,
    Section,
    split_lines,
    split_sections,
)
from quiesce.rules.formats.formula import Formula, read_formula
from quiesce.rules.formats.logic import HEDGE_WORDS, Draft, RuleParser, Words, uses
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
from quiesce.rules.formats.shapes import FLL_SHAPES, SHOULDERS
from quiesce.rules.model import AND, CENTROID, OR, WEIGHTED_MAX, WEIGHTED_SUM
from quiesce.rules.system import model
from quiesce.rules.system.model import Block
from quiesce.rules.system.norms import MAXIMUM, MINIMUM, S_NORMS, T_NORMS, UNBOUNDED_SUM

PATTERN = re.compile(
    rf"\s+|(?P<number>{NUMBER_PATTERN}|{INFINITE_PATTERN})|(?P<name>{WORD_PATTERN})"
    r"|(?P<symbol>[()])"
)
# A hedge of a conclusion lasts on as it does in FuzzyLite.
WORDS = Words("if", "then", "is", "not", "and", "or", "with", ("and",), False, hedges_last_on=True)
RESERVED = {*WORDS.reserved(), *HEDGE_WORDS}
OTHER_TERMS = ("Constant", "Linear", "Discrete", "Function")
DEFUZZIFIERS = {
    "Centroid": model.CENTROID, "Bisector": model.BISECTOR, "SmallestOfMaximum": model.SMALLEST,
    "LargestOfMaximum": model.LARGEST, "MeanOfMaximum": model.MEAN,
    "WeightedAverage": "", "WeightedSum": model.WEIGHTED,
}  # fmt: skip
DEFAULT_PLACES = 1000  # FuzzyLite's, of a file that does not say
FUNCTION_LINE = re.compile(rf"\s*{WORD_PATTERN}\s+Function\s+(?P<formula>\S.*)")
NONE = "none"
PRECISE_FROM = 2  # resolutions of a centroid, which is exact here


def read_fll(source: Source, name: str, options: Options) -> tuple[Builder, str, Token]:
    """name: of the base where the file gives it none. Returns with it and where it begins."""
    return FllReader(source, options).read(name)


class FllReader:
    def __init__(self, source: Source, options: Options) -> None:
        self.source = source
        self.builder = Builder(source, options)
        self.implications: list[Token | None] = []  # of the rule blocks
        self.blocks: list[Section] = []

    def read(self, name: str) -> tuple[Builder, str, Token]:
        sections = split_sections(self.source, split_lines(self.source))
        if not sections:
            raise self.source.error(0, "no line but comments", "'Engine: name' first")
        first = sections[0].head
        if first.key.text != ENGINE:
            raise self.source.error(first.key, f"found {first.key.shown()}", "'Engine: name' first")
        for section in sections[1:]:
            self.section(section)
        for block in self.blocks:
            self.rule_block(block)
        self.check_implications()
        title = Token(NAME, self.source.text[first.start : first.end].strip(), first.start)
        if title.text:
            self.builder.check_name(title, [], "engine")
        return self.builder, title.text or name, first.key

    def section(self, section: Section) -> None:
        kind = section.head.key.text
        if kind == BLOCK:
            self.blocks.append(section)
            return
        stream = self.stream(section.head)
        name = stream.expect_kind(NAME, "the name of a variable")
        if name.text in RESERVED:
            raise self.source.error(name, f"{name.shown()} is a word of FLL", "another name")
        self.finish_line(stream)
        variable = self.builder.add_variable(name, is_input=kind == INPUT)
        for line in section.lines:
            self.variable_line(variable, line)
        if variable.low is None:
            raise self.source.error(name, f"{variable.shown()} has no range", "'range: MIN MAX'")
        if kind == OUTPUT:
            self.set_method(variable, section)

    def stream(self, line: Line, end: int | None = None) -> Stream:
        return Stream(self.source, scan(self.source, PATTERN, line.start, end or line.end))

    def formula(self, line: Line) -> Formula:
        found = FUNCTION_LINE.match(self.source.text, line.start, line.end)
        if found is None:
            raise self.source.error(line.end, "found the end of the line", "a formula")
        self.builder.not_plain(line.key, "a formula", "a shape")
        return read_formula(self.source, found.start("formula"), line.end)

    def finish_line(self, stream: Stream) -> None:
        if stream.token.kind != END:
            raise stream.unexpected("the end of the line")

    def word(self, line: Line, allowed: Sequence[str]) -> Token:
        stream = self.stream(line)
        token = stream.expect(*allowed)
        self.finish_line(stream)
        return token

    def enabled(self, line: Line) -> None:
        if self.word(line, ("true", "false")).text == "false":
            raise self.source.error(line.key, "'enabled: false'", "what is disabled taken out")

    def variable_line(self, variable: Variable, line: Line) -> None:
        readers = {
            "range": self.range,
            "default": self.default,
            "term": self.term,
            "lock-previous": self.lock_previous,
        }
        key = line.key.text
        if key in readers:
            readers[key](variable, line)
        elif key == "enabled":
            self.enabled(line)
        elif key == "lock-range":
            variable.clips = self.word(line, ("true", "false")).text == "true"

    def range(self, variable: Variable, line: Line) -> None:
        stream = self.stream(line)
        at = stream.token
        self.builder.set_range(variable, at, stream.number(), stream.number())
        self.finish_line(stream)

    def default(self, variable: Variable, line: Line) -> None:
        stream = self.stream(line)
        variable.default_at = stream.token
        if not stream.accept("nan"):
            variable.default = stream.number("a number or 'nan'")
        self.finish_line(stream)

    def lock_previous(self, variable: Variable, line: Line) -> None:
        if self.word(line, ("true", "false")).text == "true":
            self.builder.not_plain(line.key, "'lock-previous: true' keeps a value", "'false'")
            self.builder.notes.append(
                f"{variable.shown()} keeps its last value where no rule fires: that is left to the "
                "caller, who is told so by a bit"
            )

    def term(self, variable: Variable, line: Line) -> None:
        found = FUNCTION_LINE.match(self.source.text, line.start, line.end)
        stream = self.stream(line, found.start("formula") if found else line.end)
        name = stream.expect_kind(NAME, "the name of a term")
        if name.text in RESERVED:
            raise self.source.error(name, f"{name.shown()} is a word of FLL", "another name")
        at = stream.token
        content = self.formula(line) if at.text == "Function" else self.content(stream)
        self.builder.add_term(variable, Term(name, at, content))

    def content(self, stream: Stream) -> Content:
        if not stream.sees(*FLL_SHAPES, *OTHER_TERMS):
            raise stream.unexpected(f"one of {', '.join((*OTHER_TERMS, *FLL_SHAPES))}")
        at = stream.take()
        tokens = []
        while stream.token.kind != END:
            tokens.append(stream.expect_kind(NUMBER, "a number"))
        if at.text == "Discrete":
            return self.discrete(at, tokens)
        if at.text == "Linear":
            return self.builder.linear(at, [self.source.number(token) for token in tokens])
        count = 1 if at.text == "Constant" else FLL_SHAPES[at.text].parameters
        has_height = at.text != "Constant" and len(tokens) == count + 1
        if len(tokens) != count and not has_height:
            height = "" if at.text == "Constant" else " (and a height)"
            what = f"{len(tokens)} numbers of {at.text}"
            raise self.source.error(at, what, f"{count}{height}")
        values = [self.source.number(token, at.text in SHOULDERS) for token in tokens]
        if at.text == "Constant":
            return values[0]
        height = self.height(tokens[-1]) if has_height else 1.0
        return self.builder.shape(at, FLL_SHAPES[at.text], values[:count], height)

    def height(self, token: Token) -> float:
        value = self.source.number(token)
        if not 0 < value <= 1:
            raise self.source.error(token, f"height {value:g}", "above 0, at most 1")
        return value

    def discrete(self, at: Token, tokens: Sequence[Token]) -> Straight:
        """Pairs, then perhaps a height."""
        height = self.height(tokens[-1]) if len(tokens) % 2 else 1.0
        ats = tokens[: len(tokens) // 2 * 2 : 2]
        values = [self.source.number(token) for token in tokens]
        pairs = zip(values[::2], values[1::2], strict=False)
        points = self.builder.points(at, list(pairs), ats)
        return Straight(at.text, tuple((x, height * mu) for x, mu in points), height)

    def set_method(self, variable: Variable, section: Section) -> None:
        lines = {line.key.text: line for line in section.lines}
        if "defuzzifier" not in lines:
            raise self.source.error(
                variable.name, f"{variable.shown()} has no defuzzifier", "'defuzzifier: ...'"
            )
        aggregation = None
        if "aggregation" in lines:
            aggregation = self.word(lines["aggregation"], (*S_NORMS, NONE))
        stream = self.stream(lines["defuzzifier"])
        method = stream.expect(*DEFUZZIFIERS)
        is_sets = DEFUZZIFIERS[method.text] in model.SET_METHODS
        if is_sets:
            self.resolution(variable, method, stream)
        else:
            kind = stream.accept("Automatic", "TakagiSugeno", "Tsukamoto")
            variable.inverts = kind is None or kind.text != "TakagiSugeno"
            variable.infers_type = kind is None or kind.text == "Automatic"
        self.finish_line(stream)
        variable.method_at = method
        self.set_system_method(variable, method, aggregation)
        if method.text in ("Centroid", "WeightedAverage"):
            variable.method = self.method(method, aggregation)
        else:
            self.builder.not_plain(
                method, f"found {method.shown()}", "'Centroid' or 'WeightedAverage'"
            )

    def set_system_method(
        self, variable: Variable, method: Token, aggregation: Token | None
    ) -> None:
        norm = aggregation.text if aggregation and aggregation.text != NONE else ""
        if DEFUZZIFIERS[method.text] in model.SET_METHODS and not norm:
            raise self.source.error(
                aggregation or method, f"aggregation {NONE} with {method.text}", "a norm"
            )
        variable.system_method = DEFUZZIFIERS[method.text] or (
            model.BY_TERM if norm and norm != UNBOUNDED_SUM else model.BY_RULE
        )
        variable.aggregation = norm or UNBOUNDED_SUM
        variable.sums_terms = (
            variable.system_method == model.WEIGHTED and variable.aggregation != UNBOUNDED_SUM
        )

    def resolution(self, variable: Variable, method: Token, stream: Stream) -> None:
        variable.places = DEFAULT_PLACES
        if stream.token.kind != NUMBER:
            return
        at = stream.token
        value = stream.number()
        if value != int(value) or value < PRECISE_FROM:
            raise self.source.error(at, f"resolution {at.text}", "a whole number from 2 on")
        variable.places = min(int(value), model.MAX_PLACES)
        if method.text == "Centroid":
            self.builder.plain_notes.append(
                f"{variable.shown()}: an exact centroid in place of {value:g} samples"
            )

    def method(self, method: Token, aggregation: Token | None) -> str:
        """Of a plain base."""
        text = aggregation.text if aggregation else NONE
        allowed = {MAXIMUM: WEIGHTED_MAX, NONE: WEIGHTED_SUM, UNBOUNDED_SUM: WEIGHTED_SUM}
        if method.text == "Centroid":
            allowed = {MAXIMUM: CENTROID}
        if text not in allowed:
            words = " or ".join(f"'{word}'" for word in allowed)
            self.builder.not_plain(
                aggregation or method, f"aggregation {text} with {method.text}", words
            )
        return allowed.get(text, "")

    def rule_block(self, section: Section) -> None:
        operators: dict[str, Token] = {}
        builder, number = self.builder, len(self.builder.blocks)
        parser_names, first = builder.names(), len(builder.drafts)
        for line in section.lines:
            key = line.key.text
            if key == "enabled":
                self.enabled(line)
            elif key == "activation":
                operators[key] = self.word(line, ("General",))
            elif key in ("conjunction", "implication"):
                operators[key] = self.word(line, (*T_NORMS, NONE))
            elif key == "disjunction":
                operators[key] = self.word(line, (*S_NORMS, NONE))
            elif key == "rule":
                stream = self.stream(line)
                builder.drafts.append(RuleParser(stream, WORDS, parser_names, number).rule())
                self.finish_line(stream)
        if "activation" not in operators:
            raise self.source.error(section.head.key, "no activation", "'activation: General'")
        self.implications.append(operators.get("implication"))
        words = [
            named(operators.get("conjunction"), MINIMUM),
            named(operators.get("disjunction"), MAXIMUM),
            named(operators.get("implication"), MINIMUM),
        ]
        builder.blocks.append(Block(*words))
        for draft in builder.drafts[first:]:
            self.check_operator(draft, AND, operators.get("conjunction"), MINIMUM)
            self.check_operator(draft, OR, operators.get("disjunction"), MAXIMUM)

    def check_operator(
        self, draft: Draft, connective: str, operator: Token | None, wanted: str
    ) -> None:
        """An operator that no rule needs may be any."""
        if uses(draft.expression, connective) and (operator is None or operator.text != wanted):
            text = operator.text if operator else NONE
            what, at = f"'{connective}' with the operator {text}", operator or draft.at
            if text in (NONE, UNBOUNDED_SUM):
                raise self.source.error(at, what, f"'{wanted}'")
            self.builder.not_plain(at, what, f"'{wanted}'")

    def check_implications(self) -> None:
        """Weighted averages take no implication."""
        sets = [v for v in self.builder.of_kind(False) if v.system_method in model.SET_METHODS]
        if not sets:
            return
        assert sets[0].method_at is not None
        for block, implication in zip(self.blocks, self.implications, strict=True):
            if implication is None or implication.text != MINIMUM:
                text = implication.text if implication else NONE
                at = implication or block.head.key
                what = f"implication {text} with {sets[0].method_at.text}"
                self.builder.not_plain(at, what, f"'{MINIMUM}'")


def named(operator: Token | None, otherwise: str) -> str:
    return otherwise if operator is None or operator.text == NONE else operator.text
