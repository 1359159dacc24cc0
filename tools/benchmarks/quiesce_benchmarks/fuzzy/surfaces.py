"""What surfaces of systems cost on the emulated Cortex-M4, and how near they are: the form in which
a running controller takes what plain tables cannot hold."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from quiesce.base.table import format_table
from quiesce.engine.bench import Bench
from quiesce.rules.surface.compile import compile_surface
from quiesce.rules.system.model import System

from quiesce_benchmarks.fuzzy.cost import measure_words
from quiesce_benchmarks.fuzzy.systems import GAUSSIAN, MAMDANI, SUGENO, systems
from quiesce_benchmarks.images import built_image

SHOWN = (GAUSSIAN, SUGENO, f"{MAMDANI}_100")
EVALUATIONS = 2000
COUNTS = 1 << 15  # of an input
OUTPUT_COUNTS = 1 << 16


@dataclass(frozen=True)
class SurfaceCost:
    """error_pct: of the output's range, as the command that makes it says."""

    name: str
    words: str
    rows: int
    columns: int
    error_pct: float
    worst_instr: int
    mean_instr: float
    table_bytes: int

    def row(self) -> dict[str, Any]:
        return asdict(self)


def measure_surfaces(bench: Bench) -> list[SurfaceCost]:
    """UsageError where the emulator or the image cannot be had."""
    known = systems()
    return [measure_surface(bench, name, *known[name]) for name in SHOWN]


def measure_surface(bench: Bench, name: str, words: str, system: System) -> SurfaceCost:
    first, second = ((one.maximum - one.minimum) / COUNTS for one in system.inputs)
    output = system.outputs[0]
    lsb = (output.maximum - output.minimum) / OUTPUT_COUNTS
    made = compile_surface(system, (first, second), lsb, is_for_controller=False)
    cost = measure_words(bench, built_image("fuzzy_cost"), COUNTS, made.words, EVALUATIONS)
    return SurfaceCost(
        name, words, *made.nodes, 100.0 * made.error, cost.worst_instr, cost.mean_instr,
        cost.table_bytes,
    )  # fmt: skip


def surface_table(costs: Sequence[SurfaceCost]) -> str:
    head = ["surface", "values", "error, % of range", "worst", "mean", "table, B"]
    rows = [
        [
            one.words, f"{one.rows} x {one.columns}", f"{one.error_pct:.3f}",
            f"{one.worst_instr:,}", f"{one.mean_instr:,.0f}", f"{one.table_bytes:,}",
        ]
        for one in costs
    ]  # fmt: skip
    return format_table(head, rows)
