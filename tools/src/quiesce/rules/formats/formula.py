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

Values = Mapping[str, np.ndarray]
Evaluate = Callable[[Values], np.ndarray]

# A sign is an operator here.
PATTERN = re.compile(
    r"\s+|(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?![A-Za-z_]))"
    rf"|(?P<name>{WORD_PATTERN})|(?P<symbol>[-+*/^%(),])"
)
MAX_DEPTH = 32
MAX_OPERATORS = 200
CONSTANTS = {"pi": np.pi, "Pi": np.pi}
FUNCTIONS: dict[str, Callable] = {
    "abs": np.abs, "fabs": np.abs, "sqrt": np.sqrt, "exp": np.exp, "log": np.log,
    "log10": np.log10, "sin": np.sin, "cos": np.cos, "tan": np.tan, "asin": np.arcsin,
    "acos": np.arccos, "atan": np.arctan, "sinh": np.sinh, "cosh": np.cosh, "tanh": np.tanh,
    "floor": np.floor, "ceil": np.ceil, "round": np.round,
}  # fmt: skip
FUNCTIONS_OF_TWO: dict[str, Callable] = {
    "pow": np.power, "atan2": np.arctan2, "fmod": np.fmod, "max": np.maximum, "min": np.minimum,
    "lt": lambda a, b: 1.0 * (a < b), "gt": lambda a, b: 1.0 * (a > b),
    "le": lambda a, b: 1.0 * (a <= b), "ge": lambda a, b: 1.0 * (a >= b),
    "eq": lambda a, b: 1.0 * (a == b), "neq": lambda a, b: 1.0 * (a != b),
}  # fmt: skip
SUMS = {"+": np.add, "-": np.subtract}
PRODUCTS = {"*": np.multiply, "/": np.divide, "%": np.fmod}


@dataclass(frozen=True)
class Formula:
    """names: of what it is a function of."""

    names: frozenset[str]
    evaluate: Evaluate

    def __call__(self, values: Values) -> np.ndarray:
        with np.errstate(all="ignore"):
            return self.evaluate(values)


def read_formula(source: Source, start: int, end: int) -> Formula:
    """text[start:end] of a source; UsageError, placed, for what is none."""
    parser = FormulaParser(Stream(source, scan(source, PATTERN, start, end)))
    evaluate = parser.sum()
    if parser.stream.token.kind != END:
        raise parser.stream.unexpected("an operator or the end of the formula")
    return Formula(frozenset(parser.names), evaluate)


class FormulaParser:
    def __init__(self, stream: Stream) -> None:
        self.stream = stream
        self.names: set[str] = set()
        self.depth = 0
        self.operators = 0

    def sum(self) -> Evaluate:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self.stream.unexpected(f"at most {MAX_DEPTH} nested parentheses")
        found = self.chain(self.product, SUMS)
        self.depth -= 1
        return found

    def product(self) -> Evaluate:
        return self.chain(self.signed, PRODUCTS)

    def chain(self, part: Callable[[], Evaluate], operators: Mapping[str, Callable]) -> Evaluate:
        found = part()
        while self.stream.sees(*operators):
            self.operators += 1
            if self.operators > MAX_OPERATORS:
                raise self.stream.unexpected(f"at most {MAX_OPERATORS} operators in a formula")
            found = of_two(operators[self.stream.take().text], found, part())
        return found

    def signed(self) -> Evaluate:
        is_negative = False
        while self.stream.sees("-", "+"):
            is_negative ^= self.stream.take().text == "-"
        found = self.power()
        return of_one(np.negative, found) if is_negative else found

    def power(self) -> Evaluate:
        base = self.operand()
        if not self.stream.accept("^"):
            return base
        is_negative = self.stream.accept("-") is not None
        exponent = self.operand()
        return of_two(np.power, base, of_one(np.negative, exponent) if is_negative else exponent)

    def operand(self) -> Evaluate:
        stream = self.stream
        if stream.token.kind == NUMBER:
            value = stream.number()
            return lambda values: np.asarray(value)
        if stream.accept("("):
            found = self.sum()
            stream.expect(")")
            return found
        name = stream.expect_kind(NAME, "a number, a name or '('").text
        if stream.sees("("):
            return self.call(name)
        if name in CONSTANTS:
            return lambda values: np.asarray(CONSTANTS[name])
        self.names.add(name)
        return lambda values: values[name]

    def call(self, name: str) -> Evaluate:
        at = self.stream.tokens[self.stream.at - 1]
        if name not in FUNCTIONS and name not in FUNCTIONS_OF_TWO:
            known = ", ".join((*FUNCTIONS, *FUNCTIONS_OF_TWO))
            raise self.stream.source.error(at, f"no function {at.shown()}", f"one of {known}")
        self.stream.expect("(")
        first = self.sum()
        if name in FUNCTIONS:
            self.stream.expect(")")
            return of_one(FUNCTIONS[name], first)
        self.stream.expect(",")
        second = self.sum()
        self.stream.expect(")")
        return of_two(FUNCTIONS_OF_TWO[name], first, second)


def of_one(function: Callable, part: Evaluate) -> Evaluate:
    return lambda values: function(part(values))


def of_two(function: Callable, first: Evaluate, second: Evaluate) -> Evaluate:
    return lambda values: function(first(values), second(values))
