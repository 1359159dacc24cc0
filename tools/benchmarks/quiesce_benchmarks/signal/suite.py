"""Everything that `./tools/benchmark signal` runs: pieces of work, their budget, their results."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from quiesce.engine.pool import Work, run_work

from quiesce_benchmarks.signal import (
    accuracy as signal_accuracy,
)
from quiesce_benchmarks.signal import (
    plant,
    response,
)
from quiesce_benchmarks.signal import (
    recorded as signal_recorded,
)
from quiesce_benchmarks.signal import (
    stress as signal_stress,
)
from quiesce_benchmarks.signal import (
    truth as signal_truth,
)
from quiesce_benchmarks.signal.accuracy import Group
from quiesce_benchmarks.signal.plant import StickSlip
from quiesce_benchmarks.signal.records import Rig, Tally
from quiesce_benchmarks.signal.response import Dropouts, Steady, Step
from quiesce_benchmarks.signal.truth import Answers


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
                partial(response.measure_step, rig, seed, budget.steps, *step),
            )
            for step in response.STEPS_Hz
        ],
        "steady": [
            (
                f"steady tones at {snr_dB} dB",
                partial(response.measure_steady, rig, seed, budget.steady, snr_dB),
            )
            for snr_dB in response.STEADY_SNRS_dB
        ],
        "dropouts": [("dropouts", partial(response.measure_dropouts, rig, seed, budget.dropouts))],
    }


def plant_work(rig: Rig, seed: int, budget: Budget) -> dict[str, list[Work]]:
    return {
        "stick_slip": [
            (
                f"stick-slip at {freq_Hz:g} Hz",
                partial(plant.measure_stick_slip, rig, seed, budget.stick_slip, freq_Hz),
            )
            for freq_Hz in plant.STICK_Hz
        ],
        "plant_steps": [
            (
                f"plant {step[0]:g} -> {step[1]:g} Hz at {current_mA / 1000:g} A",
                partial(plant.measure_plant_step, rig, seed, *step, current_mA),
            )
            for step in response.STEPS_Hz
            for current_mA in plant.STEP_CURRENTS_mA
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
