"""From a rule base to integers: what both engines of the firmware compute with.

Inputs are int32 counts of `lsb` from an origin: "q15" spreads a universe over 0..32768, a number is
a physical unit (1e-6 for uHz) counted from 0. Outputs likewise: "q16" is 0..65536 over the
universe. table.py makes the firmware's table of these integers, emit.py straight-line C;
firmware/fuzzy/fuzzy.h says what they mean.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product

from quiesce.base.errors import UsageError
from quiesce.rules.integers.cells import Axis, Cell, Ramp, ceil, exact, floor, make_cells, nearest
from quiesce.rules.integers.compiled import (
    EXPONENT_STEP,
    MAX_EXPONENT,
    WEIGHT_ONE,
    CompiledBase,
    IntegerOutput,
    IntegerRule,
    pair_of,
)
from quiesce.rules.integers.output_shapes import OutputShapes, layer_integers, make_shapes
from quiesce.rules.model import AND, CENTROID, Input, Output, Rule, RuleBase

Q15 = "q15"
Q16 = "q16"
INT32_LIMIT = 2**31 - 1
MAX_OUTPUT_COUNTS = 2**24  # of an output's universe
GENERAL_BITS = 28
MIN_WEIGHT = 1 << 9  # so that its rounding stays below a thousandth of it
MEMBERSHIP_ERROR = Fraction(5, 8)  # units of 2^-bits (cells.py)
# Where the sum of strengths is known to lie in 1..2: fewer bits, so that 32-bit words and one
# division do; bound.py tells the error that is left.
PARTITION_BITS = 16
WIDE_PARTITION_BITS = 18
WIDE_PARTITION_FRACTION = 2
MAX_FRACTION = 8
MAX_TERM_BITS = 24
CENTROID_PARTITION_BITS = 17
MIN_PARTITION_AREA = Fraction(1, 64)
MAX_NARROW_ERROR = Fraction(9, 8)  # counts
NARROW_COUNTS = 2**15  # an output's range inside any cell, for PARTITION_BITS


def compile_base(
    base: RuleBase,
    inputs: str | Sequence[float | str] = Q15,
    outputs: str | Sequence[float | str] = Q16,
    defaults: Mapping[str, float] | None = None,
) -> CompiledBase:
    """inputs, outputs: one format for all, or one each: "q15"/"q16" or a physical LSB > 0.

    defaults: of outputs, by name, for which the file states none; else the value nearest to 0, with
    a note.
    UsageError where the integers cannot hold the base.
    """
    axes = tuple(
        input_axis(variable, form)
        for variable, form in zip(base.inputs, each(inputs, base.inputs), strict=True)
    )
    forms = each(outputs, base.outputs)
    notes: list[str] = []
    made = tuple(
        make_output(output, form, default_of(output, defaults or {}, notes))
        for output, form in zip(base.outputs, forms, strict=True)
    )
    order = tuple(left_to_right(variable) for variable in base.inputs)
    sorted_base = replace(base, inputs=tuple(map(reordered, base.inputs, order)))
    rules = tuple(integer_rule(rule, order, made) for rule in base.rules)
    bits = GENERAL_BITS
    cells = all_cells(sorted_base, axes, bits)
    is_grid = has_grid(base, rules) and all(len(cell.ramps) <= 2 for axis in cells for cell in axis)
    is_partition = is_grid and len(made) == 1 and has_partition(cells, bits, made[0])
    if is_partition:
        bits, fraction = partition_bits(made[0], base.outputs[0], cells, rules)
        if made[0].method != CENTROID:
            made = (with_fraction(made[0], base.outputs[0], fraction),)
        cells = all_cells(sorted_base, axes, bits)
    return CompiledBase(
        base, axes, cells, rules, made, bits, is_grid, is_partition, (*base.notes, *notes), order
    )


def left_to_right(variable: Input) -> tuple[int, ...]:
    """Indices of the sets by the middle of where they are greatest."""

    def middle(index: int) -> float:
        points = variable.sets[index].points
        peak = max(mu for _, mu in points)
        tops = [min(max(x, variable.minimum), variable.maximum) for x, mu in points if mu == peak]
        # A shoulder is greatest up to the end of the universe.
        low = variable.minimum if points[0][1] == peak else tops[0]
        high = variable.maximum if points[-1][1] == peak else tops[-1]
        return low + high

    return tuple(sorted(range(len(variable.sets)), key=middle))


def reordered(variable: Input, order: tuple[int, ...]) -> Input:
    return replace(variable, sets=tuple(variable.sets[index] for index in order))


def each(forms: str | Sequence[float | str], variables: Sequence) -> list[float | str]:
    if isinstance(forms, str):
        return [forms] * len(variables)
    if len(forms) != len(variables):
        raise UsageError(f"{len(forms)} formats for {len(variables)} variables: one each, please")
    return list(forms)


def all_cells(base: RuleBase, axes: Sequence[Axis], bits: int) -> tuple[tuple[Cell, ...], ...]:
    return tuple(
        make_cells(variable, axis, bits) for variable, axis in zip(base.inputs, axes, strict=True)
    )


def physical_lsb(name: str, form: float | str) -> Fraction:
    """The shortest decimal that reads as this number: 1e-6 is one millionth exactly."""
    lsb = float(form)
    if not 0 < lsb < float("inf"):
        raise UsageError(f"{name}: an LSB of {form}; a number above 0, please")
    return exact(lsb)


def input_axis(variable: Input, form: float | str) -> Axis:
    low, high = exact(variable.minimum), exact(variable.maximum)
    if form == Q15:
        return Axis(low, (high - low) / 32768)
    lsb = physical_lsb(variable.name, form)
    if not (-INT32_LIMIT <= low / lsb and high / lsb <= INT32_LIMIT):
        raise UsageError(
            f"input {variable.name}: its universe does not fit int32 at an LSB of {form}"
        )
    if floor(high / lsb) - ceil(low / lsb) < 1:
        raise UsageError(f"input {variable.name}: its universe holds no two counts of {form}")
    return Axis(Fraction(0), lsb)


def default_of(output: Output, defaults: Mapping[str, float], notes: list[str]) -> float:
    if output.default is not None:
        return output.default
    if output.name in defaults:
        return defaults[output.name]
    value = min(max(0.0, output.minimum), output.maximum)
    notes.append(f"output {output.name} has no default: {value:g} where no rule fires")
    return value


def output_axis(output: Output, form: float | str) -> Axis:
    low, high = exact(output.minimum), exact(output.maximum)
    if form == Q16:
        return Axis(low, (high - low) / 65536)
    axis = Axis(Fraction(0), physical_lsb(output.name, form))
    counts = [axis.position(output.minimum), axis.position(output.maximum)]
    if (
        max(abs(count) for count in counts) > INT32_LIMIT
        or counts[1] - counts[0] > MAX_OUTPUT_COUNTS - 2
    ):
        raise UsageError(f"output {output.name}: more than 2^24 counts of {form}; use a larger LSB")
    return axis


def make_output(output: Output, form: float | str, default: float) -> IntegerOutput:
    axis = output_axis(output, form)
    default_count = nearest(axis.position(default))
    if abs(default_count) > INT32_LIMIT:
        raise UsageError(f"output {output.name}: its default does not fit int32")
    if output.method == CENTROID:
        return centroid_output(output, axis, default_count)
    values = [axis.position(term.value) for term in output.terms]
    origin = floor(min(values))
    if ceil(max(values)) - origin >= MAX_OUTPUT_COUNTS:
        raise UsageError(f"output {output.name}: its singletons span more than 2^24 counts")
    if not -INT32_LIMIT <= origin <= INT32_LIMIT - MAX_OUTPUT_COUNTS:
        raise UsageError(f"output {output.name}: its singletons lie too far from 0 for int32")
    return with_fraction(
        IntegerOutput(output.method, axis, origin, default_count, (), 0, 0, None),
        output,
        min(MAX_FRACTION, MAX_TERM_BITS - (ceil(max(values)) - origin).bit_length()),
    )


def with_fraction(made: IntegerOutput, output: Output, fraction: int) -> IntegerOutput:
    """Its singletons in 2^-fraction of a count, as far as one of them needs that."""
    exact_terms = [made.axis.position(term.value) - made.origin for term in output.terms]
    while fraction and all((term * 2 ** (fraction - 1)).denominator == 1 for term in exact_terms):
        fraction -= 1
    terms = tuple(max(0, nearest(term * 2**fraction)) for term in exact_terms)
    return replace(made, terms=terms, fraction=fraction)


def centroid_output(output: Output, axis: Axis, default: int) -> IntegerOutput:
    origin = floor(axis.position(output.minimum))
    span = ceil(axis.position(output.maximum)) - origin
    low = axis.origin + origin * axis.lsb
    shapes = make_shapes(output, low, span * axis.lsb)
    terms = tuple(shapes.order.index(index) for index in range(len(output.terms)))
    return IntegerOutput(output.method, axis, origin, default, terms, 0, span, shapes)


def integer_rule(
    rule: Rule, order: Sequence[tuple[int, ...]], outputs: Sequence[IntegerOutput]
) -> IntegerRule:
    conclusions = tuple(
        None if term is None else output.terms[term] if output.shapes else term
        for term, output in zip(rule.conclusions, outputs, strict=True)
    )
    return IntegerRule(
        tuple((c.input, order[c.input].index(c.set), c.negated) for c in rule.conditions),
        conclusions,
        rule.connective != AND and len(rule.conditions) > 1,
        *weight_integers(rule.weight),
    )


def weight_integers(weight: float) -> tuple[int, int]:
    """Mantissa in 2^-19 and exponent: weight = mantissa * 2^-(19 + exponent)."""
    exponent, scaled = 0, exact(weight) * WEIGHT_ONE
    while exponent < MAX_EXPONENT and scaled * 2**EXPONENT_STEP <= WEIGHT_ONE:
        exponent += EXPONENT_STEP
        scaled *= 2**EXPONENT_STEP
    if weight == 0:
        return 0, 0
    if scaled < MIN_WEIGHT:
        raise UsageError(
            f"a rule's weight of {weight:g} is too small for its integers; at least "
            f"{MIN_WEIGHT / (WEIGHT_ONE << MAX_EXPONENT):.1g}, or 0"
        )
    return nearest(scaled), exponent


def has_grid(base: RuleBase, rules: Sequence[IntegerRule]) -> bool:
    """Whether every pair of sets has one plain rule with a conclusion for every output."""
    if len(base.inputs) != 2:
        return False
    pairs = [pair_of(rule) for rule in rules]
    wanted = set(product(*(range(len(variable.sets)) for variable in base.inputs)))
    return len(pairs) == len(wanted) and set(pairs) == wanted


def has_partition(cells: Sequence[Sequence[Cell]], bits: int, output: IntegerOutput) -> bool:
    if output.shapes and not is_ample(output.shapes):
        return False
    return all(adds_to_one(cell, bits) for axis in cells for cell in axis)


def is_ample(shapes: OutputShapes) -> bool:
    """In order, every set reaches 1 and, half filled, an area that 22 bits of the universe's hold
    well, and no flank needs fuzzy_layer_t's steep."""
    layers = [layer for shape in shapes.shapes for layer in shape.layers]
    return (
        not shapes.not_ordered
        and all(peak == 1 for peak in shapes.peaks)
        and all(term.area(Fraction(1, 2)) >= MIN_PARTITION_AREA for term in shapes.terms)
        and all(layer_integers(layer, CENTROID_PARTITION_BITS).steep == 0 for layer in layers)
    )


