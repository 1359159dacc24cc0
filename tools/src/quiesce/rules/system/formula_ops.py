"""From a formula of several variables to the firmware's ops (fuzzy_formula_op_t).

Every value on the stack is r = v x 2^bits, limited to +-2^29, with bits from the interval that v
can be in; whatever depends on one thing only, be it an input, an output or a part of the formula,
is a curve over it, in pieces (pieces.py).
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from quiesce.rules.system.formula import (
    MEANINGS,
    NEGATE,
    Apply,
    Name,
    Tree,
    names_of,
    value_of,
)
from quiesce.rules.system.model import Curve

# fuzzy_formula_code_t
CONSTANT, OF_INPUT, OF_OUTPUT, ADD, SUBTRACT, MULTIPLY, LEAST, MOST, ABSOLUTE, CURVE = range(10)
LIMIT_BITS = 29
LIMIT = 1 << LIMIT_BITS
MAX_SPAN_BITS = 30
MAX_SHIFT = 62
MAX_BITS = 200  # of a value next to nothing
MAX_OPS = 64
MAX_STACK = 8
SAMPLES = 4097
BINARY = {"+": ADD, "-": SUBTRACT, "*": MULTIPLY, "min": LEAST, "max": MOST}
COMPARISONS = ("lt", "gt", "le", "ge", "eq", "neq")
ABSOLUTES = ("abs", "fabs")


class FormulaError(Exception):
    """What integers cannot follow; says why."""


@dataclass(frozen=True)
class Leaf:
    """An input or output: v = at_first + lsb x (count - first), within low .. high."""

    code: int
    number: int
    first: int
    at_first: float
    lsb: float
    low: float
    high: float


@dataclass(frozen=True)
class Part:
    """Ops that leave a value on the stack, and what is known of it."""

    words: tuple[tuple[int, ...], ...]
    low: float
    high: float
    bits: int
    depth: int


def bits_for(low: float, high: float) -> int:
    most = max(abs(low), abs(high))
    if not math.isfinite(most):
        raise FormulaError("a part that is not bounded")
    return MAX_BITS if most == 0.0 else min(MAX_BITS, LIMIT_BITS - math.frexp(most)[1])


def op(code: int, number: int = 0, left: int = 0, right: int = 0, *rest: int) -> tuple[int, ...]:
    value, span, curve = (*rest, 0, 0, 0)[:3]
    return code | number << 8 | left << 16 | right << 24, value, span, curve


class FormulaMaker:
    """leaves: of the names; curve_word: of a curve over integers, by position, back, and ends."""

    def __init__(
        self, leaves: Mapping[str, Leaf], curve_word: Callable[[Curve, Callable, Callable], int]
    ) -> None:
        self.leaves = leaves
        self.curve_word = curve_word

    def make(self, tree: Tree) -> Part:
        """FormulaError where integers cannot."""
        part = self.part(tree)
        if len(part.words) > MAX_OPS:
            raise FormulaError(f"{len(part.words)} operations, at most {MAX_OPS}")
        if part.depth > MAX_STACK:
            raise FormulaError("nested too deeply")
        return part

    def part(self, tree: Tree) -> Part:
        names = names_of(tree)
        if not names:
            return self.constant(float(value_of(tree, {})))
        if isinstance(tree, Name):
            return self.leaf(self.leaves[tree.text])
        assert isinstance(tree, Apply)
        if len(names) == 1:
            (name,) = names
            return self.curve(self.part(Name(name)), lambda v: value_of(tree, {name: v}))
        if len(tree.parts) == 1:
            return self.of_one(tree.word, self.part(tree.parts[0]))
        return self.of_two(tree.word, *tree.parts)

    def constant(self, value: float) -> Part:
        bits = bits_for(value, value)
        return Part((op(CONSTANT, 0, 0, 0, round(scaled(value, bits))),), value, value, bits, 1)

    def leaf(self, leaf: Leaf) -> Part:
        bits = bits_for(leaf.low, leaf.high)
        slope = scaled(leaf.lsb, bits)
        shift, span = slope_of(slope)
        base = round(scaled(leaf.at_first, bits))
        words = op(leaf.code, leaf.number, shift, 0, base, span)
        return Part((words,), leaf.low, leaf.high, bits, 1)

    # ---- of one part ----------------------------------------------------------------------------

    def of_one(self, word: str, part: Part) -> Part:
        if word == NEGATE:
            return self.binary(SUBTRACT, self.constant(0.0), part)
        if word in ABSOLUTES:
            ends = (abs(part.low), abs(part.high))
            low = 0.0 if part.low <= 0.0 <= part.high else min(ends)
            return replace(part, words=(*part.words, op(ABSOLUTE)), low=low, high=max(ends))
        return self.curve(part, MEANINGS[word])

    def curve(self, part: Part, function: Callable) -> Part:
        """function(v) of a part's v."""
        values = values_on(function, np.linspace(part.low, part.high, SAMPLES))
        low, high = float(values.min()), float(values.max())
        bits, span = bits_for(low, high), max(high - low, 1e-30)

        def share(v: np.ndarray) -> np.ndarray:
            return (values_on(function, np.clip(v, part.low, part.high)) - low) / span

        word = self.curve_word(
            Curve("Function", share, None, tuple(sorted({part.low, 0.0, part.high}))),
            lambda v: np.ldexp(v, part.bits),
            lambda n: np.ldexp(np.asarray(n, dtype=float), -part.bits),
        )
        start = round(scaled(low, bits))
        made = op(CURVE, 0, 0, 0, start, round(scaled(high, bits)) - start, word)
        return Part((*part.words, made), low, high, bits, part.depth)

    # ---- of two parts ---------------------------------------------------------------------------

    def of_two(self, word: str, first: Tree, second: Tree) -> Part:
        if word in BINARY:
            return self.binary(BINARY[word], self.part(first), self.part(second))
        if not names_of(second):
            constant = value_of(second, {})
            return self.curve(self.part(first), lambda v: MEANINGS[word](v, constant))
        if not names_of(first):
            constant = value_of(first, {})
            return self.curve(self.part(second), lambda v: MEANINGS[word](constant, v))
        if word == "/":
            inverse = self.curve(self.part(second), lambda v: 1.0 / v)
            return self.binary(MULTIPLY, self.part(first), inverse)
        if word in COMPARISONS:
            difference = self.binary(SUBTRACT, self.part(first), self.part(second))
            return self.curve(difference, lambda v: MEANINGS[word](v, 0.0))
        raise FormulaError(f"{word} of two things that vary")

    def binary(self, code: int, a: Part, b: Part) -> Part:
        low, high = reach(code, a, b)
        scale = a.bits + b.bits if code == MULTIPLY else min(a.bits, b.bits)
        bits = min(bits_for(low, high), scale)
        if code == MULTIPLY:
            shifts = (min(scale - bits, MAX_SHIFT), 0)
        else:
            shifts = (min(a.bits - bits, MAX_SHIFT), min(b.bits - bits, MAX_SHIFT))
        words = (*a.words, *b.words, op(code, 0, *shifts))
        return Part(words, low, high, bits, max(a.depth, 1 + b.depth))


