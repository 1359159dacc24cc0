"""From a fuzzy system to the words of the firmware's table.

Inputs and outputs are int32 counts as in rules/integers/compile.py. firmware/fuzzy/fuzzy_system.h
has the layout; fuzzy_system_check() there refuses whatever could make the engine leave its bounds.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.rules.integers.cells import Axis, ceil, exact, floor, nearest
from quiesce.rules.integers.compile import Q15, Q16, input_axis, output_axis
from quiesce.rules.model import AND
from quiesce.rules.system import formula_ops
from quiesce.rules.system.fold import deferred, folded
from quiesce.rules.system.formula import Apply, Number
from quiesce.rules.system.formula_ops import FormulaError, FormulaMaker, Leaf, Part, slope_of
from quiesce.rules.system.model import (
    BY_RULE,
    BY_TERM,
    MAX_ALL_TERMS,
    MAX_DEPTH,
    MAX_LISTED,
    SET_METHODS,
    VALUE_METHODS,
    WEIGHTED,
    Complement,
    Conclusion,
    ConstantTerm,
    Curve,
    Expression,
    FormulaTerm,
    InputTerm,
    LinearTerm,
    ProductTerm,
    Proposition,
    SetTerm,
    StrengthTerm,
    System,
    SystemInput,
    SystemOutput,
    SystemRule,
    ValueTerm,
)
from quiesce.rules.system.norms import (
    ANY,
    MAXIMUM,
    MINIMUM,
    NOT,
    UNBOUNDED_SUM,
    hedge_code,
    norm_code,
)
from quiesce.rules.system.pieces import MAX_PIECES, ONE_q30, PieceError, Pieces, pieces_of
from quiesce.table.words import crc_of

MAGIC = 0x31535A46
HEADER_WORDS = 16
MAX_WORDS = 65535
METHODS = (BY_RULE, BY_TERM, WEIGHTED, *SET_METHODS)  # in the order of fuzzy_system_method_t
# fuzzy_value_kind_t
CONSTANT, LINEAR, OF_STRENGTH, OF_INPUT, PRODUCT_OF_INPUT, PRODUCT_OF_STRENGTH, FORMULA = range(7)
OP_INPUT, OP_OUTPUT, OP_ANY, OP_HEDGE, OP_AND, OP_OR = range(6)
FRESH, ONLY_HEDGE = 1 << 11, 1 << 10
MAX_VALUE = 1 << 30
MAX_FRACTION = 24
MAX_BLOCKS = 255
MAX_REACH = 4.0  # of values of the strength beyond an output's range, in ranges
TOLERANCE = 2.0**-14
MAX_SLOPE = (1 << 30) - 1
UINT32 = 0xFFFFFFFF


@dataclass(frozen=True)
class ScaledSystem:
    """A system with what its integers stand for."""

    system: System
    axes: tuple[Axis, ...]
    output_axes: tuple[Axis, ...]
    defaults: tuple[float, ...]
    notes: tuple[str, ...]

    def input_integer(self, index: int, x: np.ndarray | float) -> np.ndarray:
        """Nearest integer, after clamping x to the universe; int32."""
        variable, axis = self.system.inputs[index], self.axes[index]
        clamped = np.clip(np.asarray(x, dtype=float), variable.minimum, variable.maximum)
        return np.floor((clamped - float(axis.origin)) / float(axis.lsb) + 0.5).astype(np.int32)

    def input_value(self, index: int, n: np.ndarray | int) -> np.ndarray:
        axis = self.axes[index]
        return float(axis.origin) + np.asarray(n, dtype=float) * float(axis.lsb)

    def output_value(self, index: int, n: np.ndarray | int) -> np.ndarray:
        axis = self.output_axes[index]
        return float(axis.origin) + np.asarray(n, dtype=float) * float(axis.lsb)


@dataclass(frozen=True)
class CompiledSystem(ScaledSystem):
    """curve_error: the largest of a membership, or of a value as a share of its curve's range."""

    words: tuple[int, ...]
    curve_error: float


