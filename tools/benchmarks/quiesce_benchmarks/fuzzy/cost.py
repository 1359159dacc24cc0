"""Instructions of the fuzzy engines on the emulated Cortex-M4, beside libfuzzylite's.

Exact counts, no cycles: every evaluation is bracketed in its image
(tools/benchmarks/mps2/main_fuzzy_cost.c, tools/benchmarks/mps2/fuzzylite) and counted by the
emulator's plugin. The engines' inputs are a dense grid, every border of a cell and values beyond
the universe; the peer's are spread evenly, at random.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.engine.bench import Bench, require_emulator
from quiesce.rules.engine.engine import STRAIGHT, TABLE
from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.integers.table import table_words

from quiesce_benchmarks.fuzzy.reference import FORMATS, VARIANTS, Variant, compiled
from quiesce_benchmarks.images import built_image, count
from quiesce_benchmarks.link_map import read_sections

PEER_EVALUATIONS = 1000
PEER_SEED = 12345
RESOLUTIONS = (0, 100, 200)  # 0: the singletons


@dataclass(frozen=True)
class EngineCost:
    variant: Variant
    kind: str  # "table" or "straight"
    evaluations: int
    worst_instr: int
    median_instr: int
    mean_instr: float
    code_bytes: int  # of the straight-line function, or of the whole table engine
    table_bytes: int  # 0 for straight-line code
    stack_bytes: int

    def row(self) -> dict[str, Any]:
        return {**asdict(self), "variant": self.variant.name}


@dataclass(frozen=True)
class PeerCost:
    resolution: int  # samples of the centroid; 0: weighted average of singletons
    evaluations: int
    worst_instr: int
    median_instr: int
    mean_instr: float
    code_bytes: int  # of the whole image
    stack_bytes: int


@dataclass(frozen=True)
class TableCost:
    """The table engine on a base that has no straight-line form."""

    worst_instr: int
    mean_instr: float
    table_bytes: int
    stack_bytes: int


def measure_engines(bench: Bench, steps: int) -> list[EngineCost]:
    """steps: of the grid, each axis. UsageError where the emulator or the image cannot be had."""
    require_emulator()
    image = built_image("fuzzy_cost")
    kinds = (TABLE, STRAIGHT)
    return [measure_engine(bench, image, variant, k, steps) for variant in VARIANTS for k in kinds]


def universe_of(variant: Variant) -> list[int]:
    """Largest integer of each input inside the universe."""
    made = compiled(variant)
    return [int(made.input_integer(i, v.maximum)) for i, v in enumerate(made.base.inputs)]


def measure_engine(
    bench: Bench, image: Path, variant: Variant, kind: str, steps: int
) -> EngineCost:
    is_straight = kind == STRAIGHT
    number = VARIANTS.index(variant)
    found = count(bench, image, number, int(is_straight), steps, *universe_of(variant))
    printed = found["printed"]
    if printed["differing"] or printed["defaults"]:
        raise BenchFailure(f"{variant.name}: the engines differ at {printed['differing']} points")
    return EngineCost(
        variant=variant,
        kind=kind,
        evaluations=printed["evaluations"],
        worst_instr=found["worst"],
        median_instr=found["median"],
        mean_instr=found["mean"],
        code_bytes=code_bytes(image, [variant.name] if is_straight else ["fuzzy"]),
        table_bytes=0 if is_straight else printed["table_bytes"],
        stack_bytes=printed["stack_bytes"],
    )


def code_bytes(image: Path, sources: Sequence[str] = ()) -> int:
    """Of these source files in the image; of all where none is named."""
    sections = read_sections(image.with_name(f"{image.name}.map"))
    return sum(one.end - one.begin for one in sections if not sources or one.source in sources)


def measure_table(bench: Bench, image: Path, base: CompiledBase, evaluations: int) -> TableCost:
    """Any base whose inputs are q15."""
    universe = int(base.input_integer(0, base.base.inputs[0].maximum))
    return measure_words(bench, image, universe, table_words(base), evaluations)


def measure_words(
    bench: Bench, image: Path, universe: int, words: Sequence[int], evaluations: int
) -> TableCost:
    """universe: the last integer of each input."""
    order = (len(VARIANTS), 0, evaluations, universe, universe, len(words), *words)
    found = count(bench, image, *order)
    printed = found["printed"]
    return TableCost(found["worst"], found["mean"], printed["table_bytes"], printed["stack_bytes"])


def measure_peers(bench: Bench) -> list[PeerCost]:
    """UsageError where libfuzzylite or the emulator cannot be had."""
    require_emulator()
    image = built_image("fuzzylite_cost")
    return [measure_peer(bench, image, resolution) for resolution in RESOLUTIONS]


def measure_peer(bench: Bench, image: Path, resolution: int) -> PeerCost:
    found = count(bench, image, PEER_EVALUATIONS, resolution, PEER_SEED)
    return PeerCost(
        resolution=resolution,
        evaluations=found["passes"],
        worst_instr=found["worst"],
        median_instr=found["median"],
        mean_instr=found["mean"],
        code_bytes=code_bytes(image),
        stack_bytes=found["printed"]["stack_bytes"],
    )


def worst_instr(
    costs: Sequence[EngineCost], kind: str, methods: Sequence[str], forms: Sequence[str] = ()
) -> int | None:
    """Largest of these; None where nothing was counted."""
    found = [
        cost.worst_instr
        for cost in costs
        if cost.kind == kind
        and cost.variant.method in methods
        and cost.variant.format in (forms or FORMATS)
    ]
    return max(found, default=None)
