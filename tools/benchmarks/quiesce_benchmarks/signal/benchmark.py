"""`./tools/benchmark signal`: what the sensing chain knows about the vibration, against theory."""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown

from quiesce_benchmarks.report import Figure, Report
from quiesce_benchmarks.seeds import seed_number
from quiesce_benchmarks.signal import accuracy, estimators, response
from quiesce_benchmarks.signal import cost as signal_cost
from quiesce_benchmarks.signal.accuracy import phase_excess_deg, worst_ratio
from quiesce_benchmarks.signal.cost import SignalCost, cost_tables, measure_cost
from quiesce_benchmarks.signal.plots import plot_accuracy, plot_steps, plot_truth
from quiesce_benchmarks.signal.recorded import SOURCES, SWEEP, find_folder, sweep_within_pct
from quiesce_benchmarks.signal.records import NOTICE_s, Rig, Tally, make_rig
from quiesce_benchmarks.signal.suite import FULL, QUICK, Results, measure_all
from quiesce_benchmarks.signal.tables import tables

NAME = "signal"
HELP = "the sensing chain: accuracy, response, validity, robustness, cost"
DESCRIPTION = """Measure the sensing chain as shipped: accuracy against the Cramer-Rao bound,
response to steps, validity, the rule of the dominant frequency, stick-slip, recordings, and
the instructions of a tick beside a batch pipeline on CMSIS-DSP."""

# Trials a group, and a step, of the estimators side by side.
COMPARED_TRIALS, QUICK_COMPARED_TRIALS = 100, 20
# Ticks whose instructions are counted: at each rate, and for the share of each source file.
QUICK_COST_TICKS = {"ticks": 20_000, "profile_ticks": 10_000}


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--seed", type=seed_number, default=1, metavar="N", help="(%(default)s)")
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="parameter, repeatable"
    )
    parser.add_argument(
        "--data",
        type=Path,
        metavar="DIR",
        help="folder of the recordings (../shared/data/vibration beside the project)",
    )
    parser.add_argument(
        "--no-cost", action="store_true", help="do not count instructions (no emulator)"
    )


def mean(values: Sequence[float]) -> float:
    return float(sum(values) / len(values))


def accuracy_figures(results: Results) -> list[Figure]:
    groups = results.accuracy
    gated, high = accuracy.GATED_SNRS_dB, [accuracy.HIGH_SNR_dB]
    rms_error = max(r.rms_error for r in [*results.steps, *results.steady])
    return [
        Figure("freq_rmse_over_crlb_max", worst_ratio(groups, gated), "1", 1.5, "lower"),
        Figure("freq_rmse_over_crlb_60dB", worst_ratio(groups, high), "1", 2.0, "lower"),
        Figure("phase_excess_deg", phase_excess_deg(groups), "deg", 0.5, "lower"),
        Figure("rms_error_pct", 100.0 * rms_error, "%", 0.5, "lower"),
    ]


def response_figures(results: Results) -> list[Figure]:
    goals_s = {"10_20": 0.25, "5_10": 0.25, "20_5": 0.45}
    worst_s = {step.name: float(step.settle_s.max()) for step in results.steps}
    invalid_ms = 1e3 * max(float(step.invalid_after_s.max()) for step in results.steps)
    return [
        *(
            Figure(f"settle_{name}_s", worst_s[name], "s", goal_s, "lower")
            for name, goal_s in goals_s.items()
        ),
        Figure("invalid_after_step_ms", invalid_ms, "ms", 1e3 * NOTICE_s, "lower"),
    ]


