"""`./tools/benchmark control`: a control law in closed loop, against constants, bound and goals."""

import argparse
import sys
import tempfile
from pathlib import Path

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import default_plant, shown
from quiesce.engine.bench import Bench
from quiesce.hil.published import load_reference

from quiesce_benchmarks.control import broadband, plots
from quiesce_benchmarks.control import tables as control_tables
from quiesce_benchmarks.control.cost import Counted
from quiesce_benchmarks.control.figures import all_figures, context_of
from quiesce_benchmarks.control.law_file import bytes_in_flash, law_options
from quiesce_benchmarks.control.optima import COMMAND, load_optima
from quiesce_benchmarks.control.rig import Plant, Rig, make_judged, read_plant
from quiesce_benchmarks.control.ruler import Ruler
from quiesce_benchmarks.control.suite import FULL, QUICK, Order, Results, measure_all, measure_cost
from quiesce_benchmarks.control.variants import energy_plants
from quiesce_benchmarks.report import Report
from quiesce_benchmarks.seeds import seed_number

NAME = "control"
HELP = "a control law in closed loop: steady, steps, other plants, other inputs, safety, cost"
DESCRIPTION = """Measure a control law in closed loop with the firmware's own code: steady sines
over the band, steps, plants that its table was not made for, inputs that no table is made for,
faults and wrong signs, instructions. Beside it stand the best constant current, the fuzzy law, and
the best that any current can do, from docs/results/bounds."""


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--seed", type=seed_number, default=1, metavar="N", help="(%(default)s)")
    parser.add_argument("--law", default="phase", help="the law to judge (%(default)s)")
    parser.add_argument(
        "--plant", type=Path, metavar="FILE", help="plant file (the published plant)"
    )
    parser.add_argument(
        "--table", type=Path, metavar="FILE", help="phase law file, for law phase (the shipped one)"
    )
    parser.add_argument(
        "--bounds", type=Path, action="append", default=[], metavar="FILE",
        help="bounds of a plant of your own, beside those in docs/results/bounds; repeatable",
    )  # fmt: skip
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE",
        help="parameter of the judged law, repeatable",
    )  # fmt: skip
    parser.add_argument(
        "--data", type=Path, metavar="DIR",
        help="folder of the earthquakes (../shared/data/earthquake beside the project)",
    )  # fmt: skip
    parser.add_argument(
        "--no-cost", action="store_true",
        help="do not run the image: no instruction counts, no comparison with the host",
    )  # fmt: skip


def count_cost(rig: Rig, args: argparse.Namespace) -> tuple[list[Counted], list[str]]:
    """What the image did, and why it could not."""
    if args.no_cost:
        return [], ["the image: left out with --no-cost"]
    try:
        return measure_cost(rig, args.quick), []
    except UsageError as error:
        return [], [f"the image: {one_line(error)}"]


def tables(ruler: Ruler, results: Results, counted: list[Counted]) -> list[str]:
    reference = load_reference() if ruler.is_published else None
    t = control_tables
    out = [
        t.point_table(results.points, ruler, reference),
        t.sweep_table(results.points, ruler),
        t.step_table(results.steps),
        t.robust_table(results.cells),
        t.cell_table("the plants farthest from their bound", t.worst_cells(results.cells)),
        t.cell_table("other coils, without a goal", results.extra_cells),
        t.broadband_table(results.inputs),
        t.chirp_table(results.chirp[0], ruler),
        t.work_table(results.work, results.inverted),
        t.day_table(results.day[0]),
    ]
    if counted:
        out.append(t.cost_table(counted))
    if ruler.own_under():
        out.append(t.ruler_table(ruler))
    return out


def plot(folder: Path, ruler: Ruler, results: Results) -> None:
    plots.plot_sweep(folder, results.points, ruler)
    plots.plot_robust(folder, results.cells)
    plots.plot_steps(folder, results.steps)
    plots.plot_broadband(folder, results.inputs)
    plots.plot_chirp(folder, results.chirp[0])
    plots.plot_adaptation(folder, results.trajectories)


def measure(args: argparse.Namespace, folder: Path) -> Report:
    data = broadband.find_folder(args.data)
    bench = Bench()
    plant = read_plant(bench, args.plant or default_plant())
    judged, params = make_judged(bench, args.law, args.set, plant)
    with tempfile.TemporaryDirectory(prefix="quiesce-control-") as scratch:
        options = law_options(args.law, args.table, Path(scratch))
        rig = Rig(bench, plant, judged.with_options(options), params, args.seed, Path(scratch))
        return measure_on(rig, args, folder, data)


def measure_on(rig: Rig, args: argparse.Namespace, folder: Path, data: Path) -> Report:
    words = bytes_in_flash(args.law, args.table)
    size = QUICK if args.quick else FULL
    ruler = Ruler(rig.plant, load_optima(args.bounds), size.sweep_Hz)
    missing = broadband.absent_earthquakes(rig, data)
    order = Order(
        size=size,
        seed=args.seed,
        data=None if missing else data,
        energy_plants=energy_plants(rig),
    )
    results = measure_all(rig, ruler, order)
    for point in results.points:
        ruler.learn(point.freq_Hz, point.found())
    counted, absent_cost = count_cost(rig, args)
    figures = all_figures(rig, ruler, results, counted, words, not missing)
    plot(folder, ruler, results)
    facts = facts_of(rig.plant, args)
    print(f"{rig.run_count} runs", file=sys.stderr)
    return Report(
        NAME,
        figures,
        context_of(ruler, results, counted, facts),
        tables(ruler, results, counted),
        [*absent_bounds(ruler, rig.plant, results), *missing, *absent_cost],
    )


def absent_bounds(ruler: Ruler, plant: Plant, results: Results) -> list[str]:
    command = f"{COMMAND} OUT.json --plant {shown(plant.file)}"
    lacking_Hz = ruler.lacking_Hz()
    lacking = sum(cell.bound_amp_pct is None for cell in results.cells)
    lines = []
    if lacking_Hz:
        freqs = ", ".join(f"{freq_Hz:g}" for freq_Hz in lacking_Hz)
        lines.append(f"no stored bound of the plant at {freqs} Hz: {command}")
    if lacking:
        lines.append(
            f"no stored bound of {lacking} of {len(results.cells)} other plants and "
            f"frequencies: {command} --robustness"
        )
    return lines


def facts_of(plant: Plant, args: argparse.Namespace) -> dict[str, object]:
    return {
        "law": args.law,
        "plant": shown(plant.file),
        "settings": list(args.set),
        "seed": args.seed,
        "quick": args.quick,
    }
