"""Straight-line C of one output where the cells of all inputs are known."""

from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

from quiesce.rules.integers.affine import Affine, Order, constant, maximum, minimum
from quiesce.rules.integers.c_writer import CWriter, int_text
from quiesce.rules.integers.cells import nearest
from quiesce.rules.integers.compiled import CompiledBase, IntegerRule
from quiesce.rules.integers.output_shapes import LayerIntegers, Shape, layer_integers
from quiesce.rules.model import CENTROID, WEIGHTED_MAX

Part = TypeVar("Part")
Fired = tuple[int, IntegerRule, Affine]  # term, rule, its membership


class OutputWriter:
    """One output in one leaf. write() returns the text of its bit in the result, "" for 0."""

    def __init__(self, compiled: CompiledBase, writer: CWriter, index: int, order: Order) -> None:
        self.compiled, self.writer, self.index, self.order = compiled, writer, index, order
        self.output = compiled.outputs[index]
        self.one = 1 << compiled.bits

    def write(self, rules: Sequence[tuple[IntegerRule, Affine]]) -> str:
        fired = [
            (term, rule, membership)
            for rule, membership in rules
            if (term := rule.conclusions[self.index]) is not None
        ]
        if not fired:
            self.store(int_text(self.output.default))
            return f"{1 << self.index}u"
        if self.output.method == CENTROID:
            return CentroidWriter(self).write(fired)
        bound = sum(self.order.upper_bound(membership) for _, _, membership in fired)
        if bound < 1 << 32 and all(rule.is_full for _, rule, _ in fired):
            return self.write_plain(fired)
        return WideAverageWriter(self).write(fired)

    def whole(self, value: int) -> int:
        """A singleton without its fraction of a count."""
        return value >> self.output.fraction << self.output.fraction

    def based(self, least: int) -> int:
        return self.output.origin + (least >> self.output.fraction)

    def store(self, text: str) -> None:
        self.writer.line(f"output[{self.index}] = {text};")

    def write_plain(self, fired: Sequence[Fired]) -> str:
        """Without weights the memberships are strengths, in 32 bits."""
        parts = [(membership, self.output.terms[term]) for term, _, membership in fired]
        if self.output.method == WEIGHTED_MAX:
            parts = [
                (maximum(found, self.order, self.writer.named), self.output.terms[term])
                for term, found in by_term((term, m) for term, _, m in fired).items()
            ]
        strength = sum_of([part for part, _ in parts])
        least = self.whole(min(value for _, value in parts))
        weighted = sum_of([part * (value - least) for part, value in parts])
        base = self.based(least)
        is_default = "" if self.order.lower_bound(strength) > 0 else f"{strength.text()} == 0"
        if weighted.is_zero:
            return self.guarded(is_default, lambda: self.store(int_text(base)))
        return self.guarded(
            is_default,
            lambda: self.store(with_base(base, self.quotient(weighted, strength, parts, least))),
        )

    def quotient(
        self, weighted: Affine, strength: Affine, parts: Sequence[tuple[Affine, int]], least: int
    ) -> str:
        scaled = strength * (1 << self.output.fraction)
        high = self.order.upper_bound(weighted * 2 + scaled) // 2 + 1
        if high < 1 << 32 and scaled == constant(self.one):
            rounded = (weighted + constant(self.one // 2)).text()
            return f"({rounded} >> {self.compiled.bits})"
        if high < 1 << 32:
            name = self.writer.fresh("n")
            self.writer.line(f"const uint32_t {name} = {scaled.text()};")
            return f"({weighted.text()} + {name} / 2u) / {name}"
        is_short = high < 1 << 43 and self.order.upper_bound(scaled) <= 1 << 21
        wide = " + ".join(
            f"{part.wide_text()} * {value - least}u" for part, value in parts if value != least
        )
        if is_short:
            return f"fuzzy_short_quotient({wide}, {scaled.text()})"
        denominator = f"{strength.wide_text()} << {self.output.fraction}"
        return f"fuzzy_quotient({wide}, {denominator})"

    def guarded(self, is_default: str, write: Callable[[], None]) -> str:
        """is_default: condition for the default, "" for never."""
        if not is_default:
            write()
            return ""
        flag = self.writer.fresh("d")
        self.writer.line(f"const uint32_t {flag} = {is_default} ? 1u : 0;")
        self.writer.line(f"if ({flag} != 0) {{")
        with self.writer.indented():
            self.store(int_text(self.output.default))
        self.writer.line("} else {")
        with self.writer.indented():
            write()
        self.writer.line("}")
        return f"{flag} << {self.index}" if self.index else flag


class WideAverageWriter:
    """A weighted average of strengths in 64 bits, as the table engine has it for any base."""

    def __init__(self, output: OutputWriter) -> None:
        self.output, self.writer = output, output.writer
        self.shift = output.compiled.strength_shift

    def write(self, fired: Sequence[Fired]) -> str:
        parts = [(term, self.named(self.strength_text(rule, m))) for term, rule, m in fired]
        if self.output.output.method == WEIGHTED_MAX:
            parts = [(term, self.greatest(names)) for term, names in by_term(parts).items()]
        terms = self.output.output.terms
        least = self.output.whole(min(terms[term] for term, _ in parts))
        total = self.named(" + ".join(name for _, name in parts))
        weighted = " + ".join(
            f"{name} * {terms[term] - least}u" for term, name in parts if terms[term] != least
        )
        base = self.output.based(least)
        text = (
            with_base(base, f"fuzzy_quotient({weighted}, {total} << {self.output.output.fraction})")
            if weighted
            else int_text(base)
        )
        is_default = "" if self.always_fires(fired) else f"{total} == 0"
        return self.output.guarded(is_default, lambda: self.output.store(text))

    def strength_text(self, rule: IntegerRule, membership: Affine) -> str:
        shift = self.shift + rule.exponent
        return f"fuzzy_strength({membership.text()}, {rule.weight_q19}u, {shift}u)"

    def always_fires(self, fired: Sequence[Fired]) -> bool:
        return any(
            self.output.order.lower_bound(membership) * rule.weight_q19
            >> (self.shift + rule.exponent)
            > 0
            for _, rule, membership in fired
        )

    def greatest(self, names: Sequence[str]) -> str:
        result = names[0]
        for name in names[1:]:
            result = self.named(f"fuzzy_max_u64({result}, {name})")
        return result

    def named(self, text: str) -> str:
        name = self.writer.fresh("w")
        self.writer.line(f"const uint64_t {name} = {text};")
        return name


def by_term(parts: Iterable[tuple[int, Part]]) -> dict[int, list[Part]]:
    found: dict[int, list[Part]] = {}
    for term, part in parts:
        found.setdefault(term, []).append(part)
    return dict(sorted(found.items()))


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

    def write(self, fired: Sequence[Fired]) -> str:
        strengths = by_term((term, membership) for term, _, membership in fired)
        filled = {
            rank: self.below_peak(rank, maximum(found, self.order, self.writer.named))
            for rank, found in strengths.items()
        }
        total = sum_of(list(filled.values()))
        is_default = ""
        if self.order.lower_bound(total) <= 0:
            is_default = " && ".join(f"{strength.text()} == 0" for strength in filled.values())
        return self.output.guarded(is_default, lambda: self.write_sums(filled))

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
