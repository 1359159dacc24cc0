"""The run-time table: 32-bit words, the same as a C constant and as a file to load.

firmware/fuzzy/fuzzy_table.h has the layout; fuzzy_table_check() there refuses whatever could make
the engine leave its bounds.
"""

import struct
from collections.abc import Sequence
from itertools import product

from quiesce.base.errors import UsageError
from quiesce.rules.integers.cells import Cell, nearest
from quiesce.rules.integers.compiled import (
    EXPONENT_STEP,
    CompiledBase,
    IntegerOutput,
    IntegerRule,
    pair_of,
)
from quiesce.rules.integers.output_shapes import LayerIntegers, Shape, layer_integers
from quiesce.rules.integers.rule_words import HEADER_WORDS, MAGIC
from quiesce.rules.model import CENTROID, WEIGHTED_MAX, WEIGHTED_SUM
from quiesce.table.words import crc_of

MAX_WORDS = 65535
MAX_CELLS = 255  # of an input
GRID_STRIDE = 8
METHOD = {WEIGHTED_SUM: 0, WEIGHTED_MAX: 1, CENTROID: 2}
ANY, PARTITION_SUM, PARTITION_MAX, PARTITION_CENTROID = range(4)
SKEWED_LEFT, BEGINS_STRETCH, BEGINS_SET = 1, 2, 4
NONE = 0xFF
UINT32 = 0xFFFFFFFF


def table_words(compiled: CompiledBase) -> list[int]:
    body = Body()
    form = form_of(compiled)
    twins = 0
    if form >= PARTITION_SUM:
        body.add(block_words(compiled, form))
        twins = body.add(twins_words(compiled)) if form == PARTITION_MAX else 0
    for variable, cells in zip(compiled.base.inputs, compiled.cells, strict=True):
        if len(cells) > MAX_CELLS:
            raise UsageError(
                f"input {variable.name}: its sets bend at too many places, {len(cells)} cells; "
                f"at most {MAX_CELLS}"
            )
    axes = [body.add(cells_words(cells)) for cells in compiled.cells]
    rules = body.add([word for rule in compiled.rules for word in rule_words(rule)])
    outputs = [add_output(body, compiled, index) for index in range(len(compiled.outputs))]
    size = HEADER_WORDS + len(body.words)
    if size > MAX_WORDS:
        raise UsageError(f"the rule base needs a table of {size} words; at most {MAX_WORDS}")
    shape = len(axes) | len(outputs) << 8 | compiled.bits << 16 | form << 24
    inputs = [
        offset | len(cells) << 16 | stride(cells) << 24
        for offset, cells in zip(axes, compiled.cells, strict=True)
    ]
    header = [
        size,
        shape,
        *padded(inputs, 4),
        rules | len(compiled.rules) << 16,
        *padded(outputs, 4),
    ]
    first = compiled.outputs[0]
    quick = [
        1 << compiled.bits,
        first.origin & UINT32,
        twins | first.fraction << 16 | int(compiled.is_for_controller) << 24,
    ]
    rest = [*header, *quick, *body.words]
    return [MAGIC, crc_of(rest), *rest]


def block_words(compiled: CompiledBase, form: int) -> list[int]:
    """The grid's values (terms of a centroid), with a row and a column beyond the sets."""
    terms = [*grid_terms(compiled, 0), *[NONE] * GRID_STRIDE]
    if form == PARTITION_CENTROID:
        return [0 if term == NONE else term for term in terms]
    return [0 if term == NONE else compiled.outputs[0].terms[term] for term in terms]


def twins_words(compiled: CompiledBase) -> list[int]:
    """fuzzy_twins_t of every block by its first place."""
    terms = [*grid_terms(compiled, 0), *[NONE] * GRID_STRIDE]
    rows = len(terms) // GRID_STRIDE - 1
    return [
        twins_of([terms[place + step] for step in (0, 1, GRID_STRIDE, GRID_STRIDE + 1)])
        if place % GRID_STRIDE < GRID_STRIDE - 1
        else 0
        for place in range(rows * GRID_STRIDE)
    ]


# In the order of fuzzy_twins_t: the groups of equal ones among places a b c d.
TWINS = (
    "a b c d", "ab c d", "ac b d", "ad b c", "bc a d", "bd a c", "cd a b",
    "ab cd", "ac bd", "ad bc", "abc d", "abd c", "acd b", "bcd a", "abcd",
)  # fmt: skip


