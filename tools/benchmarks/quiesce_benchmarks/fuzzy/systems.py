"""What the engine for any fuzzy system costs on the emulated Cortex-M4: of systems that stand for
many, instructions at random inputs, bytes of code, table and stack."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from quiesce.base.paths import root
from quiesce.base.table import format_table
from quiesce.engine.bench import Bench
from quiesce.rules.engine.precise import compile_precisely
from quiesce.rules.formats.files import read_system
from quiesce.rules.system.compile import CompiledSystem
from quiesce.rules.system.model import System
from quiesce.rules.system.norms import ALGEBRAIC_PRODUCT

from quiesce_benchmarks.fuzzy.cost import code_bytes
from quiesce_benchmarks.fuzzy.foreign import gaussian_system
from quiesce_benchmarks.images import built_image, count

GAUSSIAN, SUGENO, MAMDANI = "gaussian_4x4", "sugeno_4x4", "mamdani"
PLACES = (100, 1000)
EVALUATIONS = 500
SOURCES = ("fuzzy_system", "fuzzy_curve", "fuzzy_defuzzify", "fuzzy_norms")


@dataclass(frozen=True)
class SystemCost:
    name: str
    words: str
    worst_instr: int
    mean_instr: float
    code_bytes: int  # of the engine, its check not among them
    table_bytes: int
    stack_bytes: int

    def row(self) -> dict[str, Any]:
        return asdict(self)


def mamdani(places: int) -> System:
    """The reference controller's sets and centroid, with AND and implication as the product."""
    system = read_system(root() / "tools/benchmarks/rules/reference_centroid.fcl")
    blocks = [
        replace(one, conjunction=ALGEBRAIC_PRODUCT, implication=ALGEBRAIC_PRODUCT)
        for one in system.blocks
    ]
    outputs = [replace(one, places=places) for one in system.outputs]
    return replace(system, blocks=tuple(blocks), outputs=tuple(outputs))


def systems() -> dict[str, tuple[str, System]]:
    """What is said of each, and it, by the name of its figure."""
    sugeno = read_system(root() / "tools/benchmarks/rules/reference_sugeno.fis")
    return {
        GAUSSIAN: ("4 x 4 Gaussian sets, product, constants", gaussian_system()),
        SUGENO: ("4 x 4 sets, product, straight lines", sugeno),
    } | {
        f"{MAMDANI}_{n}": (f"4 x 4 sets, product, centroid at {n} places", mamdani(n))
        for n in PLACES
    }


def figure_names() -> dict[str, str]:
    """By the name of the system."""
    names = (GAUSSIAN, SUGENO, *(f"{MAMDANI}_{n}" for n in PLACES))
    return {name: f"system_{name}_instr" for name in names}


def measure_systems(bench: Bench) -> list[SystemCost]:
    """UsageError where the emulator or the image cannot be had."""
    image = built_image("system_cost")
    found = []
    for name, (words, system) in systems().items():
        compiled = compile_precisely(system).compiled
        assert isinstance(compiled, CompiledSystem)
        found.append(measure_system(bench, image, name, words, compiled))
    return found


def measure_system(
    bench: Bench, image: Path, name: str, words: str, compiled: CompiledSystem
) -> SystemCost:
    table = compiled.words
    found = count(bench, image, EVALUATIONS, len(table), *table)
    return SystemCost(
        name, words, found["worst"], found["mean"], code_bytes(image, SOURCES), 4 * len(table),
        found["printed"]["stack_bytes"],
    )  # fmt: skip


def worst_of_system(costs: Sequence[SystemCost], name: str) -> int | None:
    """None where it was not counted."""
    return next((one.worst_instr for one in costs if one.name == name), None)


def system_table(costs: Sequence[SystemCost]) -> str:
    head = ["engine for any system", "worst", "mean", "code, B", "table, B", "stack, B"]
    rows = [
        [
            one.words, f"{one.worst_instr:,}", f"{one.mean_instr:,.0f}", f"{one.code_bytes:,}",
            f"{one.table_bytes:,}", f"{one.stack_bytes:,}",
        ]
        for one in costs
    ]  # fmt: skip
    return format_table(head, rows)
