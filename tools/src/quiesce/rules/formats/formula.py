"""Formulas of a rule file, such as `sin(x)/x`: read without eval, into a function of arrays."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from quiesce.rules.formats.scan import (
    END,
    NAME,
    NUMBER,
    WORD_PATTERN,
    Source,
    Stream,
    scan,
)
from quiesce.rules.system.formula import (
    FUNCTIONS,
    FUNCTIONS_OF_TWO,
    NEGATE,
    POWER,
    PRODUCTS,
    SUMS,
    Apply,
    Name,
    Number,
    Tree,
    names_of,
    value_of,
)

Values = Mapping[str, np.ndarray]

# A sign is an operator here.
PATTERN = re.compile(
    r"\s+|(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?![A-Za-z_]))"
    rf"|(?P<name>{WORD_PATTERN})|(?P<symbol>[-+*/^%(),])"
)
MAX_DEPTH = 32
MAX_OPERATORS = 200
CONSTANTS = {"pi": np.pi, "Pi": np.pi}


@dataclass(frozen=True)
class Formula:
    """names: of what it is a function of."""

    names: frozenset[str]
    tree: Tree

    def __call__(self, values: Values) -> np.ndarray:
        return value_of(self.tree, values)


def read_formula(source: Source, start: int, end: int) -> Formula:
    """text[start:end] of a source; UsageError, placed, for what is none."""
    parser = FormulaParser(Stream(source, scan(source, PATTERN, start, end)))
    tree = parser.sum()
    if parser.stream.token.kind != END:
        raise parser.stream.unexpected("an operator or the end of the formula")
    return Formula(names_of(tree), tree)


class FormulaParser:
    def __init__(self, stream: Stream) -> None:
        self.stream = stream
        self.depth = 0
        self.operators = 0

    def sum(self) -> Tree:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self.stream.unexpected(f"at most {MAX_DEPTH} nested parentheses")
        found = self.chain(self.product, SUMS)
        self.depth -= 1
        return found

    def product(self) -> Tree:
        return self.chain(self.signed, PRODUCTS)

    def chain(self, part: Callable[[], Tree], operators: Mapping[str, Callable]) -> Tree:
        found = part()
        while self.stream.sees(*operators):
            self.operators += 1
            if self.operators > MAX_OPERATORS:
                raise self.stream.unexpected(f"at most {MAX_OPERATORS} operators in a formula")
            found = Apply(self.stream.take().text, (found, part()))
        return found

    def signed(self) -> Tree:
        is_negative = False
        while self.stream.sees("-", "+"):
            is_negative ^= self.stream.take().text == "-"
        found = self.power()
        return Apply(NEGATE, (found,)) if is_negative else found

    def power(self) -> Tree:
        base = self.operand()
        if not self.stream.accept("^"):
            return base
        is_negative = self.stream.accept("-") is not None
        exponent = self.operand()
        return Apply(POWER, (base, Apply(NEGATE, (exponent,)) if is_negative else exponent))

    def operand(self) -> Tree:
        stream = self.stream
        if stream.token.kind == NUMBER:
            return Number(stream.number())
        if stream.accept("("):
            found = self.sum()
            stream.expect(")")
            return found
        name = stream.expect_kind(NAME, "a number, a name or '('").text
        if stream.sees("("):
            return self.call(name)
        if name in CONSTANTS:
            return Number(CONSTANTS[name])
        return Name(name)

    def call(self, name: str) -> Tree:
        at = self.stream.tokens[self.stream.at - 1]
        if name not in FUNCTIONS and name not in FUNCTIONS_OF_TWO:
            known = ", ".join((*FUNCTIONS, *FUNCTIONS_OF_TWO))
            raise self.stream.source.error(at, f"no function {at.shown()}", f"one of {known}")
        self.stream.expect("(")
        first = self.sum()
        if name in FUNCTIONS:
            self.stream.expect(")")
            return Apply(name, (first,))
        self.stream.expect(",")
        second = self.sum()
        self.stream.expect(")")
        return Apply(name, (first, second))
