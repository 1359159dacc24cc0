"""Straight-line C of one rule base: the table engine, evaluated as far as the base is known.

The cells of every input are found by a tree of comparisons; in each combination of cells only the
rules that can fire there are left, with constants for all that is constant. The numbers are those
of the table engine, bit for bit. NotStraight says why a base has no such form.
"""

import re
from collections.abc import Iterator, Sequence
from math import prod

from quiesce.rules.integers.affine import Affine, Order, constant, maximum, minimum
from quiesce.rules.integers.c_writer import INDENT, CWriter, int_text
from quiesce.rules.integers.cells import Cell, Ramp
from quiesce.rules.integers.compile import is_complementary
from quiesce.rules.integers.compiled import CompiledBase, IntegerRule
from quiesce.rules.integers.emit_output import OutputWriter

MAX_OVERLAP = 2  # sets of an input that overlap
MAX_LEAVES = 400  # combinations of cells


class NotStraight(Exception):
    """Why a base has no straight-line form; one line."""


def why_not_straight(compiled: CompiledBase) -> str:
    """Empty where straight_line_c() can write the base."""
    for variable, cells in zip(compiled.base.inputs, compiled.cells, strict=True):
        most = max(len(cell.ramps) for cell in cells)
        if most > MAX_OVERLAP:
            return (
                f"{most} sets of input {variable.name} overlap; straight-line C takes {MAX_OVERLAP}"
            )
    for output in compiled.outputs:
        if output.shapes and output.shapes.not_ordered:
            return (
                f"{output.shapes.not_ordered}; straight-line C takes sets that follow one another"
            )
    is_weighted = not all(rule.is_full for rule in compiled.rules)
    if is_weighted and any(output.shapes for output in compiled.outputs):
        return "rules have weights and an output is a centroid; straight-line C takes one of both"
    leaves = prod(len(cells) for cells in compiled.cells)
    if leaves > MAX_LEAVES:
        return f"{leaves} combinations of cells; straight-line C takes {MAX_LEAVES}"
    return ""


def straight_line_c(compiled: CompiledBase, name: str) -> str:
    """Definition of `uint32_t NAME(const int32_t *input, int32_t *output)`, a fuzzy_function_t."""
    reason = why_not_straight(compiled)
    if reason:
        raise NotStraight(reason)
    writer = CWriter()
    writer.line(f"uint32_t {name}(const int32_t *input, int32_t *output) {{")
    with writer.indented():
        for index, variable in enumerate(compiled.base.inputs):
            writer.line(f"const int32_t x{index} = input[{index}]; // {variable.name}")
        Tree(compiled, writer).cells(0, ())
        writer.drop_unused(1)
        if not any(re.search(r"\binput\b", line) for line in writer.lines[1:]):
            writer.lines.insert(1, INDENT + "(void)input;")
    writer.line("}")
    return "\n".join(writer.lines) + "\n"


class Tree:
    """Comparisons that find the cell of every input, then the leaf for them."""

    def __init__(self, compiled: CompiledBase, writer: CWriter) -> None:
        self.compiled, self.writer = compiled, writer

    def cells(self, index: int, chosen: tuple[Cell, ...]) -> None:
        """The rest of the inputs from `index` on, the cells of those before it known."""
        if index == len(self.compiled.cells):
            Leaf(self.compiled, self.writer, chosen).write()
            return
        self.tree(index, self.compiled.cells[index], chosen)

    def tree(self, index: int, cells: Sequence[Cell], chosen: tuple[Cell, ...]) -> None:
        if len(cells) == 1:
            self.cells(index + 1, (*chosen, cells[0]))
            return
        split = best_split(tuple(cell_cost(cell) for cell in cells))
        self.writer.branch(
            f"x{index} <= {int_text(cells[split - 1].last)}",
            lambda: self.tree(index, cells[:split], chosen),
            lambda: self.tree(index, cells[split:], chosen),
        )


# Instructions, roughly: of one comparison, and of the memberships of a cell.
COMPARE_COST = 3
RAMP_COST = 4


def cell_cost(cell: Cell) -> int:
    return RAMP_COST if any(ramp.b for ramp in cell.ramps) else 0


def best_split(costs: tuple[int, ...]) -> int:
    """Number of cells on the lower side that makes the dearest path cheapest."""
    return tree_costs(costs)[1]


def tree_costs(costs: tuple[int, ...]) -> tuple[int, int]:
    """Cost of the dearest path of the best tree over the cells, and its first split."""
    best: dict[tuple[int, int], tuple[int, int]] = {}
    count = len(costs)
    for length in range(1, count + 1):
        for start in range(count - length + 1):
            end = start + length
            if length == 1:
                best[start, end] = (costs[start], 0)
                continue
            best[start, end] = min(
                (COMPARE_COST + max(best[start, k][0], best[k, end][0]), k - start)
                for k in range(start + 1, end)
            )
    return best[0, count]


