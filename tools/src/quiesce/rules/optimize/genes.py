"""A rule base as a row of integers, for searches: which term each rule names, where sets lie.

A genome is a tuple of integers, gene i in 0 .. levels[i] - 1:

- a rule's conclusion: the index of the term;
- a breakpoint of an input's sets, or an output's singleton: code / (levels - 1) of the way. Those
  of one variable are sorted and kept apart, so every genome is a valid rule base in which
  neighbouring sets add up to 1 as they did before.

All searches work on genomes, so what was evaluated is known again whichever way it was reached.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from quiesce.base.errors import UsageError
from quiesce.rules.model import FuzzySet, Input, Output, RuleBase, Singleton

Genome = tuple[int, ...]

RULES, SETS, OUTPUTS = "rules", "sets", "outputs"
TUNABLE = (RULES, SETS, OUTPUTS)
POSITION_BITS = 10
# Neighbouring breakpoints stay this share of the universe apart.
GAP_SHARE = 1 / 64
NEAR = 1e-9


class Block(Protocol):
    """Genes that belong together."""

    @property
    def levels(self) -> Sequence[int]: ...

    def canonical(self, genes: Genome) -> Genome:
        """The one of all genes with this meaning that stands for them."""
        ...

    def encode(self, base: RuleBase) -> Genome: ...

    def decode(self, base: RuleBase, genes: Genome) -> RuleBase: ...


@dataclass(frozen=True)
class RuleBlock:
    """A gene for every conclusion of every rule."""

    levels: tuple[int, ...]
    places: tuple[tuple[int, int], ...]  # rule, output

    def canonical(self, genes: Genome) -> Genome:
        return genes

    def encode(self, base: RuleBase) -> Genome:
        terms = (base.rules[rule].conclusions[output] for rule, output in self.places)
        return tuple(term for term in terms if term is not None)

    def decode(self, base: RuleBase, genes: Genome) -> RuleBase:
        conclusions = [list(rule.conclusions) for rule in base.rules]
        for (rule, output), gene in zip(self.places, genes, strict=True):
            conclusions[rule][output] = gene
        pairs = zip(base.rules, conclusions, strict=True)
        return replace(base, rules=tuple(replace(r, conclusions=tuple(c)) for r, c in pairs))


@dataclass(frozen=True)
class Axis:
    """Ascending positions in a universe, at least `gap` apart, as integer codes."""

    low: float
    high: float
    count: int
    gap: float

    @property
    def levels(self) -> tuple[int, ...]:
        return (1 << POSITION_BITS,) * self.count

    @property
    def digits(self) -> int:
        """Decimals that a reader of the rule file needs: 1e-5 .. 1e-6 of the universe."""
        return 5 - math.floor(math.log10(self.high - self.low))

    @property
    def room(self) -> float:
        """What is left of the universe when every gap is taken."""
        return (self.high - self.low) - self.gap * (self.count - 1)

    def encode(self, positions: Sequence[float]) -> Genome:
        top = (1 << POSITION_BITS) - 1
        shares = ((x - self.low - i * self.gap) / self.room for i, x in enumerate(positions))
        return tuple(round(min(max(share, 0.0), 1.0) * top) for share in shares)

    def decode(self, genes: Genome) -> list[float]:
        top = (1 << POSITION_BITS) - 1
        shares = (gene / top for gene in sorted(genes))
        exact = (self.low + i * self.gap + self.room * share for i, share in enumerate(shares))
        return [round(x, self.digits) for x in exact]


@dataclass(frozen=True)
class SetBlock:
    """The breakpoints of one input: the ends of every set's core, ascending."""

    input: int
    axis: Axis

    @property
    def levels(self) -> tuple[int, ...]:
        return self.axis.levels

    def canonical(self, genes: Genome) -> Genome:
        return tuple(sorted(genes))

    def encode(self, base: RuleBase) -> Genome:
        return self.axis.encode(breakpoints(base.inputs[self.input]))

    def decode(self, base: RuleBase, genes: Genome) -> RuleBase:
        inputs = list(base.inputs)
        inputs[self.input] = with_breakpoints(inputs[self.input], self.axis.decode(genes))
        return replace(base, inputs=tuple(inputs))


@dataclass(frozen=True)
class SingletonBlock:
    """The values of one output's singletons, ascending."""

    output: int
    axis: Axis

    @property
    def levels(self) -> tuple[int, ...]:
        return self.axis.levels

    def canonical(self, genes: Genome) -> Genome:
        return tuple(sorted(genes))

    def encode(self, base: RuleBase) -> Genome:
        return self.axis.encode(sorted(singletons(base.outputs[self.output])))

    def decode(self, base: RuleBase, genes: Genome) -> RuleBase:
        outputs = list(base.outputs)
        before = outputs[self.output]
        order = sorted(range(len(before.terms)), key=singletons(before).__getitem__)
        terms = [Singleton(term.name, 0.0) for term in before.terms]
        for index, value in zip(order, self.axis.decode(genes), strict=True):
            terms[index] = Singleton(before.terms[index].name, value)
        outputs[self.output] = replace(before, terms=tuple(terms))
        return replace(base, outputs=tuple(outputs))


