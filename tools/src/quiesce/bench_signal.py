"""`quiesce bench signal`: what the sensing chain knows about the vibration, against theory."""

import argparse
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from quiesce import signal_accuracy, signal_plant, signal_response, signal_truth
from quiesce.bench_exe import Bench
from quiesce.bench_report import Figure, Report
from quiesce.progress import Progress
from quiesce.signal_accuracy import Group, measure_accuracy, phase_excess_deg, worst_ratio
from quiesce.signal_plant import StickSlip, measure_stick_slip
from quiesce.signal_records import Rig, Tally, make_rig
from quiesce.signal_response import (
    Dropouts,
    Steady,
    Step,
    measure_dropouts,
    measure_steady,
    measure_step,
)
from quiesce.signal_truth import Answers, measure_answers

NAME = "signal"
HELP = "the sensing chain: accuracy, speed of response, validity, robustness, cost"
DESCRIPTION = """Measure the sensing chain as shipped: accuracy against the Cramer-Rao bound,
response to steps, validity, the rule of the dominant frequency, stick-slip."""

WORKERS = 2


@dataclass(frozen=True)
class Budget:
    """Trials of each kind."""

    accuracy: int
    steps: int
    steady: int
    dropouts: int
    truth: int
    stick_slip: int


FULL = Budget(accuracy=500, steps=200, steady=200, dropouts=200, truth=200, stick_slip=5)
QUICK = Budget(accuracy=60, steps=50, steady=40, dropouts=40, truth=50, stick_slip=1)


@dataclass(frozen=True)
class Results:
    accuracy: list[Group]
    steps: list[Step]
    steady: list[Steady]
    dropouts: Dropouts
    truth: list[Answers]
    stick_slip: list[StickSlip]

    def tallies(self) -> dict[str, Tally]:
        """Of all synthetic and plant ticks, by part."""
        parts = {
            "accuracy": self.accuracy,
            "steps": self.steps,
            "steady": self.steady,
            "dropouts": [self.dropouts],
            "truth table": self.truth,
            "stick-slip": self.stick_slip,
        }
        tallies = {name: Tally() for name in parts}
        for name, results in parts.items():
            for result in results:
                tallies[name].join(result.tally)
        return tallies


def seed_number(text: str) -> int:
    value = int(text)
    if not 0 <= value < 1 << 32:
        raise ValueError
    return value


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--seed", type=seed_number, default=1, metavar="N", help="(%(default)s)")
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="parameter, repeatable"
    )


def run_all(bench: Bench, tasks: Sequence[tuple[str, Callable[[], Any]]]) -> list[Any]:
    """Results in order; WORKERS at a time."""
    progress = Progress(len(tasks))

    def work(name: str, task: Callable[[], Any]) -> Any:
        result = task()
        progress.done(name)
        return result

    pool = ThreadPoolExecutor(WORKERS)
    try:
        return [future.result() for future in [pool.submit(work, *task) for task in tasks]]
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        bench.stop()
        raise
    finally:
        pool.shutdown()


def synthetic(rig: Rig, seed: int, budget: Budget) -> Results:
    parts: dict[str, list[tuple[str, Callable[[], Any]]]] = {
        "accuracy": [
            (
                f"accuracy at {snr_dB} dB, {name}",
                partial(measure_accuracy, rig, seed, budget.accuracy, snr_dB, name),
            )
            for snr_dB in signal_accuracy.SNRS_dB
            for name in signal_accuracy.GROUPS
        ],
        "steps": [
            (
                f"steps {step[0]:g} -> {step[1]:g} Hz",
                partial(measure_step, rig, seed, budget.steps, *step),
            )
            for step in signal_response.STEPS_Hz
        ],
        "steady": [
            (
                f"steady tones at {snr_dB} dB",
                partial(measure_steady, rig, seed, budget.steady, snr_dB),
            )
            for snr_dB in signal_response.STEADY_SNRS_dB
        ],
        "dropouts": [("dropouts", partial(measure_dropouts, rig, seed, budget.dropouts))],
        "truth": [
            (f"truth table: {kind}", partial(measure_answers, rig, seed, budget.truth, kind))
            for kind in signal_truth.KINDS
        ],
        "stick_slip": [
            (
                f"stick-slip at {freq_Hz:g} Hz",
                partial(measure_stick_slip, rig, seed, budget.stick_slip, freq_Hz),
            )
            for freq_Hz in signal_plant.STICK_Hz
        ],
    }
    results = iter(run_all(rig.bench, [task for tasks in parts.values() for task in tasks]))
    found = {name: [next(results) for _ in tasks] for name, tasks in parts.items()}
    return Results(**{**found, "dropouts": found["dropouts"][0]})


def mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def figures_of(rig: Rig, results: Results) -> list[Figure]:
    total = Tally()
    for tally in results.tallies().values():
        total.join(tally)
    steps = {step.name: step for step in results.steps}
    rms_error = max(r.rms_error for r in [*results.steps, *results.steady])
    answers = [float(answer.is_correct.mean()) for answer in results.truth]
    accuracy = results.accuracy
    gated, high = signal_accuracy.GATED_SNRS_dB, [signal_accuracy.HIGH_SNR_dB]
    recovery_s = float(results.dropouts.recovery_s.max())
    recovery_goal_s = rig.longest_window_ms * 1e-3 + signal_response.RECOVERY_MARGIN_s
    return [
        Figure("freq_rmse_over_crlb_max", worst_ratio(accuracy, gated), "1", 1.5, "lower"),
        Figure("freq_rmse_over_crlb_60dB", worst_ratio(accuracy, high), "1", 2.0, "lower"),
        Figure("phase_excess_deg", phase_excess_deg(accuracy), "deg", 0.5, "lower"),
        Figure("rms_error_pct", 100.0 * rms_error, "%", 0.5, "lower"),
        Figure("settle_10_20_s", float(steps["10_20"].settle_s.max()), "s", 0.25, "lower"),
        Figure("settle_5_10_s", float(steps["5_10"].settle_s.max()), "s", 0.25, "lower"),
        Figure("settle_20_5_s", float(steps["20_5"].settle_s.max()), "s", 0.45, "lower"),
        Figure(
            "invalid_after_step_ms",
            1e3 * max(float(step.invalid_after_s.max()) for step in results.steps),
            "ms",
            30.0,
            "lower",
        ),
        Figure(
            "valid_steady_pct",
            100.0 * mean([float(s.valid_share.mean()) for s in results.steady]),
            "%",
            99.5,
            "higher",
        ),
        Figure("valid_but_wrong_pct", total.wrong_pct, "%", 0.1, "lower"),
        Figure("dropout_recovery_s", recovery_s, "s", recovery_goal_s, "lower"),
        Figure("two_tone_correct_pct", 100.0 * mean(answers), "%", 100.0, "higher"),
        Figure(
            "stickslip_fundamental_pct",
            100.0 * mean([s.right_share for s in results.stick_slip]),
            "%",
            100.0,
            "higher",
        ),
    ]


def context_of(rig: Rig, args: argparse.Namespace, results: Results) -> dict[str, Any]:
    return {
        "seed": args.seed,
        "quick": args.quick,
        "settings": list(args.set),
        "tick_rate_Hz": rig.rate_Hz,
        "accuracy": [signal_accuracy.row(group) for group in results.accuracy],
        "steps": [step.row() for step in results.steps],
        "steady": [steady.row() for steady in results.steady],
        "dropouts": results.dropouts.row(),
        "truth_table": [answers.row() for answers in results.truth],
        "stick_slip": [stick.row() for stick in results.stick_slip],
        "valid_but_wrong": {
            name: {"ticks": tally.ticks, "valid": tally.valid, "wrong": tally.wrong}
            for name, tally in results.tallies().items()
        },
    }


def measure(args: argparse.Namespace, folder: Path) -> Report:
    rig = make_rig(args.set)
    results = synthetic(rig, args.seed, QUICK if args.quick else FULL)
    return Report(NAME, figures_of(rig, results), context_of(rig, args, results))
