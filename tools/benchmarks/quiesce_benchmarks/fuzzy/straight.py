"""Straight-line C of systems that no plain base can hold, on the reference controller's sets and
rules: AND as a product, values that are straight lines over the inputs; what it costs on the
emulated Cortex-M4, and that it answers there what it answers here."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from quiesce.base.errors import BenchFailure
from quiesce.base.paths import root
from quiesce.base.table import format_table
from quiesce.engine.bench import Bench
from quiesce.rules.engine.function_engine import FunctionEngine
from quiesce.rules.formats.files import read_system
from quiesce.rules.straight.compile import StraightSystem, compile_straight
from quiesce.rules.system.model import BY_TERM, System
from quiesce.rules.system.norms import MAXIMUM, MINIMUM

from quiesce_benchmarks.fuzzy.cost import code_bytes
from quiesce_benchmarks.fuzzy.reference import FORMATS
from quiesce_benchmarks.images import built_image, count

# Of the files reference_product.fis and reference_sugeno.fis: as they are, with the greatest
# strength of a term's rules, with AND as the minimum.
PRODUCT, PRODUCT_MAX, SUGENO, SUGENO_MIN = "product", "product_max", "sugeno", "sugeno_min"
KINDS = (PRODUCT, PRODUCT_MAX, SUGENO, SUGENO_MIN)
WORDS = {
    PRODUCT: "product, each rule for itself",
    PRODUCT_MAX: "product, greatest strength of a term",
    SUGENO: "straight lines, product",
    SUGENO_MIN: "straight lines, minimum",
}
UINT32 = 1 << 32
INT32_ENDS = (-(2**31), 2**31 - 1)


@dataclass(frozen=True)
class StraightVariant:
    kind: str
    format: str

    @property
    def name(self) -> str:
        return f"straight_{self.kind}_{self.format}"

    @cached_property
    def compiled(self) -> StraightSystem:
        system = system_of(self.kind)
        inputs, output = FORMATS[self.format]
        forms = [inputs] * len(system.inputs) if isinstance(inputs, str) else list(inputs)
        return compile_straight(system, forms, [output])

    @property
    def universe(self) -> list[int]:
        made = self.compiled
        return [int(made.input_integer(i, v.maximum)) for i, v in enumerate(made.system.inputs)]

    @property
    def borders(self) -> list[list[int]]:
        """Of the stretches of each input, but for those that lie beside int32's ends."""
        return [[one.first for one in parts[1:]] for parts in self.compiled.stretches]


STRAIGHTS = tuple(StraightVariant(kind, form) for kind in KINDS for form in FORMATS)


def system_of(kind: str) -> System:
    file = "reference_sugeno" if kind in (SUGENO, SUGENO_MIN) else "reference_product"
    system = read_system(root() / f"tools/benchmarks/rules/{file}.fis")
    if kind == SUGENO_MIN:
        blocks = tuple(replace(one, conjunction=MINIMUM) for one in system.blocks)
        return replace(system, blocks=blocks)
    if kind == PRODUCT_MAX:
        outputs = [replace(one, method=BY_TERM, aggregation=MAXIMUM) for one in system.outputs]
        return replace(system, outputs=tuple(outputs))
    return system


@dataclass(frozen=True)
class StraightCost:
    kind: str
    format: str
    evaluations: int
    worst_instr: int
    median_instr: int
    mean_instr: float
    code_bytes: int
    stack_bytes: int

    def row(self) -> dict[str, Any]:
        return asdict(self)


def measure_straights(bench: Bench, steps: int) -> list[StraightCost]:
    """steps: of the grid, each axis. UsageError where the emulator or the image cannot be had."""
    image = built_image("straight_cost")
    return [measure_straight(bench, image, one, steps) for one in STRAIGHTS]


def measure_straight(
    bench: Bench, image: Path, variant: StraightVariant, steps: int
) -> StraightCost:
    borders = variant.borders
    number = STRAIGHTS.index(variant)
    order = (number, steps, *variant.universe, *map(len, borders), *chain(*borders))
    found = count(bench, image, *(word % UINT32 for word in order))
    printed = found["printed"]
    if printed["sum"] != sum_here(variant, steps):
        raise BenchFailure(f"{variant.name}: the target answers otherwise than this machine")
    return StraightCost(
        variant.kind, variant.format, printed["evaluations"], found["worst"], found["median"],
        found["mean"], code_bytes(image, [variant.name]), printed["stack_bytes"],
    )  # fmt: skip


def sum_here(variant: StraightVariant, steps: int) -> int:
    """As main_straight_cost.c has it, of the same inputs in the same order."""
    lists = [
        np.array([
            *(most * k // steps for k in range(steps + 1)),
            *(border + beside for border in borders for beside in (-1, 0, 1)),
            INT32_ENDS[0], -1, most + 1, INT32_ENDS[1],
        ])
        for most, borders in zip(variant.universe, variant.borders, strict=True)
    ]  # fmt: skip
    points = [values.ravel() for values in np.meshgrid(*lists, indexing="ij")]
    out, _ = FunctionEngine(variant.compiled).evaluate(points)
    factors = 2 * np.arange(out.shape[1], dtype=np.uint64) + 1
    return int((out[0].astype(np.uint64) * factors).sum() % UINT32)


def worst_of(costs: Sequence[StraightCost], kinds: Sequence[str]) -> int | None:
    """None where nothing was counted."""
    return max((one.worst_instr for one in costs if one.kind in kinds), default=None)


def straight_table(costs: Sequence[StraightCost]) -> str:
    head = [
        "straight-line C of systems",
        "evaluations",
        "worst",
        "median",
        "mean",
        "code, B",
        "stack, B",
    ]
    rows = [
        [
            f"{WORDS[one.kind]}, {one.format}", f"{one.evaluations:,}", f"{one.worst_instr:,}",
            f"{one.median_instr:,}", f"{one.mean_instr:,.1f}", f"{one.code_bytes:,}",
            f"{one.stack_bytes:,}",
        ]
        for one in costs
    ]  # fmt: skip
    return format_table(head, rows)