def trust_figures(rig: Rig, results: Results) -> list[Figure]:
    total = Tally()
    for tally in results.tallies().values():
        total.join(tally)
    steady_pct = 100.0 * mean([s.valid_share.mean() for s in results.steady])
    recovery_s = max(float(d.recovery_s.max()) for d in results.dropouts)
    recovery_goal_s = rig.longest_window_ms * 1e-3 + response.RECOVERY_MARGIN_s
    correct_pct = 100.0 * mean([a.is_correct.mean() for a in results.truth])
    stick_pct = 100.0 * mean([s.right_share for s in results.stick_slip])
    sweep_pct = sweep_within_pct(results.recorded)
    return [
        Figure("valid_steady_pct", steady_pct, "%", 99.5, "higher"),
        Figure("valid_but_wrong_pct", total.wrong_pct, "%", 0.1, "lower"),
        Figure("dropout_recovery_s", recovery_s, "s", recovery_goal_s, "lower"),
        Figure("two_tone_correct_pct", correct_pct, "%", 100.0, "higher"),
        Figure("stickslip_fundamental_pct", stick_pct, "%", 100.0, "higher"),
        Figure("sweep_within_0p12Hz_pct", sweep_pct, "%", 99.0, "higher"),
    ]


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def count_cost(rig: Rig, args: argparse.Namespace) -> tuple[SignalCost | None, Sequence[str]]:
    """The instruction counts, and why some or all of them are missing."""
    if args.no_cost:
        return None, ["instruction counts: left out with --no-cost"]
    ticks = QUICK_COST_TICKS if args.quick else {}
    try:
        cost = measure_cost(rig.bench, **ticks, done=say)
    except UsageError as error:
        return None, [f"instruction counts: {error}"]
    return cost, cost.absent


def cost_figures(cost: SignalCost | None) -> list[Figure]:
    if cost is not None:
        return cost.figures()
    peers = signal_cost.PEER_FORMATS
    return [
        Figure("tick_worst_instr", None, "instr", None, "lower"),
        Figure("tick_median_instr", None, "instr", None, "lower"),
        Figure("tick_mean_instr", None, "instr", signal_cost.MEAN_GOAL_INSTR, "lower"),
        *(Figure(f"cmsis_{peer}_peak_instr", None, "instr", None, "lower") for peer in peers),
        *(
            Figure(f"peak_ratio_{peer}", None, "1", signal_cost.RATIO_GOAL, "higher")
            for peer in peers
        ),
        Figure("ram_bytes", None, "byte", signal_cost.RAM_GOAL_BYTES, "lower"),
    ]


def context_of(
    rig: Rig, args: argparse.Namespace, results: Results, cost: SignalCost | None
) -> dict[str, Any]:
    return {
        "seed": args.seed,
        "quick": args.quick,
        "settings": list(args.set),
        "tick_rate_Hz": rig.rate_Hz,
        "accuracy": [accuracy.row(group) for group in results.accuracy],
        "steps": [step.row() for step in results.steps],
        "steady": [steady.row() for steady in results.steady],
        "dropouts": [dropouts.row() for dropouts in results.dropouts],
        "truth_table": [answers.row() for answers in results.truth],
        "stick_slip": [stick.row() for stick in results.stick_slip],
        "plant_steps": results.plant_steps,
        "stress": results.stress,
        "recordings": [row for row in results.recorded if row is not None],
        "valid_but_wrong": {name: asdict(tally) for name, tally in results.tallies().items()},
        "cost": cost.context() if cost is not None else None,
    }


def compare_estimators(args: argparse.Namespace) -> dict[str, list[dict[str, Any]]]:
    trials = QUICK_COMPARED_TRIALS if args.quick else COMPARED_TRIALS
    groups = estimators.compare_accuracy(args.set, args.seed, trials, accuracy.GATED_SNRS_dB)
    steps = estimators.compare_steps(args.set, args.seed, trials)
    return {"accuracy": estimators.accuracy_rows(groups), "steps": estimators.step_rows(steps)}


def absent_recordings(folder: Path, results: Results) -> list[str]:
    return [
        f"{shown(folder / source.file)}: not on this machine"
        + ("; sweep_within_0p12Hz_pct is not judged" if source is SWEEP else "")
        for source, row in zip(SOURCES, results.recorded, strict=True)
        if row is None
    ]


def measure(args: argparse.Namespace, folder: Path) -> Report:
    data = find_folder(args.data)
    rig = make_rig(args.set)
    results = measure_all(rig, args.seed, QUICK if args.quick else FULL, data)
    cost, absent_cost = count_cost(rig, args)
    plot_accuracy(folder, results.accuracy)
    plot_steps(folder, results.steps)
    plot_truth(folder, results.truth)
    compared = compare_estimators(args)
    context = {**context_of(rig, args, results, cost), "estimators": compared}
    figures = [
        *accuracy_figures(results),
        *response_figures(results),
        *trust_figures(rig, results),
        *cost_figures(cost),
    ]
    shown_tables = [
        *tables(context),
        *estimators.tables(compared),
        *(cost_tables(cost) if cost is not None else []),
    ]
    absent = [*absent_recordings(data, results), *absent_cost]
    return Report(NAME, figures, context, shown_tables, absent)