def compile_system(
    system: System,
    inputs: Sequence[float | str] | None = None,
    outputs: Sequence[float | str] | None = None,
    defaults: Mapping[str, float] | None = None,
    tolerance: float = TOLERANCE,
) -> CompiledSystem:
    """inputs, outputs: formats, one each, as of compile_base; tolerance: of smooth curves, of 1.
    UsageError where the integers, or the table, cannot hold the system."""
    maker = Maker(system, inputs or [Q15] * len(system.inputs), defaults or {}, tolerance)
    return maker.make(outputs or [Q16] * len(system.outputs))


@dataclass
class Body:
    """Words behind the header; add() returns where its words begin in the table. The same words
    stand once."""

    words: list[int] = field(default_factory=list)
    known: dict[tuple[int, ...], int] = field(default_factory=dict)

    def add(self, words: Sequence[int], shared: bool = False) -> int:
        key = tuple(word & UINT32 for word in words)
        if shared and key in self.known:
            return self.known[key]
        offset = HEADER_WORDS + len(self.words)
        self.known[key] = offset
        self.words += key
        return offset


class Maker:
    def __init__(
        self,
        system: System,
        forms: Sequence[float | str],
        defaults: Mapping[str, float],
        tolerance: float,
    ) -> None:
        self.said = system
        system = deferred(folded(system))
        self.system = system
        self.tolerance = tolerance
        self.given = defaults
        self.axes = [input_axis(one, form) for one, form in zip(system.inputs, forms, strict=True)]
        self.limits = [
            (ceil(axis.position(one.minimum)), floor(axis.position(one.maximum)))
            for one, axis in zip(system.inputs, self.axes, strict=True)
        ]
        self.first_terms = {
            True: first_terms(system.name, "inputs", system.inputs),
            False: first_terms(system.name, "outputs", system.outputs),
        }
        self.body = Body()
        self.error = 0.0
        self.notes: list[str] = []
        self.defaults: list[float] = []
        self.output_axes: list[Axis] = []
        self.formulas: dict[tuple[str, str], tuple[Part, float]] = {}

    def make(self, forms: Sequence[float | str]) -> CompiledSystem:
        system = self.system
        axes = [output_axis(one, form) for one, form in zip(system.outputs, forms, strict=True)]
        self.output_axes = axes
        if len(system.blocks) > MAX_BLOCKS:
            raise UsageError(
                f"{system.name}: {len(system.blocks)} rule blocks; at most {MAX_BLOCKS}"
            )
        is_listed = any(self.is_by_rule(i) for i in range(len(system.outputs)))
        if is_listed and len(system.rules) > MAX_LISTED:
            raise UsageError(
                f"{system.name}: {len(system.rules)} rules, and an output aggregates them one by "
                f"one; at most {MAX_LISTED}, or aggregation by the maximum"
            )
        inputs = [word for i in range(len(system.inputs)) for word in self.input_words(i)]
        outputs = [word for i in range(len(axes)) for word in self.output_words(i, axes[i])]
        blocks = [
            norm_code(one.conjunction) | norm_code(usable(one.disjunction)) << 8
            | norm_code(one.implication) << 16
            for one in system.blocks
        ]  # fmt: skip
        offsets = [self.body.add(words) for words in (inputs, outputs, blocks)]
        rules = self.body.add(
            [word for rule in system.rules for word in rule_words(rule, self.first_terms)]
        )
        size = HEADER_WORDS + len(self.body.words)
        if size > MAX_WORDS:
            raise UsageError(f"{system.name} needs a table of {size} words; at most {MAX_WORDS}")
        header = [
            size,
            len(system.inputs) | len(system.outputs) << 8 | len(system.blocks) << 16,
            offsets[0] | offsets[1] << 16,
            offsets[2] | rules << 16,
            len(system.rules) | int(is_listed) << 16,
            *[0] * 9,
        ]
        rest = [*header, *self.body.words]
        return CompiledSystem(
            self.said, tuple(self.axes), tuple(axes), tuple(self.defaults),
            (*system.notes, *self.notes), (MAGIC, crc_of(rest), *rest), self.error,
        )  # fmt: skip

    def curve_word(self, pieces: Pieces) -> int:
        words: list[int] = []
        for number, piece in enumerate(pieces.pieces):
            is_last = number + 1 == len(pieces.pieces)
            last = (1 << 31) - 1 if is_last else piece.last
            words += [last, piece.shift, *piece.coefficients]
        if len(pieces.pieces) > MAX_PIECES:
            raise PieceError(f"more than {MAX_PIECES} pieces")
        self.error = max(self.error, pieces.error)
        return self.body.add(words, shared=True) | len(pieces.pieces) << 16 | pieces.degree << 24

    def set_word(
        self, of: str, term: SetTerm, position: Callable, x_at: Callable, ends: tuple[int, int]
    ) -> int:
        try:
            return self.curve_word(pieces_of(term.curve, position, x_at, *ends, self.tolerance))
        except PieceError as error:
            raise UsageError(f"{of}, term {term.name}: {term.curve.word}: {error}")

    def input_words(self, index: int) -> list[int]:
        variable, ends = self.system.inputs[index], self.limits[index]
        scale = self.scale(index)
        curves = [
            self.set_word(f"input {variable.name}", term, *scale, ends) for term in variable.terms
        ]
        first = self.first_terms[True][index]
        return [*ends, self.body.add(curves) | len(curves) << 16 | first << 24, 0]

    def scale(self, index: int) -> tuple[Callable, Callable]:
        """An input's x to integers, real, and back."""
        origin, lsb = float(self.axes[index].origin), float(self.axes[index].lsb)
        return (lambda x: (x - origin) / lsb), (lambda n: origin + n * lsb)

    # ---- outputs --------------------------------------------------------------------------------

    def is_by_rule(self, index: int) -> bool:
        """Whether sets cannot be aggregated term by term: with the maximum, and one implication
        that rises with the strength, they can."""
        output = self.system.outputs[index]
        if output.method in VALUE_METHODS:
            return False
        used = {
            self.system.blocks[rule.block].implication
            for rule in self.system.rules
            if any(one.output == index for one in rule.conclusions)
        }
        return output.aggregation != MAXIMUM or len(used) > 1

    def implication_of(self, index: int) -> str:
        for rule in self.system.rules:
            if any(one.output == index for one in rule.conclusions):
                return self.system.blocks[rule.block].implication
        return MINIMUM

    def default_of(self, output: SystemOutput) -> float:
        if output.default is not None:
            return output.default
        if output.name in self.given:
            return self.given[output.name]
        value = min(max(0.0, output.minimum), output.maximum)
        self.notes.append(f"output {output.name} has no default: {value:g} where no rule fires")
        return value

    def output_words(self, index: int, axis: Axis) -> list[int]:
        output = self.system.outputs[index]
        default = self.default_of(output)
        self.defaults.append(default)
        default_count = nearest(axis.position(default))
        origin = nearest(axis.position(output.minimum))
        span = nearest(axis.position(output.maximum)) - origin
        output = self.counted_from(output, axis)
        is_sets = output.method in SET_METHODS
        offset = 0
        if output.method == WEIGHTED:  # its values count from 0
            offset = nearest(axis.position(0.0))
            axis = Axis(Fraction(0), axis.lsb)
        fraction = 0 if is_sets else self.fraction_of(output, axis)
        terms = [
            word
            for term in output.terms
            for word in (
                [self.output_set(output, term)]
                if isinstance(term, SetTerm)
                else self.value_words(output, term, axis, fraction)
            )
        ]
        return [
            METHODS.index(output.method) | norm_code(output.aggregation) << 8
            | norm_code(self.implication_of(index)) << 16 | len(output.terms) << 24,
            default_count,
            origin,
            span if is_sets or output.clips else 0,
            output.places | self.body.add(terms) << 16,
            fraction | int(self.is_by_rule(index)) << 8
            | self.first_terms[False][index] << 16,
            offset, 0,
        ]  # fmt: skip

    def counted_from(self, output: SystemOutput, axis: Axis) -> SystemOutput:
        """With products' values counted from the axis' origin, as all others are, but for those of
        a weighted sum, which count from 0."""
        origin = 0.0 if output.method == WEIGHTED else float(axis.origin)

        def moved(term: ValueTerm) -> ValueTerm:
            if isinstance(term, StrengthTerm) and self.is_endless(output, term):
                term = product_of_strength(term)
            if not isinstance(term, ProductTerm):
                return term

            def product(x: np.ndarray) -> np.ndarray:
                return origin + term.curve.function(x) - origin * term.strength(x)

            curve = Curve(term.curve.word, product, None, term.curve.knots)
            return ProductTerm(term.name, term.input, curve, term.strength)

        if output.method in SET_METHODS:
            return output
        return replace(output, terms=tuple(moved(one) for one in output.terms))

    def is_endless(self, output: SystemOutput, term: StrengthTerm) -> bool:
        """Whether its values go so far beyond the output's range that their products with the
        strength must be taken."""
        low, high = self.range_of(output, term)
        reach = MAX_REACH * (output.maximum - output.minimum)
        return low < output.minimum - reach or high > output.maximum + reach

    def output_set(self, output: SystemOutput, term: SetTerm) -> int:
        low, span = output.minimum, output.maximum - output.minimum
        return self.set_word(
            f"output {output.name}", term,
            lambda x: (x - low) / span * ONE_q30, lambda n: low + n / ONE_q30 * span,
            (0, ONE_q30),
        )  # fmt: skip

    def range_of(self, output: SystemOutput, term: ValueTerm) -> tuple[float, float]:
        """Of its values."""
        if isinstance(term, ConstantTerm):
            return term.value, term.value
        if isinstance(term, LinearTerm):
            ends = [
                sorted((slope * one.minimum, slope * one.maximum))
                for slope, one in zip(term.slopes, self.system.inputs, strict=True)
            ]
            return (
                term.constant + sum(end[0] for end in ends),
                term.constant + sum(end[1] for end in ends),
            )
        if isinstance(term, FormulaTerm):
            return self.formula_range(output, term)
        x = self.arguments(term)
        with np.errstate(all="ignore"):
            values = np.asarray(term.curve.function(x), dtype=float)
        if not np.all(np.isfinite(values)):
            raise UsageError(
                f"output {output.name}, term {term.name}: {term.curve.word}: "
                "not a number everywhere"
            )
        return float(values.min()), float(values.max())

    def arguments(self, term: InputTerm | ProductTerm | StrengthTerm) -> np.ndarray:
        if isinstance(term, StrengthTerm) or term.input is None:
            return np.linspace(0.0, 1.0, 4097)
        one = self.system.inputs[term.input]
        return np.linspace(one.minimum, one.maximum, 4097)

    def fraction_of(self, output: SystemOutput, axis: Axis) -> int:
        """Bits behind the point of values, as many as there is room for."""
        ranges = [self.range_of(output, term) for term in output.terms]
        most = max(abs(float(axis.position(end))) for both in ranges for end in both)
        span = max(high - low for low, high in ranges) / float(axis.lsb)
        room = MAX_VALUE / (2.0 * max(most, span, 1.0))
        if room < 1.0:
            raise UsageError(f"output {output.name}: its terms do not fit int32; use a larger LSB")
        return min(MAX_FRACTION, int(math.log2(room)))

    def value_words(
        self, output: SystemOutput, term: ValueTerm, axis: Axis, fraction: int
    ) -> list[int]:
        """fuzzy_value_t."""
        one = 2**fraction

        def counts(value: float) -> int:
            return nearest(axis.position(value) * one)

        if isinstance(term, ConstantTerm):
            return [CONSTANT, counts(term.value), 0, 0, 0]
        if isinstance(term, LinearTerm):
            return self.linear_words(term, axis, fraction)
        if isinstance(term, FormulaTerm):
            return self.formula_words(output, term, axis, fraction)
        low, high = self.range_of(output, term)
        span = max(high - low, 1e-30)
        curve = Curve(
            term.curve.word,
            lambda x: (np.asarray(term.curve.function(x), dtype=float) - low) / span,
            None,
            term.curve.knots,
        )
        of = None if isinstance(term, StrengthTerm) else term.input
        of_strength = (lambda x: x * ONE_q30, lambda n: n / ONE_q30)
        scale = of_strength if of is None else self.scale(of)
        ends = (0, ONE_q30) if of is None else self.limits[of]
        word = self.set_word(f"output {output.name}", SetTerm(term.name, curve), *scale, ends)
        kinds = (PRODUCT_OF_STRENGTH, PRODUCT_OF_INPUT) if isinstance(term, ProductTerm) else (
            OF_STRENGTH, OF_INPUT
        )  # fmt: skip
        kind = kinds[0] if of is None else kinds[1] | of << 8
        start = counts(low)
        return [kind, start, counts(high) - start, word, 0]

    def linear_words(self, term: LinearTerm, axis: Axis, fraction: int) -> list[int]:
        """value at the least inputs, slopes from there."""
        steps = [
            float(exact(slope) * own.lsb / axis.lsb * 2**fraction)
            for slope, own in zip(term.slopes, self.axes, strict=True)
        ]
        start = exact(term.constant) + sum(
            exact(slope) * (own.origin + ends[0] * own.lsb)
            for slope, own, ends in zip(term.slopes, self.axes, self.limits, strict=True)
        )
        largest = max(map(abs, steps), default=0.0)
        shift = 0
        while shift < 31 and largest * 2.0 ** (shift + 1) < MAX_SLOPE / 2:
            shift += 1
        slopes = [round(step * 2.0**shift) for step in steps]
        if any(abs(slope) > MAX_SLOPE for slope in slopes):
            raise UsageError(f"term {term.name}: slopes that do not fit int32; use a larger LSB")
        value = nearest((start - axis.origin) / axis.lsb * 2**fraction)
        return [LINEAR | shift << 16, value, 0, 0, self.body.add(slopes, shared=True)]

    # ---- formulas of several variables ----------------------------------------------------------

    def formula_range(self, output: SystemOutput, term: FormulaTerm) -> tuple[float, float]:
        part, low = self.formula(output, term)
        return low, low + part.high

    def formula(self, output: SystemOutput, term: FormulaTerm) -> tuple[Part, float]:
        """Its ops less its least value, and that."""
        key = (output.name, term.name)
        if key not in self.formulas:
            leaves = {name: self.input_leaf(i) for name, i in term.inputs}
            leaves |= {name: self.output_leaf(i) for name, i in term.outputs}
            maker = FormulaMaker(leaves, self.formula_curve)
            try:
                low = maker.make(term.tree).low
                part = maker.make(Apply("-", (term.tree, Number(low))))
            except (FormulaError, PieceError) as error:
                raise UsageError(f"output {output.name}, term {term.name}: Function: {error}")
            self.formulas[key] = (part, low)
        return self.formulas[key]

    def formula_curve(self, curve: Curve, position: Callable, x_at: Callable) -> int:
        ends = (-formula_ops.LIMIT, formula_ops.LIMIT)
        return self.curve_word(pieces_of(curve, position, x_at, *ends, self.tolerance))

    def input_leaf(self, index: int) -> Leaf:
        variable, axis, (first, _) = self.system.inputs[index], self.axes[index], self.limits[index]
        lsb = float(axis.lsb)
        at_first = float(axis.origin) + first * lsb
        return Leaf(
            formula_ops.OF_INPUT, index, first, at_first, lsb, variable.minimum, variable.maximum
        )

    def output_leaf(self, index: int) -> Leaf:
        """Counts from 0; of a weighted average as far as its values reach."""
        output, axis = self.system.outputs[index], self.output_axes[index]
        low, high = output.minimum, output.maximum
        if output.method in VALUE_METHODS and not output.clips:
            reach = MAX_REACH if output.method == WEIGHTED else 0.0
            ends = [self.range_of(output, term) for term in output.terms]
            low = min(low, *(a for a, _ in ends)) - reach * (high - low)
            high = max(high, *(b for _, b in ends)) + reach * (output.maximum - output.minimum)
        return Leaf(formula_ops.OF_OUTPUT, index, 0, float(axis.origin), float(axis.lsb), low, high)

    def formula_words(
        self, output: SystemOutput, term: FormulaTerm, axis: Axis, fraction: int
    ) -> list[int]:
        part, low = self.formula(output, term)
        shift, span = slope_of(math.ldexp(1.0 / float(axis.lsb), fraction - part.bits))
        ops = self.body.add([word for one in part.words for word in one], shared=True)
        value = nearest(axis.position(low) * 2**fraction)
        return [FORMULA | len(part.words) << 8 | shift << 16, value, span, 0, ops]


