"""`./tools/benchmark fuzzy`: the fuzzy engines against their peers, accuracy and instructions."""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.engine.bench import Bench
from quiesce.rules.engine.engine import STRAIGHT, TABLE

from quiesce_benchmarks.fuzzy.callgrind import HostCount, measure_host
from quiesce_benchmarks.fuzzy.cost import (
    RESOLUTIONS,
    EngineCost,
    PeerCost,
    TableCost,
    measure_engines,
    measure_peers,
    measure_table,
    worst_instr,
)
from quiesce_benchmarks.fuzzy.foreign import (
    Tried,
    compiled_pct,
    foreign_table,
    gaussian_bytes,
    measure_foreign,
    rows,
    worst_error_pct,
)
from quiesce_benchmarks.fuzzy.grid import LIBFUZZYLITE, GridResult, measure_grid
from quiesce_benchmarks.fuzzy.plots import plot_cost, plot_errors
from quiesce_benchmarks.fuzzy.reference import CENTROID, PHYSICAL, Q15, SINGLETON_METHODS
from quiesce_benchmarks.fuzzy.straight import (
    PRODUCT,
    PRODUCT_MAX,
    SUGENO,
    SUGENO_MIN,
    StraightCost,
    measure_straights,
    straight_table,
    worst_of,
)
from quiesce_benchmarks.fuzzy.suite import Budget, RandomResult, measure_random
from quiesce_benchmarks.fuzzy.surfaces import SurfaceCost, measure_surfaces, surface_table
from quiesce_benchmarks.fuzzy.systems import (
    SystemCost,
    figure_names,
    measure_systems,
    system_table,
    worst_of_system,
)
from quiesce_benchmarks.fuzzy.tables import (
    beyond_lines,
    engine_table,
    fallback_table,
    grid_table,
    host_table,
    peer_table,
    random_table,
)
from quiesce_benchmarks.fuzzy.type2 import Type2Result, measure_type2
from quiesce_benchmarks.images import built_image
from quiesce_benchmarks.report import Figure, Report
from quiesce_benchmarks.seeds import seed_number

NAME = "fuzzy"
HELP = "the fuzzy engines: accuracy, instructions, random rule bases, beside their peers"
DESCRIPTION = """Measure the fuzzy engines, table and straight-line C, on a reference controller and
on random rule bases: against an exact reference and against libfuzzylite, pyfuzzylite and
scikit-fuzzy on the same work, type-2 rules against PyIT2FLS; and the instructions of an evaluation
on the emulated Cortex-M4 beside libfuzzylite's. The peers are fetched when first wanted."""

FALLBACK_EVALUATIONS = 2000


@dataclass(frozen=True)
class Size:
    side: int  # points of each axis of the accuracy grid
    steps: int  # of each axis of the grid over which instructions are counted
    fallbacks: int  # bases without straight-line code whose instructions are counted
    random: Budget


FULL = Size(1000, 1024, 20, Budget(bases=200, points=1500, skfuzzy_points=40, straight_every=1))
QUICK = Size(250, 256, 5, Budget(bases=200, points=200, skfuzzy_points=5, straight_every=8))


@dataclass(frozen=True)
class Costs:
    """What was counted; empty where it could not be."""

    engines: Sequence[EngineCost] = ()
    peers: Sequence[PeerCost] = ()
    host: Sequence[HostCount] = ()
    fallbacks: dict[int, TableCost] | None = None
    straights: Sequence[StraightCost] = ()
    systems: Sequence[SystemCost] = ()
    surfaces: Sequence[SurfaceCost] = ()


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--seed", type=seed_number, default=1, metavar="N", help="(%(default)s)")
    parser.add_argument(
        "--no-cost", action="store_true", help="do not count instructions (no emulator, valgrind)"
    )
    parser.add_argument("--no-random", action="store_true", help="leave the random rule bases out")


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def accuracy_figures(grid: GridResult) -> list[Figure]:
    """Aggregations and engines differ: the worst of them."""
    centroid = grid.worst_A("engine", [CENTROID])
    sampled = grid.worst_A("peer", [CENTROID], of=f"{LIBFUZZYLITE}, 200 samples")
    goal = 1.5e-4 if sampled is None else min(1.5e-4, sampled)
    singleton = grid.worst_A("engine", SINGLETON_METHODS)
    end_to_end = grid.worst_A("end to end", SINGLETON_METHODS, form=PHYSICAL)
    return [
        Figure("singleton_engine_error_A", singleton, "A", 1.0e-4, "lower"),
        Figure("singleton_end_to_end_error_A", end_to_end, "A", 3e-4, "lower"),
        Figure("centroid_engine_error_A", centroid, "A", goal, "lower"),
        Figure("fuzzylite200_centroid_error_A", sampled, "A", None, "lower"),
    ]


