"""The estimators of the firmware side by side: the same records, the same ticks.

fit: sliding DFTs with least squares, the default. fft: 1024-point Hann FFT, hop 50.
"""

from collections.abc import Iterable, Sequence
from functools import partial
from typing import Any

from quiesce.engine.bench import Bench
from quiesce.engine.pool import Work, run_work

from quiesce_benchmarks.images import built_image
from quiesce_benchmarks.signal import accuracy, response
from quiesce_benchmarks.signal.accuracy import Group
from quiesce_benchmarks.signal.cost import DEFAULT_RATE_HZ, OTHER_RATES_HZ, TickCost, measure_ticks
from quiesce_benchmarks.signal.records import Rig, make_rig
from quiesce_benchmarks.signal.tables import table

# In the order of the parameter's values.
ESTIMATORS = ("fit", "fft")
RATES_Hz = (DEFAULT_RATE_HZ, *OTHER_RATES_HZ)


def rigs(settings: Sequence[str]) -> dict[str, Rig]:
    return {name: make_rig([*settings, f"estimator={name}"]) for name in ESTIMATORS}


def accuracy_work(rig: Rig, seed: int, trials: int, snrs_dB: Iterable[int]) -> list[Work]:
    """Groups that are the same records whatever the rig's estimator is."""
    return [
        (
            f"estimators: accuracy at {snr_dB} dB, {group}",
            partial(accuracy.measure_accuracy, rig, seed, trials, snr_dB, group),
        )
        for snr_dB in snrs_dB
        for group in accuracy.GROUPS
    ]


def compare_accuracy(
    settings: Sequence[str], seed: int, trials: int, snrs_dB: Sequence[int]
) -> dict[str, list[Group]]:
    """By estimator, groups of accuracy.py in the same order."""
    found = {}
    for name, rig in rigs(settings).items():
        found[name] = run_work(rig.bench, accuracy_work(rig, seed, trials, snrs_dB))
    return found


def compare_steps(
    settings: Sequence[str], seed: int, trials: int
) -> dict[str, list[response.Step]]:
    """By estimator, the steps of response.py."""
    found = {}
    for name, rig in rigs(settings).items():
        work: list[Work] = [
            (
                f"estimators: steps {step[0]:g} -> {step[1]:g} Hz",
                partial(response.measure_step, rig, seed, trials, *step),
            )
            for step in response.STEPS_Hz
        ]
        found[name] = run_work(rig.bench, work)
    return found


def compare_ticks(bench: Bench, ticks: int) -> dict[str, list[TickCost]]:
    """By estimator, instructions of the chain's ticks at RATES_Hz. UsageError without an emulator
    or image."""
    image = built_image("signal_cost")
    return {
        name: [measure_ticks(bench, image, rate_Hz, ticks, number) for rate_Hz in RATES_Hz]
        for number, name in enumerate(ESTIMATORS)
    }


def worst_over_median(cost: TickCost) -> float:
    return cost.worst_instr / cost.median_instr


def accuracy_rows(groups: dict[str, list[Group]]) -> list[dict[str, Any]]:
    return [
        {"estimator": name, **accuracy.row(group)}
        for name, some in groups.items()
        for group in some
    ]


def step_rows(steps: dict[str, list[response.Step]]) -> list[dict[str, Any]]:
    return [{"estimator": name, **step.row()} for name, some in steps.items() for step in some]


def tick_rows(costs: dict[str, list[TickCost]]) -> list[dict[str, Any]]:
    return [
        {
            "estimator": name,
            "tick_rate_Hz": cost.tick_rate_Hz,
            "worst_instr": cost.worst_instr,
            "median_instr": cost.median_instr,
            "mean_instr": cost.mean_instr,
            "worst_over_median": worst_over_median(cost),
        }
        for name, some in costs.items()
        for cost in some
    ]


def tables(rows: dict[str, list[dict[str, Any]]]) -> list[str]:
    """Of "accuracy", "steps" and "ticks", those that there are."""
    shown = {
        "accuracy": (
            "estimators on the same tones: RMS errors over Cramer and Rao's bound of 1.024 s",
            {
                "estimator": "estimator",
                "snr_dB": "SNR dB",
                "group": "tones",
                "rmse_over_bound": "freq over bound",
                "rmse_Hz": "freq Hz",
                "phase_rms_deg": "phase deg",
                "amplitude_rms_error_pct": "amplitude %",
                "invalid_pct": "invalid %",
            },
        ),
        "steps": (
            "estimators at steps of 20 dB",
            {
                "estimator": "estimator",
                "step": "step",
                "settle_worst_s": "settled s, worst",
                "settle_median_s": "median",
                "valid_again_worst_s": "valid again s, worst",
                "invalid_after_worst_ms": "invalid ms, worst",
            },
        ),
        "ticks": (
            "instructions of a tick of the sensing chain",
            {
                "estimator": "estimator",
                "tick_rate_Hz": "ticks Hz",
                "worst_instr": "worst",
                "median_instr": "median",
                "mean_instr": "mean",
                "worst_over_median": "worst over median",
            },
        ),
    }
    return [table(shown[key][0], rows[key], shown[key][1]) for key in shown if rows.get(key)]
