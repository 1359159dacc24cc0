"""C of one output in one leaf, and how far off it can be."""

from dataclasses import dataclass
from fractions import Fraction

from quiesce.rules.integers.c_writer import CWriter, int_text
from quiesce.rules.integers.cells import ceil, exact, floor, nearest
from quiesce.rules.integers.compile import INT32_LIMIT
from quiesce.rules.straight.compile import NotStraight
from quiesce.rules.straight.horner import (
    Form,
    centred_form,
    finest_bits,
    lifted_form,
    moved_form,
    plain_form,
)
from quiesce.rules.straight.leaf import Leaf, Sums
from quiesce.rules.straight.polynomial import Polynomial, constant
from quiesce.rules.system.model import WEIGHTED

HALF = Fraction(1, 2)
LEAST_STRENGTH = Fraction(1, 2**30)  # rules that fire by less may count as not firing
GOOD = Fraction(9, 8)  # counts
SPARE = 16  # units of a denominator that its rounding may need
SHORT_DENOMINATOR, SHORT_NUMERATOR = 1 << 21, 1 << 42  # of fuzzy_short_quotient()
FEW_BITS = 6  # of a count: with less, an output counts from a base of its leaf's


@dataclass(frozen=True)
class Answer:
    flag: str  # C of the output's bit in the result, "" for 0
    error: Fraction | None  # in counts; None: not bounded
    is_divided: bool


@dataclass(frozen=True)
class Quotient:
    """Of numerator and denominator, integers of as many bits; error: in counts, None where the
    denominator may be 0."""

    function: str  # "": C's own division, of a numerator that has half the denominator in it
    numerator: Form
    denominator: Form
    error: Fraction | None

    def text(self, denominator: str) -> str:
        if not self.function:
            return f"(uint32_t){self.numerator.text} / (uint32_t){denominator}"
        shift = self.denominator.bits - self.numerator.bits
        numerator = f"(uint64_t){self.numerator.text} << {shift}"
        return f"{self.function}({numerator}, (uint32_t){denominator})"