def values_on(function: Callable, v: np.ndarray) -> np.ndarray:
    with np.errstate(all="ignore"):
        values = np.broadcast_to(np.asarray(function(v), dtype=float), np.shape(v))
    if not np.all(np.isfinite(values)):
        raise FormulaError("not a number everywhere")
    return values


def reach(code: int, a: Part, b: Part) -> tuple[float, float]:
    if code == ADD:
        return a.low + b.low, a.high + b.high
    if code == SUBTRACT:
        return a.low - b.high, a.high - b.low
    if code == MULTIPLY:
        corners = [one * other for one in (a.low, a.high) for other in (b.low, b.high)]
        return min(corners), max(corners)
    if code == LEAST:
        return min(a.low, b.low), min(a.high, b.high)
    return max(a.low, b.low), max(a.high, b.high)


def scaled(value: float, bits: int) -> float:
    return math.ldexp(value, bits)


def slope_of(slope: float) -> tuple[int, int]:
    """(shift, span) with slope = span / 2^shift, as fine as can be."""
    if slope == 0.0:
        return 0, 0
    shift = max(0, min(MAX_SHIFT, MAX_SPAN_BITS - math.frexp(slope)[1]))
    span = round(math.ldexp(slope, shift))
    if abs(span) > 1 << MAX_SPAN_BITS:
        raise FormulaError("a slope that does not fit int32; use a larger LSB")
    return shift, span
