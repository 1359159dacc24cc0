"""Straight-line C of one output where the cells of all inputs are known."""

from collections.abc import Callable, Sequence

from quiesce.rules.affine import Affine, Order, constant, maximum, minimum
from quiesce.rules.c_writer import CWriter, int_text
from quiesce.rules.compile import CompiledBase, IntegerRule
from quiesce.rules.integer_cells import nearest
from quiesce.rules.model import CENTROID, WEIGHTED_MAX
from quiesce.rules.output_shapes import LayerIntegers, Shape, layer_integers


class OutputWriter:
    """One output in one leaf. write() returns the text of its bit in the result, "" for 0."""

    def __init__(self, compiled: CompiledBase, writer: CWriter, index: int, order: Order) -> None:
        self.compiled, self.writer, self.index, self.order = compiled, writer, index, order
        self.output = compiled.outputs[index]
        self.one = 1 << compiled.bits

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
            term: maximum(found, self.order, self.writer.named)
            for term, found in sorted(terms.items())
        }

    def store(self, text: str) -> None:
        self.writer.line(f"output[{self.index}] = {text};")

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
            bits = self.compiled.bits
            return f"(({(weighted + constant(self.one // 2)).text()}) >> {bits})"
        if is_narrow:
            name = self.writer.fresh("n")
            self.writer.line(f"const uint32_t {name} = {strength.text()};")
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
        flag = self.writer.fresh("d")
        self.writer.line(f"const uint32_t {flag} = {strength.text()} == 0 ? 1u : 0;")
        self.writer.line(f"if ({flag} != 0) {{")
        with self.writer.indented():
            self.store(int_text(self.output.default))
        self.writer.line("} else {")
        with self.writer.indented():
            write()
        self.writer.line("}")
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
        self.output, self.order = output, output.order
        self.compiled, self.writer = output.compiled, output.writer
        self.bits = self.compiled.bits
        shapes = output.output.shapes
        assert shapes is not None
        self.shapes, self.peaks = shapes.shapes, shapes.peaks
        self.wide = "" if self.compiled.is_partition else "wide_"
        self.more = self.less = ""

    def write(self, by_term: dict[int, Affine]) -> str:
        filled = {rank: self.below_peak(rank, strength) for rank, strength in by_term.items()}
        total = sum_of(list(filled.values()))
        return self.output.write_guarded(total, lambda: self.write_sums(filled))

    def below_peak(self, rank: int, strength: Affine) -> Affine:
        peak = nearest(self.peaks[rank] * (1 << self.bits))
        if peak == 1 << self.bits:
            return strength
        return minimum([strength, constant(peak)], self.order, self.writer.named)

    def write_sums(self, filled: dict[int, Affine]) -> None:
        self.more, self.less = (self.writer.fresh(name) for name in ("more", "less"))
        for name in (self.more, self.less):
            self.writer.line(f"fuzzy_{self.wide}sums_t {name} = {{0, 0}};")
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
        upper = minimum([filled[shape.first], filled[shape.second]], self.order, self.writer.named)
        inside = [filled[i] for i in range(shape.first + 1, shape.second) if i in filled]
        if not inside:
            self.add(shape, upper, self.less, self.more)
            return
        between = maximum(inside, self.order, self.writer.named)
        is_hidden = self.order.is_less(upper, between)
        if is_hidden is None:
            self.writer.line(f"if ({upper.text()} > {between.text()}) {{")
            with self.writer.indented():
                self.add_between(shape, upper, between)
            self.writer.line("}")
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
            self.writer.line(f"fuzzy_add_{self.wide}area(&{to}, {flanks}, {height});")
            if found.flanks[3]:
                side = opposite if found.is_skewed_left else to
                self.writer.line(f"fuzzy_add_{self.wide}skew(&{side}, {flanks}, {height});")

    def fill_text(self, beta: Affine, layer: LayerIntegers) -> str:
        if layer.start == 0:
            filled = minimum([beta, constant(layer.height)], self.order, self.writer.named).text()
        else:
            filled = f"fuzzy_fill_height({beta.text()}, {layer.start}u, {layer.height}u)"
        return (
            f"{layer.steep}u, {self.bits}u, {filled}"
            if self.wide
            else f"{filled} << {30 - self.bits}"
        )