class OutputWriter:
    """doubt: how far a strength may be off because of a comparison's rounding."""

    def __init__(self, leaf: Leaf, writer: CWriter, index: int, doubt: Fraction) -> None:
        self.leaf, self.writer, self.index, self.doubt = leaf, writer, index, doubt
        compiled = leaf.compiled
        self.output, self.axis = compiled.system.outputs[index], compiled.output_axes[index]
        self.default = compiled.default_counts[index]

    def write(self) -> Answer:
        sums = self.leaf.sums(self.index)
        low = self.leaf.least(sums.strength)
        if self.leaf.range(sums.strength)[1] <= 0:
            self.store(int_text(self.default))
            return Answer(f"{1 << self.index}u", Fraction(0), False)
        value = self.value_without_division(sums)
        if value is not None:
            return self.write_polynomial(value, sums, low)
        return self.write_quotient(sums, low)

    def value_without_division(self, sums: Sums) -> Polynomial | None:
        """In counts from the output's origin."""
        if self.output.method == WEIGHTED:
            return sums.weighted + constant(self.axis.position(0.0))
        if sums.common is not None:
            return sums.common
        if sums.strength.is_constant:
            return sums.weighted * (1 / sums.strength.value)
        return None

    # ---- polynomials ----------------------------------------------------------------------------

    def write_polynomial(self, value: Polynomial, sums: Sums, low: Fraction) -> Answer:
        text, error = self.rounded(value)
        if self.output.method == WEIGHTED:
            error += sums.count * self.doubt * max(map(abs, sums.values))
        elif sums.common is None:
            error += self.doubt_of_average(sums, low)
        if low > LEAST_STRENGTH:
            self.store(self.clipped(text, self.leaf.range(value)))
            return Answer("", error, False)
        strength = self.denominator(sums.strength)
        ranges = self.leaf.range(value)
        flag = self.guarded(strength.text, strength, self.clipped(text, ranges))
        return Answer(flag, error, False)

    def rounded(self, value: Polynomial) -> tuple[str, Fraction]:
        """C of its nearest integer, and how far that is off at most."""
        low, high = self.leaf.range(value)
        if max(abs(low), abs(high)) > INT32_LIMIT - 2:
            raise NotStraight(f"output {self.output.name}: its values leave 32 bits")
        if value.is_constant:
            integer = nearest(value.value)
            return int_text(integer), abs(integer - value.value)
        base, bits = 0, self.bits_of(value + constant(HALF))
        if bits < FEW_BITS:
            base = floor((low + high) / 2)
            bits = self.bits_of(value + constant(HALF - base))
        form = centred_form(value + constant(HALF - base), self.leaf.variables, bits)
        text = f"({form.text} >> {bits})" if bits else form.text
        return with_base(base, text), HALF + form.error

    def bits_of(self, polynomial: Polynomial) -> int:
        bits = finest_bits(polynomial, self.leaf.variables)
        if bits is None or bits < 0:
            raise NotStraight(f"output {self.output.name}: its values leave 32 bits")
        return bits

    # ---- quotients ------------------------------------------------------------------------------

    def write_quotient(self, sums: Sums, low: Fraction) -> Answer:
        base = floor(sums.values[0])
        above = sums.weighted - sums.strength * base
        span = ceil(sums.values[1]) - base
        found = self.best_quotient(above, sums.strength, span, low)
        if found.error is None:
            name = self.writer.fresh("d")
            self.writer.line(f"const int32_t {name} = {found.denominator.text};")
            bounded = f"fuzzy_min({found.text(name)}, {span}u)"
            text = self.averaged(base, bounded, sums)
            return Answer(self.guarded(name, found.denominator, text), None, True)
        self.store(self.averaged(base, found.text(found.denominator.text), sums))
        return Answer("", found.error + self.doubt_of_average(sums, low), True)

    def averaged(self, base: int, text: str, sums: Sums) -> str:
        if max(map(abs, sums.values)) > INT32_LIMIT - 2:
            raise NotStraight(f"output {self.output.name}: its values leave 32 bits")
        return self.clipped(with_base(base, f"(int32_t)({text})"), sums.values)

    def best_quotient(
        self, above: Polynomial, strength: Polynomial, span: int, low: Fraction
    ) -> Quotient:
        """The first that is good, or the best."""
        found = []
        for make in (self.narrow, self.short) if low > LEAST_STRENGTH else ():
            quotient = make(above, strength, span, low)
            if quotient and quotient.error <= GOOD:
                return quotient
            found += [quotient] if quotient else []
        found.append(self.wide(above, strength, span, low))
        return min(found, key=lambda one: one.error or 0)

    def narrow(
        self, above: Polynomial, strength: Polynomial, span: int, low: Fraction
    ) -> Quotient | None:
        """One division of 32 bits. What the denominator's rounding does, up to the whole span of
        it, is met half way in the numerator, which has half the denominator to spare."""
        half = above + strength * HALF
        bits = min(self.bits_of(half), self.bits_of(strength))
        denominator = plain_form(strength, self.leaf.variables, bits)
        plain = plain_form(half, self.leaf.variables, bits)
        moves = [end * span for end in (Fraction(0), denominator.below, denominator.above)]
        below, above_most = plain.below - max(moves), plain.above - min(moves)
        by = -nearest((below + above_most) / 2)
        numerator = moved_form(half, self.leaf.variables, bits, by)
        least = low - denominator.error
        if least <= 0 or numerator.below + low * 2**bits / 2 < 0:
            return None
        off = max(abs(below + by), abs(above_most + by)) / Fraction(2) ** bits
        return Quotient("", numerator, denominator, (off + HALF * denominator.error) / least + HALF)

    def short(
        self, above: Polynomial, strength: Polynomial, span: int, low: Fraction
    ) -> Quotient | None:
        bits = self.bits_of(strength)
        most = self.leaf.range(strength)[1]
        while most * 2**bits > SHORT_DENOMINATOR - SPARE:
            bits -= 1
        if bits < 0:
            return None
        denominator = centred_form(strength, self.leaf.variables, bits)
        own = min(bits, self.bits_of(above))
        numerator = lifted_form(above, self.leaf.variables, own)
        if denominator.error * 2**bits > SPARE:
            return None
        if (numerator.most << (bits - own)) + SHORT_DENOMINATOR > SHORT_NUMERATOR:
            return None
        return self.quotient("fuzzy_short_quotient", numerator, denominator, span, low)

    def wide(self, above: Polynomial, strength: Polynomial, span: int, low: Fraction) -> Quotient:
        denominator = self.denominator(strength)
        own = min(denominator.bits, self.bits_of(above))
        numerator = lifted_form(above, self.leaf.variables, own)
        found = self.quotient("fuzzy_quotient", numerator, denominator, span, low)
        return found or Quotient("fuzzy_quotient", numerator, denominator, None)

    def denominator(self, strength: Polynomial) -> Form:
        bits = self.bits_of(strength)
        return centred_form(strength, self.leaf.variables, bits)

    def quotient(
        self, function: str, numerator: Form, denominator: Form, span: Fraction | int, low: Fraction
    ) -> Quotient | None:
        """None where the denominator may be 0."""
        least = low - denominator.error
        if low <= LEAST_STRENGTH or least <= 0:
            return None
        error = (numerator.error + span * denominator.error) / least + HALF
        return Quotient(function, numerator, denominator, error)

    def doubt_of_average(self, sums: Sums, low: Fraction) -> Fraction:
        if not self.doubt:
            return Fraction(0)
        return sums.count * self.doubt * (sums.values[1] - sums.values[0]) / low

    # ---- lines of C -----------------------------------------------------------------------------

    def store(self, text: str) -> None:
        self.writer.line(f"output[{self.index}] = {text};")

    def clipped(self, text: str, values: tuple[Fraction, Fraction]) -> str:
        ends = [exact(end) for end in (self.output.minimum, self.output.maximum)]
        least, most = ((end - self.axis.origin) / self.axis.lsb for end in ends)
        if not self.output.clips or (values[0] >= least and values[1] <= most):
            return text
        return f"clamp_i32({text}, {int_text(nearest(least))}, {int_text(nearest(most))})"

    def guarded(self, name: str, strength: Form, text: str) -> str:
        """The default where the strengths are no more than their rounding."""
        flag = self.writer.fresh("e")
        most = ceil(max(abs(strength.below), abs(strength.above)))
        self.writer.line(f"const uint32_t {flag} = {name} <= {most} ? 1u : 0;")
        self.writer.line(f"if ({flag} != 0) {{")
        with self.writer.indented():
            self.store(int_text(self.default))
        self.writer.line("} else {")
        with self.writer.indented():
            self.store(text)
        self.writer.line("}")
        return f"{flag} << {self.index}" if self.index else flag


def with_base(base: int, text: str) -> str:
    return text if base == 0 else f"{int_text(base)} + {text}"
