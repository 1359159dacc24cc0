"""Straight-line C of a system: comparisons find the stretch of every input and, for minima, the
region; there an output is one polynomial, or the quotient of two. Every rounding is bounded, so
that the error of the whole is proved where no sum of strengths can fall to 0."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache

from quiesce.rules.integers.c_writer import INDENT, CWriter, int_text
from quiesce.rules.integers.emit import best_split
from quiesce.rules.straight.compile import NotStraight, StraightSystem
from quiesce.rules.straight.horner import ONE, Form, Variable, centred_form, finest_bits
from quiesce.rules.straight.leaf import Fact, Leaf, Pair
from quiesce.rules.straight.output import Answer, OutputWriter
from quiesce.rules.straight.polynomial import Polynomial, constant, total, variable
from quiesce.rules.straight.region import is_first_degree
from quiesce.rules.straight.stretches import Stretch

MAX_FACTS = 2  # comparisons of a leaf
STRENGTH_BITS = 28
MOVING_COST = 4  # instructions, roughly, of a stretch in which something moves


@dataclass
class Straight:
    """lines: behind the function's first one. errors: of each output, in its counts, proved; None
    where nothing is. divided: leaves with a division, of `leaves`."""

    errors: list[Fraction | None]
    lines: list[str] = field(default_factory=list)
    leaves: int = 0
    divided: int = 0

    def add(self, answers: Sequence[Answer]) -> None:
        self.leaves += 1
        self.divided += any(one.is_divided for one in answers)
        for index, one in enumerate(answers):
            known = self.errors[index]
            self.errors[index] = (
                None if known is None or one.error is None else max(known, one.error)
            )

    def text(self, name: str) -> str:
        """Definition of `uint32_t NAME(const int32_t *input, int32_t *output)`."""
        head = f"uint32_t {name}(const int32_t *input, int32_t *output) {{"
        return "\n".join([head, *self.lines, "}"]) + "\n"


@lru_cache(maxsize=4)
def straight_line(compiled: StraightSystem) -> Straight:
    """NotStraight where its values leave 32 bits."""
    made = Straight([Fraction(0)] * len(compiled.system.outputs))
    writer = CWriter(made.lines)
    with writer.indented():
        for index, one in enumerate(compiled.system.inputs):
            writer.line(f"const int32_t x{index} = input[{index}]; // {one.name}")
        Tree(compiled, writer, made).stretches(())
        writer.drop_unused(0)
        if not any(re.search(r"\binput\b", line) for line in writer.lines):
            writer.lines.insert(0, INDENT + "(void)input;")
    return made


class Tree:
    def __init__(self, compiled: StraightSystem, writer: CWriter, made: Straight) -> None:
        self.compiled, self.writer, self.made = compiled, writer, made

    def stretches(self, chosen: tuple[Stretch, ...]) -> None:
        index = len(chosen)
        if index < len(self.compiled.stretches):
            self.tree(index, self.compiled.stretches[index], chosen)
            return
        start = len(self.writer.lines)
        self.writer.names = 0  # a leaf is a scope of its own
        for one in chosen:
            self.writer.line(f"const int32_t {one.name} = {one.text};")
        LeafWriter(self.compiled, self.writer, self.made, chosen).write(())
        self.writer.drop_unused(start)

    def tree(self, index: int, parts: Sequence[Stretch], chosen: tuple[Stretch, ...]) -> None:
        if len(parts) == 1:
            self.stretches((*chosen, parts[0]))
            return
        split = best_split(tuple(stretch_cost(one) for one in parts))
        self.writer.branch(
            f"x{index} <= {int_text(parts[split - 1].last)}",
            lambda: self.tree(index, parts[:split], chosen),
            lambda: self.tree(index, parts[split:], chosen),
        )


def stretch_cost(one: Stretch) -> int:
    return 0 if all(mu.is_constant for mu in one.memberships) else MOVING_COST


class LeafWriter:
    def __init__(
        self,
        compiled: StraightSystem,
        writer: CWriter,
        made: Straight,
        stretches: tuple[Stretch, ...],
    ) -> None:
        self.compiled, self.writer, self.made, self.stretches = compiled, writer, made, stretches

    def leaf(self, facts: Sequence[Fact]) -> Leaf:
        return Leaf(self.compiled, self.stretches, facts, self.found_at_run_time)

    def write(self, facts: tuple[Fact, ...]) -> None:
        self.current = self.leaf(facts)
        open_pairs = self.undecided(facts)
        if open_pairs and len(open_pairs) + len(facts) <= MAX_FACTS:
            self.split(facts, open_pairs[0])
            return
        doubt = sum((fact.doubt for fact in facts), Fraction(0))
        answers = [
            OutputWriter(self.current, self.writer, index, doubt).write()
            for index in range(len(self.compiled.system.outputs))
        ]
        self.made.add(answers)
        flags = " | ".join(one.flag for one in answers if one.flag)
        self.writer.line(f"return {flags or '0'};")

    def undecided(self, facts: Sequence[Fact]) -> list[Pair]:
        """Pairs of strengths that straight lines would have to tell apart."""
        found: list[Pair] = []
        known: list[Fact] = []

        def note(values: Sequence[Polynomial], is_least: bool) -> Polynomial:
            one, other = values[0], values[1]
            probe = Leaf(self.compiled, self.stretches, known, note)
            if is_first_degree(one - other) and probe.is_no_more(one, other) is None:
                found.append((one, other))
                known.append(Fact(one - other, True, Fraction(1)))
            return leaf.least_of(values[1:], is_least) if len(values) > 2 else one

        leaf = Leaf(self.compiled, self.stretches, facts, note)
        for index in range(len(self.compiled.system.outputs)):
            leaf.fired(index)
        return found

    def split(self, facts: tuple[Fact, ...], pair: Pair) -> None:
        """By their values where that is cheaper than by their difference's sign."""
        difference = pair[0] - pair[1]
        forms = self.common(pair)
        (single,) = self.common([difference])
        if single.steps < sum(one.steps for one in forms):
            condition, doubt = f"{single.text} <= 0", single.error
        else:
            condition = f"{forms[0].text} <= {forms[1].text}"
            doubt = forms[0].error + forms[1].error
        self.writer.branch(
            condition,
            lambda: self.write((*facts, Fact(difference, True, doubt))),
            lambda: self.write((*facts, Fact(difference, False, doubt))),
        )

    # ---- strengths as C variables ---------------------------------------------------------------

    def bits_of(self, values: Sequence[Polynomial]) -> int:
        found = [finest_bits(one, self.current.variables, STRENGTH_BITS) for one in values]
        if None in found:
            raise NotStraight("strengths leave 32 bits")
        return min(bits for bits in found if bits is not None)

    def common(self, values: Sequence[Polynomial]) -> list[Form]:
        """In the same units."""
        bits = self.bits_of(values)
        return [centred_form(one, self.current.variables, bits) for one in values]

    def found_at_run_time(self, values: Sequence[Polynomial], is_least: bool) -> Polynomial:
        leaf, forms = self.current, self.common(values)
        bits = forms[0].bits
        function = "fuzzy_lesser" if is_least else "fuzzy_greater"
        text = forms[0].text
        for one in forms[1:]:
            text = f"{function}({text}, {one.text})"
        name = self.writer.fresh("s")
        self.writer.line(f"const int32_t {name} = {text};")
        error = max(max(abs(one.below), abs(one.above)) for one in forms)
        most = max(leaf.range(one)[1] for one in values)
        ends = -int(error) - 1, int(most * 2**bits) + int(error) + 1
        # The greatest of some is no less than their mean.
        mean = constant(0) if is_least else total(values) * Fraction(1, len(values))
        leaf.add_variable(name, Variable(*ends, error), mean * Fraction(2**bits, ONE))
        return variable(name) * Fraction(ONE, 2**bits)