class Leaf:
    """One combination of cells."""

    def __init__(self, compiled: CompiledBase, writer: CWriter, cells: tuple[Cell, ...]) -> None:
        self.compiled, self.writer = compiled, writer
        self.one = 1 << self.compiled.bits
        self.cells = cells
        self.memberships: dict[tuple[int, int], Affine] = {}

    def write(self) -> None:
        start = len(self.writer.lines)
        self.writer.names = 0  # a leaf is a scope of its own
        self.write_all()
        self.writer.drop_unused(start)

    def write_all(self) -> None:
        pairs = [self.define(index, cell) for index, cell in enumerate(self.cells)]
        names = [name for name in pairs if name]
        if len(names) == 2 and all(pairs):
            self.write_regions(*names)
        else:
            self.write_outputs(Order.none(self.one))

    def define(self, index: int, cell: Cell) -> str:
        """Memberships of one input as C variables. Returns the name where two add up to 1."""
        for ramp in cell.ramps:
            if ramp.b == 0:
                self.memberships[index, ramp.set] = constant(ramp.membership(0, 0))
        slopes = [ramp for ramp in cell.ramps if ramp.b]
        if self.is_pair(slopes):
            rising = max(slopes, key=lambda ramp: ramp.b)
            falling = min(slopes, key=lambda ramp: ramp.b)
            name = self.define_ramp(index, cell, rising)
            self.memberships[index, falling.set] = Affine(self.one, {name: -1})
            return name
        for ramp in slopes:
            self.define_ramp(index, cell, ramp)
        return ""

    def is_pair(self, slopes: Sequence[Ramp]) -> bool:
        return len(slopes) == 2 and is_complementary(slopes, self.compiled.bits)

    def define_ramp(self, index: int, cell: Cell, ramp: Ramp) -> str:
        name = f"m{index}_{ramp.set}"
        self.writer.line(f"const uint32_t {name} = {ramp_text(index, cell, ramp, self.one)};")
        self.memberships[index, ramp.set] = Affine(0, {name: 1})
        return name

    def write_regions(self, u: str, v: str) -> None:
        """Which of u, 1-u, v, 1-v is least decides every minimum."""
        writer = self.writer

        def side(u_is_less: bool) -> None:
            writer.branch(
                f"{u} + {v} <= {self.one}u",
                lambda: self.write_outputs(Order.region(self.one, u, v, u_is_less, True)),
                lambda: self.write_outputs(Order.region(self.one, u, v, u_is_less, False)),
            )

        writer.branch(f"{u} <= {v}", lambda: side(True), lambda: side(False))

    def write_outputs(self, order: Order) -> None:
        self.writer.names = 0
        fired = list(self.fired(order))
        defaults = [
            OutputWriter(self.compiled, self.writer, index, order).write(fired)
            for index in range(len(self.compiled.outputs))
        ]
        self.writer.line(f"return {' | '.join(text for text in defaults if text) or '0'};")

    def fired(self, order: Order) -> Iterator[tuple[IntegerRule, Affine]]:
        """Rules that can fire here, with their memberships."""
        for rule in self.compiled.rules:
            membership = self.rule_membership(rule, order)
            if not membership.is_zero and rule.weight_q19:
                yield rule, membership

    def rule_membership(self, rule: IntegerRule, order: Order) -> Affine:
        """Of all its conditions together, before the weight."""
        values = []
        for index, fuzzy_set, negated in rule.conditions:
            direct = self.memberships.get((index, fuzzy_set), constant(0))
            values.append(direct.complement(self.one) if negated else direct)
        return (maximum if rule.is_or else minimum)(values, order, self.writer.named)


def ramp_text(index: int, cell: Cell, ramp: Ramp, one: int) -> str:
    """In 32 bits where that gives the same: the upper half of the product's low bits is all."""
    narrow = 32 - cell.shift
    if (one + 1) << narrow <= 1 << 32 and ramp.a >> cell.shift >= 0:
        offset = ((ramp.a >> cell.shift) - ramp.b * cell.first) & 0xFFFFFFFF
        sign, slope = ("-", -ramp.b) if ramp.b < 0 else ("+", ramp.b)
        return f"({offset}u {sign} {slope}u * (uint32_t)x{index}) >> {narrow}"
    first = cell.first & 0xFFFFFFFF
    distance = f"(uint32_t)x{index} - {first}u"
    if cell.shift:
        distance = f"({distance}) << {cell.shift}"
    return f"fuzzy_ramp(INT64_C({ramp.a}), {ramp.b}, {distance})"