@dataclass(frozen=True)
class Space:
    """All genomes that a search may visit from one rule base."""

    start: RuleBase
    blocks: tuple[Block, ...]

    @property
    def levels(self) -> tuple[int, ...]:
        return tuple(level for block in self.blocks for level in block.levels)

    def encode(self, base: RuleBase) -> Genome:
        """The genome nearest to a base that differs from `start` in tuned places only."""
        return tuple(gene for block in self.blocks for gene in block.encode(base))

    def decode(self, genome: Genome) -> RuleBase:
        base = self.start
        for block, genes in self._parts(genome):
            base = block.decode(base, genes)
        return base

    def canonical(self, genome: Genome) -> Genome:
        """Equal for genomes that decode to the same rule base."""
        parts = self._parts(genome)
        return tuple(gene for block, genes in parts for gene in block.canonical(genes))

    def _parts(self, genome: Genome) -> Iterable[tuple[Block, Genome]]:
        first = 0
        for block in self.blocks:
            end = first + len(block.levels)
            yield block, genome[first:end]
            first = end


def singletons(output: Output) -> list[float]:
    return [term.value for term in output.terms if isinstance(term, Singleton)]


def core(one: FuzzySet) -> tuple[float, float] | None:
    """Where membership is 1; None where it is not one interval of a trapezoid."""
    ones = [x for x, mu in one.points if mu == 1.0]
    others = [mu for _, mu in one.points if mu not in (0.0, 1.0)]
    return (ones[0], ones[-1]) if ones and not others else None


def breakpoints(variable: Input) -> list[float]:
    """Ends of the cores of an input's sets, from left to right, equal ones once.

    Outer ends of the outermost sets are not among them. UsageError where the sets are no chain of
    trapezoids that add up to 1.
    """
    cores = [core(one) for one in variable.sets]
    if len(cores) > 1 and all(cores):
        ends = [c for c in cores if c is not None]
        points = [ends[0][1]]
        for low, high in ends[1:-1]:
            points += [low] if low == high else [low, high]
        points.append(ends[-1][0])
        rising = all(a < b for a, b in zip(points, points[1:], strict=False))
        if rising and with_shape(variable, with_breakpoints(variable, points)):
            return points
    raise UsageError(
        f"the sets of {variable.name} do not add up to 1 from left to right, each overlapping its "
        "neighbours only; their positions cannot be tuned (--tune rules leaves them as they are)"
    )


def with_shape(one: Input, other: Input) -> bool:
    """Whether two inputs' sets have the same memberships wherever one of them bends."""
    xs = {x for variable in (one, other) for s in variable.sets for x, _ in s.points}
    xs = {min(max(x, one.minimum), one.maximum) for x in xs}
    pairs = list(zip(one.sets, other.sets, strict=True))
    return all(abs(a.membership(x) - b.membership(x)) < NEAR for a, b in pairs for x in xs)


def with_breakpoints(variable: Input, points: Sequence[float]) -> Input:
    """The same sets with other breakpoints: a set that had a flat top keeps one."""
    sets, at, last = [], 0, len(variable.sets) - 1
    for i, one in enumerate(variable.sets):
        ends = core(one) or (0.0, 0.0)
        flat = 0 < i < last and ends[0] != ends[1]
        top = points[at : at + (2 if flat else 1)]
        left = [(points[at - 1], 0.0)] if i > 0 else []
        right = [(points[at + len(top)], 0.0)] if i < last else []
        sets.append(FuzzySet(one.name, (*left, *((x, 1.0) for x in top), *right)))
        at += len(top)
    return replace(variable, sets=tuple(sets))


def rule_block(base: RuleBase) -> RuleBlock:
    places = [
        (r, o)
        for r, rule in enumerate(base.rules)
        for o, term in enumerate(rule.conclusions)
        if term is not None
    ]
    return RuleBlock(tuple(len(base.outputs[o].terms) for _, o in places), tuple(places))


def axis(low: float, high: float, count: int) -> Axis:
    return Axis(low, high, count, min(GAP_SHARE, 0.5 / count) * (high - low))


def set_blocks(base: RuleBase) -> Iterable[Block]:
    for i, variable in enumerate(base.inputs):
        if len(variable.sets) > 1:
            count = len(breakpoints(variable))
            yield SetBlock(i, axis(variable.minimum, variable.maximum, count))


def singleton_blocks(base: RuleBase) -> Iterable[Block]:
    for o, output in enumerate(base.outputs):
        if len(singletons(output)) != len(output.terms):
            raise UsageError(
                f"the terms of {output.name} are sets; --tune outputs needs singletons"
            )
        yield SingletonBlock(o, axis(output.minimum, output.maximum, len(output.terms)))


def make_space(base: RuleBase, tune: Sequence[str]) -> Space:
    """UsageError where something that is to be tuned has no genes in this base."""
    blocks: list[Block] = []
    if RULES in tune:
        blocks.append(rule_block(base))
    if SETS in tune:
        blocks += set_blocks(base)
    if OUTPUTS in tune:
        blocks += singleton_blocks(base)
    space = Space(base, tuple(blocks))
    if not space.levels:
        raise UsageError(f"{base.name} has nothing to tune")
    return space