def adds_to_one(cell: Cell, bits: int) -> bool:
    """Everywhere in the cell: one set at 1, or two neighbours that are complementary."""
    if len(cell.ramps) == 1:
        return cell.ramps[0].b == 0 and cell.ramps[0].membership(0, 0) == 1 << bits
    if len(cell.ramps) != 2 or cell.ramps[1].set != cell.ramps[0].set + 1:
        return False
    return is_complementary(cell.ramps, bits)


def is_complementary(ramps: Sequence[Ramp], bits: int) -> bool:
    total = (1 << (bits + 32)) + (1 << 32) - 1
    return ramps[0].b == -ramps[1].b and ramps[0].a + ramps[1].a == total


def partition_bits(
    made: IntegerOutput,
    output: Output,
    cells: Sequence[Sequence[Cell]],
    rules: Sequence[IntegerRule],
) -> tuple[int, int]:
    """Bits of membership and of the singletons' fraction: the fewest that keep the error about one
    count."""
    if made.method == CENTROID:
        return CENTROID_PARTITION_BITS, 0
    rule_of = {pair_of(rule): rule for rule in rules}
    plain = with_fraction(made, output, 0)
    error = MEMBERSHIP_ERROR / 2**PARTITION_BITS
    rounding = Fraction(1, 2) + singleton_error(plain, output)
    for rows, columns in product(set_pairs(cells[0]), set_pairs(cells[1])):
        found = [plain.terms[rule_of[pair].conclusions[0]] for pair in product(rows, columns)]
        spread = max(sum(abs(c - end) for c in found) for end in (min(found), max(found)))
        is_wide = max(found) - min(found) > NARROW_COUNTS
        if is_wide or rounding + error * spread > MAX_NARROW_ERROR:
            room = MAX_TERM_BITS - (max(plain.terms) + 1).bit_length()
            return WIDE_PARTITION_BITS, max(0, min(WIDE_PARTITION_FRACTION, room))
    return PARTITION_BITS, 0


def singleton_error(made: IntegerOutput, output: Output) -> Fraction:
    """Of their rounding, in counts."""
    return max(
        abs(made.axis.position(term.value) - made.origin - Fraction(integer, 2**made.fraction))
        for term, integer in zip(output.terms, made.terms, strict=True)
    )


def set_pairs(cells: Sequence[Cell]) -> set[tuple[int, ...]]:
    return {tuple(ramp.set for ramp in cell.ramps) for cell in cells}
