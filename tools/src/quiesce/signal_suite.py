"""Everything that `quiesce bench signal` runs: the pieces of work, their budget, their results."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from quiesce import (
    signal_accuracy,
    signal_plant,
    signal_recorded,
    signal_response,
    signal_stress,
    signal_truth,
)
from quiesce.bench_pool import Work, run_work
from quiesce.signal_accuracy import Group
from quiesce.signal_plant import StickSlip
from quiesce.signal_records import Rig, Tally
from quiesce.signal_response import Dropouts, Steady, Step
from quiesce.signal_truth import Answers


@dataclass(frozen=True)
class Budget:
    """Trials of each kind."""

    accuracy: int
    steps: int
    steady: int
    dropouts: int
    truth: int
    stick_slip: int
    stress: int
    offline: int  # instants of each recording that are compared with an offline estimate


FULL = Budget(
    accuracy=500,
    steps=200,
    steady=200,
    dropouts=200,
    truth=200,
    stick_slip=5,
    stress=100,
    offline=2000,
)
QUICK = Budget(
    accuracy=100, steps=50, steady=40, dropouts=40, truth=60, stick_slip=1, stress=20, offline=100
)


@dataclass(frozen=True)
class Results:
    accuracy: list[Group]
    steps: list[Step]
    steady: list[Steady]
    dropouts: list[Dropouts]
    truth: list[Answers]
    stick_slip: list[StickSlip]
    plant_steps: list[dict[str, Any]]
    stress: list[dict[str, Any]]
    recorded: list[dict[str, Any] | None]  # None: not on this machine

    def tallies(self) -> dict[str, Tally]:
        """Of every tick whose true frequency is known, by part."""
        parts = {
            "accuracy": self.accuracy,
            "steps": self.steps,
            "steady": self.steady,
            "dropouts": self.dropouts,
            "truth table": self.truth,
            "stick-slip": self.stick_slip,
        }
        tallies = {name: Tally() for name in parts}
        for name, results in parts.items():
            for result in results:
                tallies[name].join(result.tally)
        return tallies


def accuracy_work(rig: Rig, seed: int, trials: int) -> list[Work]:
    return [
        (
            f"accuracy at {snr_dB} dB, {name}",
            partial(signal_accuracy.measure_accuracy, rig, seed, trials, snr_dB, name),
        )
        for snr_dB in signal_accuracy.SNRS_dB
        for name in signal_accuracy.GROUPS
    ]


def response_work(rig: Rig, seed: int, budget: Budget) -> dict[str, list[Work]]:
    return {
        "steps": [
            (
                f"steps {step[0]:g} -> {step[1]:g} Hz",
                partial(signal_response.measure_step, rig, seed, budget.steps, *step),
            )
            for step in signal_response.STEPS_Hz
        ],
        "steady": [
            (
                f"steady tones at {snr_dB} dB",
                partial(signal_response.measure_steady, rig, seed, budget.steady, snr_dB),
            )
            for snr_dB in signal_response.STEADY_SNRS_dB
        ],
        "dropouts": [
            ("dropouts", partial(signal_response.measure_dropouts, rig, seed, budget.dropouts))
        ],
    }


def plant_work(rig: Rig, seed: int, budget: Budget) -> dict[str, list[Work]]:
    return {
        "stick_slip": [
            (
                f"stick-slip at {freq_Hz:g} Hz",
                partial(signal_plant.measure_stick_slip, rig, seed, budget.stick_slip, freq_Hz),
            )
            for freq_Hz in signal_plant.STICK_Hz
        ],
        "plant_steps": [
            (
                f"plant {step[0]:g} -> {step[1]:g} Hz at {current_mA / 1000:g} A",
                partial(signal_plant.measure_plant_step, rig, seed, *step, current_mA),
            )
            for step in signal_response.STEPS_Hz
            for current_mA in signal_plant.STEP_CURRENTS_mA
        ],
    }


def all_work(rig: Rig, seed: int, budget: Budget, data: Path) -> dict[str, list[Work]]:
    """By the field of Results that it fills."""
    return {
        "accuracy": accuracy_work(rig, seed, budget.accuracy),
        **response_work(rig, seed, budget),
        "truth": [
            (
                f"truth table: {kind}",
                partial(signal_truth.measure_answers, rig, seed, budget.truth, kind),
            )
            for kind in signal_truth.KINDS
        ],
        **plant_work(rig, seed, budget),
        "stress": [
            (kind, partial(signal_stress.measure_stress, rig, seed, budget.stress, kind))
            for kind in signal_stress.KINDS
        ],
        "recorded": [
            (
                source.file,
                partial(signal_recorded.measure_source, rig, data, source, budget.offline),
            )
            for source in signal_recorded.SOURCES
        ],
    }


def measure_all(rig: Rig, seed: int, budget: Budget, data: Path) -> Results:
    parts = all_work(rig, seed, budget, data)
    results = iter(run_work(rig.bench, [piece for work in parts.values() for piece in work]))
    return Results(**{name: [next(results) for _ in work] for name, work in parts.items()})