def cost_figures(costs: Costs) -> list[Figure]:
    def worst(
        name: str, kind: str, methods: Sequence[str], forms: Sequence[str], goal: int
    ) -> Figure:
        return Figure(
            name, worst_instr(costs.engines, kind, methods, forms), "instr", goal, "lower"
        )

    def straight(name: str, kinds: Sequence[str], goal: int | None) -> Figure:
        return Figure(name, worst_of(costs.straights, kinds), "instr", goal, "lower")

    means = {one.resolution: one.mean_instr for one in costs.peers}
    singleton, centroid = SINGLETON_METHODS, [CENTROID]
    return [
        worst("compiled_singleton_worst_instr", STRAIGHT, singleton, [Q15], 50),
        worst("compiled_singleton_physical_worst_instr", STRAIGHT, singleton, [PHYSICAL], 65),
        worst("runtime_singleton_worst_instr", TABLE, singleton, (), 120),
        worst("compiled_centroid_worst_instr", STRAIGHT, centroid, (), 120),
        worst("runtime_centroid_worst_instr", TABLE, centroid, (), 500),
        straight("product_and_instr", [PRODUCT], 75),
        straight("sugeno_first_order_instr", [SUGENO, SUGENO_MIN], 90),
        straight("product_max_instr", [PRODUCT_MAX], None),
        *(
            Figure(figure, worst_of_system(costs.systems, name), "instr", None, "lower")
            for name, figure in figure_names().items()
        ),
        Figure(
            "surface_instr",
            max((one.worst_instr for one in costs.surfaces), default=None),
            "instr",
            None,
            "lower",
        ),
        Figure("peer_fuzzylite_singleton_instr", means.get(0), "instr", None, "lower"),
        Figure("peer_fuzzylite_centroid_instr", means.get(100), "instr", None, "lower"),
    ]


def random_figures(result: RandomResult | None) -> list[Figure]:
    tried = None if result is None else result.tried
    compiled_pct = None if result is None else result.compiled_pct
    beyond = None if result is None or result.absent else result.beyond
    return [
        Figure("random_bases_tried", tried, "1", 200, "higher"),
        Figure("random_bases_compiled_pct", compiled_pct, "%", 30.0, "higher"),
        Figure("random_bases_beyond_bound", beyond, "1", 0, "lower"),
    ]


def foreign_figures(tried: Sequence[Tried]) -> list[Figure]:
    return [
        Figure(
            "foreign_files_compiled_pct",
            compiled_pct(tried) if tried else None,
            "%",
            90.0,
            "higher",
        ),
        Figure(
            "foreign_worst_error_pct", worst_error_pct(tried) if tried else None, "%", 0.1, "lower"
        ),
        Figure("gaussian_4x4_bytes", gaussian_bytes(), "B", 8192, "lower"),
    ]


def type2_figures(result: Type2Result | None) -> list[Figure]:
    worst = None if result is None else result.worst_error_pct
    return [Figure("type2_worst_error_pct", worst, "%", 0.1, "lower")]


def count_fallbacks(bench: Bench, result: RandomResult | None, limit: int) -> dict[int, TableCost]:
    """Instructions of the table engine on the first bases without straight-line code."""
    if result is None:
        return {}
    chosen = [outcome for outcome in result.outcomes if outcome.why_not_straight][:limit]
    image = built_image("fuzzy_cost")
    return {
        one.case.random.number: measure_table(bench, image, one.case.compiled, FALLBACK_EVALUATIONS)
        for one in chosen
    }


def count_costs(
    args: argparse.Namespace, size: Size, result: RandomResult | None
) -> tuple[Costs, list[str]]:
    """What could be counted, and why some of it could not."""
    if args.no_cost:
        return Costs(), ["instruction counts: left out with --no-cost"]
    absent: list[str] = []

    def attempt(what: str, measure: Any) -> Any:
        try:
            found = measure()
        except UsageError as error:
            absent.append(f"{what}: {one_line(error)}")
            return None
        say(what)
        return found

    bench = attempt("the bench", Bench)
    if bench is None:
        return Costs(), absent
    engines = attempt("instructions of the engines", lambda: measure_engines(bench, size.steps))
    straights = attempt(
        "instructions of straight-line C of systems", lambda: measure_straights(bench, size.steps)
    )
    systems = attempt("instructions of the engine for any system", lambda: measure_systems(bench))
    surfaces = attempt("instructions of surfaces", lambda: measure_surfaces(bench))
    fallbacks = attempt(
        "instructions of the table engine on random bases",
        lambda: count_fallbacks(bench, result, size.fallbacks),
    )
    peers = attempt("instructions of libfuzzylite", lambda: measure_peers(bench))
    host = attempt("instructions on the host", lambda: measure_host(RESOLUTIONS))
    found = Costs(
        engines or (), peers or (), host or (), fallbacks, straights or (), systems or (),
        surfaces or (),
    )  # fmt: skip
    return found, absent


