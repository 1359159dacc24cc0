"""Everything that `./tools/benchmark control` runs: pieces of work, their size, their results."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from quiesce_benchmarks.control import broadband, robust, safety
from quiesce_benchmarks.control import steps as control_steps
from quiesce_benchmarks.control.adaptation import SHOWN, Trajectory, measure_trajectory
from quiesce_benchmarks.control.broadband import ChirpResult, Input
from quiesce_benchmarks.control.cost import Counted, cases, count
from quiesce_benchmarks.control.rig import SETTINGS, Plant, Rig, Work
from quiesce_benchmarks.control.robust import GOAL_VARIATIONS, Cell, corners
from quiesce_benchmarks.control.ruler import Ruler
from quiesce_benchmarks.control.safety import Day, Inverted
from quiesce_benchmarks.control.steady import Point, POINTS_Hz, measure_point
from quiesce_benchmarks.control.steps import StepResult
from quiesce_benchmarks.control.variants import Variation, coil_variations

DAY_s = 86_400.0


@dataclass(frozen=True)
class Size:
    sweep_Hz: tuple[float, ...]  # holds POINTS_Hz
    adapt_s: float  # of a steady run with adaptation
    variations: tuple[Variation, ...]
    robust_s: float
    robust_step_A: float
    broadband_step_A: float
    day_s: float
    safety_Hz: tuple[float, ...]


FULL = Size(
    sweep_Hz=tuple(np.arange(4.0, 22.25, 0.5).tolist()),
    adapt_s=120.0,
    variations=GOAL_VARIATIONS,
    robust_s=120.0,
    robust_step_A=robust.GRID_STEP_A,
    broadband_step_A=broadband.GRID_STEP_A,
    day_s=DAY_s,
    safety_Hz=tuple(np.arange(4.0, 22.25, 0.5).tolist()),
)
QUICK = Size(
    sweep_Hz=(4.0, *POINTS_Hz[:1], 7.5, *POINTS_Hz[1:2], 12.5, *POINTS_Hz[2:], 22.0),
    adapt_s=120.0,
    variations=tuple(corners(GOAL_VARIATIONS)),
    robust_s=120.0,
    robust_step_A=1.25,
    broadband_step_A=1.25,
    day_s=600.0,
    safety_Hz=(4.0, 5.0, 8.0, 11.5, 15.0, 22.0),
)


@dataclass(frozen=True)
class Results:
    day: list[Day] = field(default_factory=list)  # one
    points: list[Point] = field(default_factory=list)
    steps: list[StepResult] = field(default_factory=list)
    cells: list[Cell] = field(default_factory=list)
    extra_cells: list[Cell] = field(default_factory=list)
    inputs: list[Input] = field(default_factory=list)
    chirp: list[ChirpResult] = field(default_factory=list)  # one
    work: list[safety.Work] = field(default_factory=list)
    inverted: list[Inverted] = field(default_factory=list)
    trajectories: list[Trajectory] = field(default_factory=list)


def steady_work(rig: Rig, size: Size) -> list[Work]:
    return [
        (f"steady {freq_Hz:g} Hz", partial(measure_point, rig, freq_Hz, size.adapt_s))
        for freq_Hz in size.sweep_Hz
    ]


def step_work(rig: Rig) -> list[Work]:
    return [
        (
            f"{change[0]:g} to {change[1]:g} Hz at {at_s:g} s, {name}",
            partial(control_steps.measure_step, rig, *change, at_s, name),
        )
        for change in control_steps.CHANGES_Hz
        for at_s in (control_steps.EARLY_s, control_steps.LATE_s)
        for name in control_steps.controls(rig)
    ]


def cell_work(rig: Rig, ruler: Ruler, size: Size, variations: Sequence[Variation]) -> list[Work]:
    return [
        (
            f"{variation.label}: {freq_Hz:g} Hz",
            partial(
                robust.measure_cell,
                rig, ruler, variation, freq_Hz, size.robust_s, size.robust_step_A,
            ),
        )
        for variation in variations
        for freq_Hz in robust.FREQS_Hz
    ]  # fmt: skip


def broadband_work(rig: Rig, size: Size, seed: int, data: Path | None) -> list[Work]:
    """data: folder of the earthquakes; None leaves them out."""
    scenarios = broadband.made_inputs(rig, seed)
    if data is not None:
        scenarios += broadband.earthquakes(rig, data)
    return [
        (one.name, partial(broadband.measure_input, rig, one, size.broadband_step_A))
        for one in scenarios
    ]


def energy_work(rig: Rig, size: Size, plants: dict[str, Plant]) -> list[Work]:
    return [
        (
            f"work on the {name} plant, {freq_Hz:g} Hz, {setting}",
            partial(safety.measure_work, rig, plant, name, freq_Hz, setting),
        )
        for name, plant in plants.items()
        for freq_Hz in size.safety_Hz
        for setting in SETTINGS
    ]


def inverted_work(rig: Rig, size: Size) -> list[Work]:
    return [
        (
            f"inverted accelerometer, {freq_Hz:g} Hz, {setting}",
            partial(safety.measure_inverted, rig, freq_Hz, setting),
        )
        for freq_Hz, setting in safety.inverted_pairs(size.safety_Hz)
    ]


@dataclass(frozen=True)
class Order:
    """What is measured on what."""

    size: Size
    seed: int
    data: Path | None  # of the earthquakes
    energy_plants: dict[str, Plant]


def all_work(rig: Rig, ruler: Ruler, order: Order) -> dict[str, list[Work]]:
    """By the field of Results that it fills. The longest run goes first."""
    size = order.size
    day = partial(safety.measure_day, rig, order.seed, size.day_s)
    return {
        "day": [(f"{size.day_s / 3600.0:g} hours of faults", day)],
        "points": steady_work(rig, size),
        "steps": step_work(rig),
        "cells": cell_work(rig, ruler, size, size.variations),
        "extra_cells": cell_work(rig, ruler, size, coil_variations(rig.plant.coil_rise_s)),
        "inputs": broadband_work(rig, size, order.seed, order.data),
        "chirp": [("chirp, cycle by cycle", partial(broadband.measure_chirp, rig))],
        "work": energy_work(rig, size, order.energy_plants),
        "inverted": inverted_work(rig, size),
        "trajectories": [
            (
                f"adaptation over time, {variation.label}",
                partial(measure_trajectory, rig, variation, size.robust_s),
            )
            for variation in SHOWN
        ],
    }


def measure_all(rig: Rig, ruler: Ruler, order: Order) -> Results:
    parts = all_work(rig, ruler, order)
    results = iter(rig.work([piece for work in parts.values() for piece in work]))
    return Results(**{name: [next(results) for _ in work] for name, work in parts.items()})


def measure_cost(rig: Rig, is_quick: bool) -> list[Counted]:
    return rig.work(
        [
            (f"image: {scenario.name}, {control.law} {setting}",
             partial(count, rig, scenario, control, setting))
            for scenario, control, setting in cases(rig, is_quick)
        ]
    )  # fmt: skip
