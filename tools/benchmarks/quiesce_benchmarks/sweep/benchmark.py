"""`./tools/benchmark sweep`: plants with known truth, recorded in simulation and identified."""

import argparse
import math
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from quiesce.base.errors import UsageError
from quiesce.base.progress import Progress
from quiesce.base.table import format_table
from quiesce.plant_id.sweep import SweepPlan

from quiesce_benchmarks.report import Figure, Report

NAME = "sweep"
HELP = "plants with known truth, identified from simulated recordings"
DESCRIPTION = """Records simulated plants with their sensor's noise, identifies each from its
recording and compares: frequencies, damping, force, lag, and what matters, the reductions under
constant current and under pulses. Repeats one plant with other noise: do the reported 95 %
intervals hold the truth in 95 % of the cases?"""

QUICK_CASES = ("nominal", "lag 10 ms", "frequencies +10 %")
# The repeated recordings: short, since intervals must hold whatever their width.
SEED_PLAN = SweepPlan(sweep_s=20.0, dwell_Hz=(5.0, 12.0), hold_s=0.5, rest_s=1.5)
# The 95 % intervals of 1.96 standard errors.
SIGMAS = 1.96


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--case", metavar="TEXT", help="only cases whose name contains this")
    parser.add_argument("--seeds", type=int, metavar="N", help="noise seeds (20; --quick 6)")


def true_values() -> dict[str, float]:
    """Of the default plant, by the names of the parameters, for a modal mass of 1 kg."""
    from quiesce.base.paths import default_plant
    from quiesce.plant.library import Plant
    from quiesce.plant.variant import read_plant_data

    file = default_plant()
    table, modes = read_plant_data(file), Plant(file).modes
    values = {"delay_ms": 0.0, "corner_Hz": table["shaker"]["corner_Hz"], "yield_exponent": 1.0}
    for i, mode in enumerate(modes, 1):
        values[f"mode{i}_freq_Hz"] = mode.freq_Hz
        values[f"mode{i}_damping_ratio"] = mode.damping_ratio
        values[f"mode{i}_residue_m_s2_V"] = (
            mode.at_force * mode.at_sensor * table["shaker"]["gain_N_V"]
        )
    values["mode2_shape_ratio"] = abs(modes[1].at_sensor / modes[0].at_sensor)
    values["force_scale"] = table["damper"]["force_scale"] * modes[0].at_damper ** 2
    values["viscosity_ratio"] = table["damper"]["viscosity_ratio"]
    return values | {"rise_s": table["coil"]["rise_s"], "fall_s": table["coil"]["fall_s"]}


def scores(seeds: int, progress: Progress) -> dict[str, list[float]]:
    """Distance from the truth in standard errors, by parameter, one a seed."""
    from quiesce.plant_id.fit import is_linear

    from quiesce_benchmarks.sweep.cases import Case, compare

    truth = true_values()
    found: dict[str, list[float]] = {name: [] for name in truth}
    case = Case("nominal, short recording", plan=SEED_PLAN)
    for seed in range(101, 101 + seeds):
        with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
            fit = compare(case, Path(folder), seed).found.fit
        for name, true in truth.items():
            value = fit.values[name]
            error = value - true if is_linear(name) else math.log(value / true)
            found[name].append(error / fit.error(name))
        progress.done(f"seed {seed}")
    return found


def coverage_table(found: dict[str, list[float]]) -> str:
    rows = [
        [
            name,
            f"{np.mean(values):.2f}",
            f"{np.std(values):.2f}",
            f"{100.0 * np.mean(np.abs(values) < SIGMAS):.0f}",
        ]
        for name, values in found.items()
    ]
    head = ["parameter", "mean error / s.e.", "spread / s.e.", "truth in 95 % interval, %"]
    return format_table(head, rows)


def case_row(one) -> list[str]:
    fit = one.found.fit
    return [
        one.case.name,
        f"{one.freq_pct:.4f}",
        "-" if math.isnan(one.damping_pct) else f"{one.damping_pct:.2f}",
        "-" if math.isnan(one.force_pct) else f"{one.force_pct:+.2f}",
        f"{one.rise_ms:+.2f} / {one.fall_ms:+.2f}",
        *(f"{value:.2f}" for value in one.points.values()),
        f"{fit.misfit:.2f}",
        str(len(one.found.warnings)),
    ]


CASE_HEAD = (
    "plant",
    "freq %",
    "damping %",
    "force %",
    "lag rise/fall ms",
    "const amp",
    "accel",
    "pulse amp",
    "accel",
    "misfit",
    "warnings",
)


def chosen_cases(args: argparse.Namespace):
    from quiesce_benchmarks.sweep.cases import CASES

    cases = [one for one in CASES if not args.quick or one.name in QUICK_CASES]
    cases = [one for one in cases if args.case is None or args.case in one.name]
    if not cases:
        raise UsageError(f"--case {args.case}: there are: {', '.join(c.name for c in CASES)}")
    return cases


def measure(args: argparse.Namespace, folder: Path) -> Report:
    from quiesce_benchmarks.sweep.cases import compare

    cases = chosen_cases(args)
    seeds = (6 if args.quick else 20) if args.seeds is None else args.seeds
    progress = Progress(len(cases) + seeds)
    compared = []
    for case in cases:
        with tempfile.TemporaryDirectory(prefix="quiesce-") as scratch:
            compared.append(replace(compare(case, Path(scratch), seed=1), case=case))
        progress.done(case.name)
    found = scores(seeds, progress)
    tables = [format_table(CASE_HEAD, [case_row(one) for one in compared])]
    tables += [coverage_table(found)] if seeds else []
    context = {"cases": len(cases), "seeds": seeds, "noise_mg": 0.5}
    return Report(NAME, figures_of(compared, found, seeds), context, tables)


def figures_of(compared: list, found: dict[str, list[float]], seeds: int) -> list[Figure]:
    held = [abs(value) < SIGMAS for values in found.values() for value in values]
    lags = [abs(lag) for one in compared for lag in (one.rise_ms, one.fall_ms)]
    forces = [abs(one.force_pct) for one in compared if not math.isnan(one.force_pct)]
    dampings = [one.damping_pct for one in compared if not math.isnan(one.damping_pct)]
    coverage = 100.0 * float(np.mean(held)) if seeds else None
    return [
        Figure("worst_reduction_pts", max(c.worst_points for c in compared), "point", 1.0, "lower"),
        Figure("worst_freq_pct", max(c.freq_pct for c in compared), "%", 0.1, "lower"),
        Figure("worst_damping_pct", max(dampings, default=None), "%", 5.0, "lower"),
        Figure("worst_force_pct", max(forces, default=None), "%", None, "lower"),
        Figure("worst_lag_ms", max(lags), "ms", 0.5, "lower"),
        Figure("interval_95_holds_pct", coverage, "%", 90.0, "higher"),
    ]