def usable(disjunction: str) -> str:
    """A sum without a bound is no OR; readers see to it that no rule needs it."""
    return MAXIMUM if disjunction == UNBOUNDED_SUM else disjunction


def product_of_strength(term: StrengthTerm) -> ProductTerm:
    curve = Curve(term.curve.word, lambda x: x * term.curve.function(x), None, term.curve.knots)
    return ProductTerm(term.name, None, curve, lambda x: x)


# ---- rules --------------------------------------------------------------------------------------


def first_terms(name: str, what: str, variables: Sequence[SystemInput | SystemOutput]) -> list[int]:
    """The number of each one's first term among those of all."""
    counts = [len(one.terms) for one in variables]
    if sum(counts) > MAX_ALL_TERMS:
        raise UsageError(
            f"{name}: {sum(counts)} terms of all {what} together; at most {MAX_ALL_TERMS}"
        )
    return [sum(counts[:i]) for i in range(len(counts))]


def rule_words(rule: SystemRule, first: Mapping[bool, Sequence[int]]) -> list[int]:
    ops = ops_of(rule.expression, first)
    if len(ops) > 255 or depth_of(ops) > MAX_DEPTH:
        raise UsageError("a rule that is nested too deeply, or has too many conditions; split it")
    conclusions = [word for one in rule.conclusions for word in conclusion_words(one)]
    if len(conclusions) > 255:
        raise UsageError("a rule with too many hedges in its conclusions")
    head = rule.block | len(ops) << 8 | len(conclusions) << 16
    return [head, round(rule.weight * ONE_q30), *half_words(ops), *half_words(conclusions)]


