"""Straight-line C of one rule base: the table engine, evaluated as far as the base is known.

The cells of every input are found by a tree of comparisons; in each combination of cells only the
rules that can fire there are left, with constants for all that is constant. The numbers are those
of the table engine, bit for bit. NotStraight says why a base has no such form.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from math import prod

from quiesce.rules.affine import Affine, Order, constant, maximum, minimum
from quiesce.rules.compile import (
    WEIGHT_ONE,
    CompiledBase,
    IntegerOutput,
    IntegerRule,
    is_complementary,
)
from quiesce.rules.integer_cells import Cell, Ramp, nearest
from quiesce.rules.model import CENTROID, WEIGHTED_MAX
from quiesce.rules.output_shapes import LayerIntegers, Shape, layer_integers

MAX_OVERLAP = 2  # sets of an input that overlap
MAX_LEAVES = 400  # combinations of cells
INDENT = "    "


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
    leaves = prod(len(cells) for cells in compiled.cells)
    if leaves > MAX_LEAVES:
        return f"{leaves} combinations of cells; straight-line C takes {MAX_LEAVES}"
    return ""


def straight_line_c(compiled: CompiledBase, name: str) -> str:
    """Definition of `uint32_t NAME(const int32_t *input, int32_t *output)`, a fuzzy_function_t."""
    reason = why_not_straight(compiled)
    if reason:
        raise NotStraight(reason)
    writer = Writer(compiled)
    writer.line(f"uint32_t {name}(const int32_t *input, int32_t *output) {{")
    with writer.indented():
        for index, variable in enumerate(compiled.base.inputs):
            writer.line(f"const int32_t x{index} = input[{index}]; // {variable.name}")
        writer.cells(0, ())
    writer.line("}")
    return "\n".join(writer.lines) + "\n"


@dataclass
class Writer:
    compiled: CompiledBase
    lines: list[str] = field(default_factory=list)
    depth: int = 0
    names: int = 0

    def line(self, text: str) -> None:
        self.lines.append(INDENT * self.depth + text)

    def indented(self) -> "Indent":
        return Indent(self)

    def fresh(self, prefix: str) -> str:
        self.names += 1
        return f"{prefix}{self.names}"

    def drop_unused(self, start: int) -> None:
        """Definitions that nothing after them reads, from line `start` on."""
        for index in range(len(self.lines) - 1, start - 1, -1):
            found = re.match(r" *const uint32_t (\w+) =", self.lines[index])
            name = found and re.compile(rf"\b{found[1]}\b")
            if name and not any(name.search(line) for line in self.lines[index + 1 :]):
                del self.lines[index]

    def branch(self, condition: str, yes: Callable[[], None], no: Callable[[], None]) -> None:
        """Both ways return. One way only where both do the same."""
        start = len(self.lines)
        no()
        otherwise = self.cut(start)
        yes()
        if self.lines[start:] == otherwise:
            return
        inside = [INDENT + line for line in self.cut(start)]
        self.line(f"if ({condition}) {{")
        self.lines += inside
        self.line("}")
        self.lines += otherwise

    def cut(self, start: int) -> list[str]:
        """Takes the lines from `start` on away."""
        taken = self.lines[start:]
        del self.lines[start:]
        return taken

    def cells(self, index: int, chosen: tuple[Cell, ...]) -> None:
        """The rest of the inputs from `index` on, the cells of those before it known."""
        if index == len(self.compiled.cells):
            Leaf(self, chosen).write()
            return
        self.tree(index, self.compiled.cells[index], chosen)

    def tree(self, index: int, cells: Sequence[Cell], chosen: tuple[Cell, ...]) -> None:
        if len(cells) == 1:
            self.cells(index + 1, (*chosen, cells[0]))
            return
        split = best_split(tuple(cell_cost(cell) for cell in cells))
        self.branch(
            f"x{index} <= {int_text(cells[split - 1].last)}",
            lambda: self.tree(index, cells[:split], chosen),
            lambda: self.tree(index, cells[split:], chosen),
        )


class Indent:
    def __init__(self, writer: Writer) -> None:
        self.writer = writer

    def __enter__(self) -> None:
        self.writer.depth += 1

    def __exit__(self, *_: object) -> None:
        self.writer.depth -= 1


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


def int_text(value: int) -> str:
    return "INT32_MIN" if value == -(2**31) else str(value)


class Leaf:
    """One combination of cells."""

    def __init__(self, writer: Writer, cells: tuple[Cell, ...]) -> None:
        self.writer = writer
        self.compiled = writer.compiled
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
        strengths = list(self.strengths(order))
        defaults = [
            OutputWriter(self, index, output, order).write(strengths)
            for index, output in enumerate(self.compiled.outputs)
        ]
        self.writer.line(f"return {' | '.join(text for text in defaults if text) or '0'};")

    def strengths(self, order: Order) -> Iterator[tuple[IntegerRule, Affine]]:
        """Of the rules that can fire here."""
        for rule in self.compiled.rules:
            strength = self.rule_strength(rule, order)
            if not strength.is_zero:
                yield rule, strength

    def rule_strength(self, rule: IntegerRule, order: Order) -> Affine:
        values = []
        for index, fuzzy_set, negated in rule.conditions:
            direct = self.memberships.get((index, fuzzy_set), constant(0))
            values.append(direct.complement(self.one) if negated else direct)
        strength = (maximum if rule.is_or else minimum)(values, order, self.named)
        return self.weighted(strength, rule.weight_q19)

    def weighted(self, strength: Affine, weight_q19: int) -> Affine:
        if weight_q19 == WEIGHT_ONE or strength.is_zero:
            return strength
        if strength.is_constant:
            return constant((strength.offset * weight_q19 + WEIGHT_ONE // 2) // WEIGHT_ONE)
        return self.named(f"fuzzy_weighted({strength.text()}, {weight_q19}u)")

    def named(self, text: str) -> Affine:
        name = self.writer.fresh("s")
        self.writer.line(f"const uint32_t {name} = {text};")
        return Affine(0, {name: 1})


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


class OutputWriter:
    """One output in one leaf. write() returns the text of its bit in the result, "" for 0."""

    def __init__(self, leaf: Leaf, index: int, output: IntegerOutput, order: Order) -> None:
        self.leaf, self.index, self.output, self.order = leaf, index, output, order
        self.one, self.line = leaf.one, leaf.writer.line

    def write(self, strengths: Sequence[tuple[IntegerRule, Affine]]) -> str:
        fired = [
            (rule.conclusions[self.index], strength)
            for rule, strength in strengths
            if rule.conclusions[self.index] is not None
        ]
        if not fired:
            self.store(int_text(self.output.default))
            return f"{1 << self.index}u"
        if self.output.method == CENTROID:
            return CentroidWriter(self).write(self.by_term(fired))
        if self.output.method == WEIGHTED_MAX:
            fired = list(self.by_term(fired).items())
        return self.write_average([(strength, self.output.terms[term]) for term, strength in fired])

    def by_term(self, fired: Sequence[tuple[int, Affine]]) -> dict[int, Affine]:
        terms: dict[int, list[Affine]] = {}
        for term, strength in fired:
            terms.setdefault(term, []).append(strength)
        return {
            term: maximum(found, self.order, self.leaf.named)
            for term, found in sorted(terms.items())
        }

    def store(self, text: str) -> None:
        self.line(f"output[{self.index}] = {text};")

    def write_average(self, parts: Sequence[tuple[Affine, int]]) -> str:
        strength = sum_of([part for part, _ in parts])
        values = [value for _, value in parts]
        least = min(values)
        base = self.output.origin + least
        if max(values) == least:
            return self.write_guarded(strength, lambda: self.store(int_text(base)))
        weighted = sum_of([part * (value - least) for part, value in parts])
        high = self.highest(parts, least)
        return self.write_guarded(
            strength,
            lambda: self.store(
                with_base(base, self.quotient(weighted, strength, parts, high, least))
            ),
        )

    def highest(self, parts: Sequence[tuple[Affine, int]], least: int) -> int:
        """A bound of the weighted sum plus half the sum."""
        weighted = sum_of([part * (value - least) for part, value in parts])
        strength = sum_of([part for part, _ in parts])
        return self.order.upper_bound(weighted * 2 + strength) // 2 + 1

    def quotient(
        self,
        weighted: Affine,
        strength: Affine,
        parts: Sequence[tuple[Affine, int]],
        high: int,
        least: int,
    ) -> str:
        is_narrow = high < 1 << 32
        if strength.is_constant and strength.offset == self.one and is_narrow:
            bits = self.leaf.compiled.bits
            return f"(({(weighted + constant(self.one // 2)).text()}) >> {bits})"
        if is_narrow:
            name = self.leaf.writer.fresh("n")
            self.line(f"const uint32_t {name} = {strength.text()};")
            return f"({weighted.text()} + {name} / 2u) / {name}"
        wide = " + ".join(
            f"{part.wide_text()} * {value - least}u" for part, value in parts if value != least
        )
        return f"fuzzy_quotient({wide}, {strength.text()})"

    def write_guarded(self, strength: Affine, write: Callable[[], None]) -> str:
        """The default where no rule fires; strength: 0 there and only there."""
        if self.order.lower_bound(strength) > 0:
            write()
            return ""
        flag = self.leaf.writer.fresh("d")
        self.line(f"const uint32_t {flag} = {strength.text()} == 0 ? 1u : 0;")
        self.line(f"if ({flag} != 0) {{")
        with self.leaf.writer.indented():
            self.store(int_text(self.output.default))
        self.line("} else {")
        with self.leaf.writer.indented():
            write()
        self.line("}")
        return f"{flag} << {self.index}" if self.index else flag


def sum_of(parts: Sequence[Affine]) -> Affine:
    total = constant(0)
    for part in parts:
        total = total + part
    return total


def with_base(base: int, text: str) -> str:
    sign = "" if base == 0 else f"{int_text(base)} + "
    return f"{sign}(int32_t)({text})"


class CentroidWriter:
    def __init__(self, output: OutputWriter) -> None:
        self.output, self.leaf, self.order = output, output.leaf, output.order
        self.line = output.line
        self.bits = self.leaf.compiled.bits
        shapes = output.output.shapes
        assert shapes is not None
        self.shapes, self.peaks = shapes.shapes, shapes.peaks
        self.wide = "" if self.leaf.compiled.is_partition else "wide_"
        self.more = self.less = ""

    def write(self, by_term: dict[int, Affine]) -> str:
        filled = {rank: self.below_peak(rank, strength) for rank, strength in by_term.items()}
        total = sum_of(list(filled.values()))
        return self.output.write_guarded(total, lambda: self.write_sums(filled))

    def below_peak(self, rank: int, strength: Affine) -> Affine:
        peak = nearest(self.peaks[rank] * (1 << self.bits))
        if peak == 1 << self.bits:
            return strength
        return minimum([strength, constant(peak)], self.order, self.leaf.named)

    def write_sums(self, filled: dict[int, Affine]) -> None:
        self.more, self.less = (self.leaf.writer.fresh(name) for name in ("more", "less"))
        for name in (self.more, self.less):
            self.line(f"fuzzy_{self.wide}sums_t {name} = {{0, 0}};")
        for shape in self.shapes:
            if shape.first not in filled or shape.second not in filled:
                continue
            if shape.first == shape.second:
                self.add(shape, filled[shape.first], self.more, self.less)
            else:
                self.overlap(shape, filled)
        output = self.output.output
        text = f"fuzzy_{self.wide}centre({self.more}, {self.less}, {output.span}u)"
        self.output.store(with_base(output.origin, text))

    def overlap(self, shape: Shape, filled: dict[int, Affine]) -> None:
        upper = minimum([filled[shape.first], filled[shape.second]], self.order, self.leaf.named)
        inside = [filled[i] for i in range(shape.first + 1, shape.second) if i in filled]
        if not inside:
            self.add(shape, upper, self.less, self.more)
            return
        between = maximum(inside, self.order, self.leaf.named)
        is_hidden = self.order.is_less(upper, between)
        if is_hidden is None:
            self.line(f"if ({upper.text()} > {between.text()}) {{")
            with self.leaf.writer.indented():
                self.add_between(shape, upper, between)
            self.line("}")
        elif not is_hidden:
            self.add_between(shape, upper, between)

    def add_between(self, shape: Shape, upper: Affine, between: Affine) -> None:
        self.add(shape, upper, self.less, self.more)
        self.add(shape, between, self.more, self.less)

    def add(self, shape: Shape, beta: Affine, to: str, opposite: str) -> None:
        for layer in shape.layers:
            found = layer_integers(layer, self.bits)
            numbers = ", ".join(f"{number}u" for number in found.flanks)
            height = self.fill_text(beta, found)
            flanks = f"(fuzzy_flanks_t){{{numbers}}}"
            self.line(f"fuzzy_add_{self.wide}area(&{to}, {flanks}, {height});")
            if found.flanks[3]:
                side = opposite if found.is_skewed_left else to
                self.line(f"fuzzy_add_{self.wide}skew(&{side}, {flanks}, {height});")

    def fill_text(self, beta: Affine, layer: LayerIntegers) -> str:
        if layer.start == 0:
            filled = minimum([beta, constant(layer.height)], self.order, self.leaf.named).text()
        else:
            filled = f"fuzzy_fill_height({beta.text()}, {layer.start}u, {layer.height}u)"
        return (
            f"{layer.steep}u, {self.bits}u, {filled}"
            if self.wide
            else f"{filled} << {30 - self.bits}"
        )
