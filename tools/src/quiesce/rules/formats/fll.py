"""Reads FLL, the FuzzyLite language, in the wording of versions 6 to 8."""

import re
from collections.abc import Sequence

from quiesce.rules.formats.build import Builder, Content, Options, Term, Variable
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
from quiesce.rules.formats.logic import Draft, RuleParser, Words, plain_rules, uses
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
from quiesce.rules.model import (
    AND,
    CENTROID,
    OR,
    WEIGHTED_MAX,
    WEIGHTED_SUM,
    Output,
    Point,
    Rule,
    RuleBase,
)

PATTERN = re.compile(
    rf"\s+|(?P<number>{NUMBER_PATTERN}|{INFINITE_PATTERN})|(?P<name>{WORD_PATTERN})"
    r"|(?P<symbol>[()])"
)
HEDGES = ("any", "extremely", "seldom", "somewhat", "very")
WORDS = Words(
    "if", "then", "is", "not", "and", "or", "with", ("and",), ignore_case=False, refused=HEDGES
)
RESERVED = WORDS.reserved()
OTHER_TERMS = ("Constant", "Linear", "Discrete")
T_NORMS = (
    "Minimum", "AlgebraicProduct", "BoundedDifference", "DrasticProduct", "EinsteinProduct",
    "HamacherProduct", "NilpotentMinimum",
)  # fmt: skip
S_NORMS = (
    "Maximum", "AlgebraicSum", "BoundedSum", "DrasticSum", "EinsteinSum", "HamacherSum",
    "NilpotentMaximum", "NormalizedSum", "UnboundedSum",
)  # fmt: skip
NONE = "none"
PRECISE_FROM = 2  # resolutions of a centroid, which is exact here


def read_fll(source: Source, name: str, options: Options) -> RuleBase:
    """name: of the base where the file gives it none."""
    return FllReader(source, options).read(name)


class FllReader:
    def __init__(self, source: Source, options: Options) -> None:
        self.source = source
        self.builder = Builder(source, options)
        self.drafts: list[Draft] = []
        self.implications: list[Token | None] = []  # of the rule blocks
        self.blocks: list[Section] = []

    def read(self, name: str) -> RuleBase:
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
        return self.builder.finish(title.text or name, first.key, self.rules)

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

    def stream(self, line: Line) -> Stream:
        return Stream(self.source, scan(self.source, PATTERN, line.start, line.end))

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
            self.word(line, ("true", "false"))

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

    def lock_previous(self, _variable: Variable, line: Line) -> None:
        if self.word(line, ("true", "false")).text == "true":
            raise self.source.error(line.key, "'lock-previous: true' keeps a value", "'false'")

    def term(self, variable: Variable, line: Line) -> None:
        stream = self.stream(line)
        name = stream.expect_kind(NAME, "the name of a term")
        if name.text in RESERVED:
            raise self.source.error(name, f"{name.shown()} is a word of FLL", "another name")
        at = stream.token
        self.builder.add_term(variable, Term(name, at, self.content(stream)))

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

    def discrete(self, at: Token, tokens: Sequence[Token]) -> tuple[Point, ...]:
        """Pairs, then perhaps a height."""
        height = self.height(tokens[-1]) if len(tokens) % 2 else 1.0
        ats = tokens[: len(tokens) // 2 * 2 : 2]
        values = [self.source.number(token) for token in tokens]
        pairs = zip(values[::2], values[1::2], strict=False)
        points = self.builder.points(at, list(pairs), ats)
        return tuple((x, height * mu) for x, mu in points)

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
        method = stream.expect("Centroid", "WeightedAverage")
        if method.text == "Centroid":
            self.resolution(variable, stream)
        else:
            stream.accept("Automatic", "TakagiSugeno")
        self.finish_line(stream)
        variable.method_at = method
        variable.method = self.method(method, aggregation)

    def resolution(self, variable: Variable, stream: Stream) -> None:
        if stream.token.kind != NUMBER:
            return
        at = stream.token
        value = stream.number()
        if value != int(value) or value < PRECISE_FROM:
            raise self.source.error(at, f"resolution {at.text}", "a whole number from 2 on")
        self.builder.notes.append(
            f"{variable.shown()}: an exact centroid in place of {value:g} samples"
        )

    def method(self, method: Token, aggregation: Token | None) -> str:
        text = aggregation.text if aggregation else NONE
        allowed = {"Maximum": WEIGHTED_MAX, NONE: WEIGHTED_SUM, "UnboundedSum": WEIGHTED_SUM}
        if method.text == "Centroid":
            allowed = {"Maximum": CENTROID}
        if text not in allowed:
            words = " or ".join(f"'{word}'" for word in allowed)
            raise self.source.error(
                aggregation or method, f"aggregation {text} with {method.text}", words
            )
        return allowed[text]

    def rule_block(self, section: Section) -> None:
        operators: dict[str, Token] = {}
        parser_names = self.builder.names()
        first = len(self.drafts)
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
                self.drafts.append(RuleParser(stream, WORDS, parser_names).rule())
                self.finish_line(stream)
        if "activation" not in operators:
            raise self.source.error(section.head.key, "no activation", "'activation: General'")
        self.implications.append(operators.get("implication"))
        for draft in self.drafts[first:]:
            self.check_operator(draft, AND, operators.get("conjunction"), "Minimum")
            self.check_operator(draft, OR, operators.get("disjunction"), "Maximum")

    def check_operator(
        self, draft: Draft, connective: str, operator: Token | None, wanted: str
    ) -> None:
        """An operator that no rule needs may be any."""
        if uses(draft.expression, connective) and (operator is None or operator.text != wanted):
            named = operator.text if operator else NONE
            what = f"'{connective}' with the operator {named}"
            raise self.source.error(operator or draft.at, what, f"'{wanted}'")

    def check_implications(self) -> None:
        """Weighted averages take no implication."""
        if all(v.method != CENTROID for v in self.builder.of_kind(is_input=False)):
            return
        for block, implication in zip(self.blocks, self.implications, strict=True):
            if implication is None or implication.text != "Minimum":
                named = implication.text if implication else NONE
                at = implication or block.head.key
                raise self.source.error(at, f"implication {named} with Centroid", "'Minimum'")

    def rules(self, outputs: Sequence[Output]) -> list[Rule]:
        return [rule for d in self.drafts for rule in plain_rules(self.source, d, outputs)]