def context_of(
    args: argparse.Namespace, grid: GridResult, result: RandomResult | None, costs: Costs
) -> dict[str, Any]:
    return {
        "seed": args.seed,
        "quick": args.quick,
        "grid_side": grid.side,
        "errors": [error.row() for error in grid.errors],
        "singleton_semantics_difference_A": grid.worst_A("semantics", SINGLETON_METHODS),
        "q15_end_to_end_error_A": grid.worst_A("end to end", SINGLETON_METHODS, form=Q15),
        "engines": [cost.row() for cost in costs.engines],
        "systems": [cost.row() for cost in costs.systems],
        "surfaces": [cost.row() for cost in costs.surfaces],
        "straights": [cost.row() for cost in costs.straights],
        "peers": [asdict(cost) for cost in costs.peers],
        "host_instr": [asdict(cost) for cost in costs.host],
        "ratios": ratios(costs),
        "fallbacks": {str(i): asdict(cost) for i, cost in (costs.fallbacks or {}).items()},
        "random": None if result is None else random_context(result),
    }


def ratios(costs: Costs) -> dict[str, float]:
    """The peer's mean over the worst of our straight-line code."""
    found = {}
    for name, methods, resolution in (
        ("singleton", SINGLETON_METHODS, 0),
        ("centroid_100", [CENTROID], 100),
        ("centroid_200", [CENTROID], 200),
    ):
        ours = worst_instr(costs.engines, STRAIGHT, methods)
        theirs = [one.mean_instr for one in costs.peers if one.resolution == resolution]
        if ours and theirs:
            found[name] = theirs[0] / ours
    return found


def random_context(result: RandomResult) -> dict[str, Any]:
    return {
        "bases": [outcome.row() for outcome in result.outcomes],
        "refused": {str(number): why for number, why in result.refused.items()},
        "differing_points": result.reasons(),
        "peer_points": result.peer_points(),
        "fallbacks": result.fallbacks(),
        "worst_lsb": result.worst_lsb(),
    }


def tables(grid: GridResult, result: RandomResult | None, costs: Costs) -> list[str]:
    found = [grid_table(grid)]
    difference_A = grid.worst_A("semantics", SINGLETON_METHODS)
    if difference_A is not None:
        found.append(f"sum per rule and maximum per term differ by up to {difference_A:.3f} A here")
    if costs.engines:
        found.append(engine_table(costs.engines))
    if costs.straights:
        found.append(straight_table(costs.straights))
    if costs.systems:
        found.append(system_table(costs.systems))
    if costs.surfaces:
        found.append(surface_table(costs.surfaces))
    if costs.peers:
        found.append(peer_table(costs.peers, costs.engines))
    if costs.host:
        found.append(host_table(costs.host))
    if result is not None:
        lines = beyond_lines(result)
        found += [random_table(result), *(["\n".join(lines)] if lines else [])]
        if costs.fallbacks:
            found.append(fallback_table(result, costs.fallbacks))
    return found


def measure(args: argparse.Namespace, folder: Path) -> Report:
    size = QUICK if args.quick else FULL
    grid = measure_grid(size.side, say)
    absent = list(grid.absent)
    result = None
    if args.no_random:
        absent.append("random rule bases: left out with --no-random")
    else:
        result = measure_random(args.seed, size.random, say)
        absent += result.absent
    tried: list[Tried] = []
    try:
        tried = measure_foreign()
    except UsageError as error:
        absent.append(f"rule files of other projects: {one_line(error)}")
    type2: Type2Result | None = None
    try:
        type2 = measure_type2(args.seed, say)
    except UsageError as error:
        absent.append(f"type-2 rules: {one_line(error)}")
    costs, absent_costs = count_costs(args, size, result)
    plot_errors(folder, grid)
    if costs.engines:
        plot_cost(folder, costs.engines, costs.peers)
    figures = [
        *accuracy_figures(grid),
        *cost_figures(costs),
        *random_figures(result),
        *foreign_figures(tried),
        *type2_figures(type2),
    ]
    context = {
        **context_of(args, grid, result, costs),
        "foreign": rows(tried),
        "type2": None if type2 is None else asdict(type2),
    }
    shown = [
        *tables(grid, result, costs),
        *([foreign_table(tried)] if tried else []),
        *([type2.line()] if type2 else []),
    ]
    return Report(NAME, figures, context, shown, [*absent, *absent_costs])