def twins_of(terms: Sequence[int]) -> int:
    """What lies beyond the grid is like nothing."""
    groups: dict[object, str] = {}
    for place, term in zip("abcd", terms, strict=True):
        key = place if term == NONE else term
        groups[key] = groups.get(key, "") + place
    wanted = sorted(groups.values())
    return next(i for i, name in enumerate(TWINS) if sorted(name.split()) == wanted)


def form_of(compiled: CompiledBase) -> int:
    """fuzzy_form_t: the most that the engine can take for granted."""
    if not compiled.is_partition:
        return ANY
    return {
        WEIGHTED_SUM: PARTITION_SUM,
        WEIGHTED_MAX: PARTITION_MAX,
        CENTROID: PARTITION_CENTROID,
    }[compiled.outputs[0].method]


def padded(words: Sequence[int], count: int) -> list[int]:
    return [*words, *[0] * (count - len(words))]


class Body:
    """Words after the header; add() returns where its words begin in the table."""

    def __init__(self) -> None:
        self.words: list[int] = []

    def add(self, words: Sequence[int]) -> int:
        offset = HEADER_WORDS + len(self.words)
        self.words += [word & UINT32 for word in words]
        return offset


def stride(cells: Sequence[Cell]) -> int:
    return 4 + 4 * max(2, *(len(cell.ramps) for cell in cells))


def cells_words(cells: Sequence[Cell]) -> list[int]:
    out = []
    for cell in cells:
        ramps = [word for ramp in cell.ramps for word in (ramp.a, ramp.a >> 32, ramp.b, ramp.set)]
        head = [cell.last, cell.first, cell.shift, len(cell.ramps)]
        out += padded([*head, *ramps], stride(cells))
    return out


def rule_words(rule: IntegerRule) -> list[int]:
    conditions = [(i << 3 | fuzzy_set | negated << 7) for i, fuzzy_set, negated in rule.conditions]
    conclusions = [NONE if term is None else term for term in rule.conclusions]
    steps = rule.exponent // EXPONENT_STEP
    head = rule.weight_q19 | rule.is_or << 20 | steps << 21 | len(conditions) << 24
    return [
        head,
        *packed(padded(conditions, 8)),
        *packed([*conclusions, *[NONE] * (4 - len(conclusions))]),
    ]


def packed(values: Sequence[int]) -> list[int]:
    """Bytes in words, the first in the lowest."""
    return list(struct.unpack(f"<{len(values) // 4}I", bytes(values)))


def add_output(body: Body, compiled: CompiledBase, index: int) -> int:
    output = compiled.outputs[index]
    if output.shapes:
        shapes = output.shapes
        data = body.add(centroid_words(compiled, output))
        every = (*shapes.shapes, *(one for stretch in shapes.stretches for one in stretch))
        count = len(shapes.order)
        layers, term_layers = (
            sum(len(shape.layers) for shape in chosen) for chosen in (every, shapes.terms)
        )
    else:
        data = body.add(output.terms)
        count, layers, term_layers = len(output.terms), 0, 0
    head = METHOD[output.method] | count << 8 | layers << 16
    return body.add(
        [head, output.default, output.origin, output.span, data, term_layers, output.fraction, 0]
    )


def grid_terms(compiled: CompiledBase, index: int) -> list[int]:
    """Of a partition: the term of every pair of sets, rows of GRID_STRIDE."""
    conclusion = {pair_of(rule): rule.conclusions[index] for rule in compiled.rules}
    rows, columns = (len(variable.sets) for variable in compiled.base.inputs)
    grid = [NONE] * (rows * GRID_STRIDE)
    for row, column in product(range(rows), range(columns)):
        grid[row * GRID_STRIDE + column] = conclusion[row, column] or 0
    return grid


def centroid_words(compiled: CompiledBase, output: IntegerOutput) -> list[int]:
    """Peaks of the terms, then the layers."""
    shapes = output.shapes
    assert shapes is not None
    one = 1 << compiled.bits
    words = [nearest(peak * one) for peak in shapes.peaks]
    for shape in shapes.shapes:
        for layer in shape.layers:
            words += layer_words(shape, layer_integers(layer, compiled.bits), 0)
    for shapes_here in shapes.stretches:
        marks = BEGINS_STRETCH
        for shape in shapes_here:
            marks |= BEGINS_SET
            for layer in shape.layers:
                words += layer_words(shape, layer_integers(layer, compiled.bits), marks)
                marks = 0
    return words


def layer_words(shape: Shape, layer: LayerIntegers, marks: int) -> list[int]:
    marks |= SKEWED_LEFT if layer.is_skewed_left else 0
    head = shape.first | shape.second << 8 | marks << 16 | layer.steep << 24
    return [head, layer.start, layer.height, *layer.flanks]