def conclusion_words(one: Conclusion) -> list[int]:
    """Hedges one by one, from the rule's own strength; the last with the conclusion itself."""
    codes = [hedge_code(hedge) for hedge in one.hedges] or [hedge_code(None)]
    words = [code << 12 | ONLY_HEDGE for code in codes]
    words[0] |= FRESH
    words[-1] += (one.output << 8 | one.term) - ONLY_HEDGE
    return words


def half_words(values: Sequence[int]) -> list[int]:
    padded = [*values, *[0] * (len(values) % 2)]
    return [a | b << 16 for a, b in zip(padded[::2], padded[1::2], strict=True)]


def ops_of(expression: Expression, numbers: Mapping[bool, Sequence[int]]) -> list[int]:
    """Postfix. numbers: of the first terms, of inputs (True) and of outputs."""
    if isinstance(expression, Complement):
        return [*ops_of(expression.part, numbers), OP_HEDGE << 12 | hedge_code(NOT)]
    if isinstance(expression, Proposition):
        return proposition_ops(expression, numbers)
    first, *rest = (ops_of(part, numbers) for part in expression.parts)
    op = (OP_AND if expression.connective == AND else OP_OR) << 12
    return [*first, *(word for part in rest for word in (*part, op))]


def proposition_ops(one: Proposition, numbers: Mapping[bool, Sequence[int]]) -> list[int]:
    kind = OP_INPUT if one.is_input else OP_OUTPUT
    number = numbers[one.is_input][one.variable] + one.term
    push = OP_ANY << 12 if ANY in one.hedges else kind << 12 | number
    hedges = [hedge for hedge in reversed(one.hedges) if hedge != ANY]
    return [push, *(OP_HEDGE << 12 | hedge_code(hedge) for hedge in hedges)]


def depth_of(ops: Sequence[int]) -> int:
    depth = most = 0
    for op in ops:
        code = op >> 12
        depth += 1 if code < OP_HEDGE else -1 if code in (OP_AND, OP_OR) else 0
        most = max(most, depth)
    return most
