"""The phase law from a cold start on 54 plants that its table was not made for, and its floor of
acceleration on the plant as it is."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from quiesce.base.errors import UsageError
from quiesce.base.table import format_table
from quiesce.engine.trace import Trace

from quiesce_benchmarks.control.measures import converge_s, reduction_pct, second_amplitudes
from quiesce_benchmarks.control.optima import COMMAND, FOLDER, load_optima
from quiesce_benchmarks.control.rig import DISPLACEMENT, OPEN_LOOP, Plant, Rig
from quiesce_benchmarks.control.robust import GOAL_VARIATIONS, FREQS_Hz, corners
from quiesce_benchmarks.control.ruler import stored
from quiesce_benchmarks.control.scenarios import steady
from quiesce_benchmarks.control.variants import Variation, varied_plant
from quiesce_benchmarks.lock.rig import phase_rig
from quiesce_benchmarks.part import Effort, Measured

TITLE = "the phase law on 54 plants at 4 frequencies; its floor of acceleration"
FIGURES = (
    ("phase_least_share", "1", 0.9, "higher"),
    ("phase_cells_below_09", "1", 0.0, "lower"),
    ("phase_adapt_s", "s", 25.0, "lower"),
    ("phase_accel_floor_worst_pct", "%", 0.5, "lower"),
)

LEAST_SHARE = 0.9
CONVERGED = 0.01
ADAPT_s, FLOOR_s, OPEN_s = 120.0, 180.0, 8.0
LAST_s = 10  # of the adapted state
FLOOR_pct = -1.0  # the parameter's default
FLOOR_Hz = tuple(np.arange(4.0, 22.25, 0.5).tolist())
QUICK_FLOOR_Hz = (4.0, 5.0, 10.0, 20.0)
TRYING, RESTING = 2, 4  # adapt_state
COLUMNS = ("t_s", "x5_um", "a5_mm_s2", "adapt_state")


@dataclass(frozen=True)
class Cell:
    """One plant at one frequency, floor off. Reductions in % against its own 0 A."""

    label: str
    freq_Hz: float
    amp_pct: float
    bound_pct: float
    adapt_s: float  # from the first trial on

    @property
    def share(self) -> float:
        return self.amp_pct / max(self.bound_pct, self.amp_pct)

    def row(self) -> list[str]:
        return [
            self.label, f"{self.freq_Hz:g}", f"{self.amp_pct:.2f}", f"{self.bound_pct:.2f}",
            f"{self.share:.3f}", f"{self.adapt_s:.0f}",
        ]  # fmt: skip


@dataclass(frozen=True)
class Kept:
    """One frequency of the plant as it is, with the floor, once the adaptation rests."""

    freq_Hz: float
    amp_pct: float
    accel_pct: float

    def row(self) -> list[str]:
        return [f"{self.freq_Hz:g}", f"{self.amp_pct:.2f}", f"{self.accel_pct:.2f}"]


def trace_of(rig: Rig, plant: Plant, freq_Hz: float, duration_s: float, *settings: str) -> Trace:
    control = rig.judged.control(DISPLACEMENT).with_settings(*settings)
    run = rig.run_once(steady(freq_Hz, duration_s), control, plant, COLUMNS)
    assert run.trace is not None
    return run.trace


def measure_cell(rig: Rig, variation: Variation, bounds: dict[str, float], freq_Hz: float) -> Cell:
    plant = varied_plant(rig, variation)
    open_um = rig.run(steady(freq_Hz, OPEN_s), OPEN_LOOP, plant).figures["amp_um"]
    trace = trace_of(rig, plant, freq_Hz, ADAPT_s)
    over_time = second_amplitudes(trace["t_s"], trace["x5_um"], freq_Hz)
    trying = np.flatnonzero(trace["adapt_state"] == TRYING)
    start_s = float(trace["t_s"][trying[0]]) if trying.size else 0.0
    return Cell(
        variation.label,
        freq_Hz,
        reduction_pct(float(over_time[-LAST_s:].mean()), open_um),
        bounds[f"{variation.label} {freq_Hz:g}"],
        max(0.0, converge_s(over_time, CONVERGED) - start_s),
    )


def measure_kept(rig: Rig, freq_Hz: float) -> Kept:
    base = rig.run(steady(freq_Hz, OPEN_s), OPEN_LOOP).figures
    trace = trace_of(rig, rig.plant, freq_Hz, FLOOR_s, f"phase_accel_floor_pct={FLOOR_pct:g}")
    resting = np.flatnonzero(trace["adapt_state"] == RESTING)
    end = int(resting[-1]) + 1 if resting.size else len(trace["t_s"])
    last = slice(end - int(np.searchsorted(trace["t_s"], LAST_s)), end)
    seconds = second_amplitudes(trace["t_s"][:end], trace["x5_um"][:end], freq_Hz)
    return Kept(
        freq_Hz,
        reduction_pct(float(seconds[-LAST_s:].mean()), base["amp_um"]),
        reduction_pct(float(np.std(trace["a5_mm_s2"][last])), base["accel_rms_mm_s2"]),
    )


def bounds_of(rig: Rig, variations: Sequence[Variation]) -> dict[str, float]:
    """Committed optimal control. UsageError where it is not known of one of them."""
    optima = load_optima([])
    found = {
        f"{one.label} {freq_Hz:g}": stored(optima, varied_plant(rig, one), freq_Hz).amp_pct
        for one in variations
        for freq_Hz in FREQS_Hz
    }
    lacking = [key for key, pct in found.items() if pct is None]
    if lacking:
        raise UsageError(f"no bound of {lacking[0]} in {FOLDER}; make it with {COMMAND}")
    return {key: pct for key, pct in found.items() if pct is not None}


def tables_of(cells: Sequence[Cell], kept: Sequence[Kept]) -> tuple[str, ...]:
    heads = ["plant", "Hz", "red. %", "bound %", "share", "adapted\ns"]
    least = sorted(cells, key=lambda cell: cell.share)[:8]
    slowest = sorted(cells, key=lambda cell: -cell.adapt_s)[:8]
    return (
        format_table(["least share: " + heads[0], *heads[1:]], [one.row() for one in least]),
        format_table(["slowest: " + heads[0], *heads[1:]], [one.row() for one in slowest]),
        format_table(
            [f"floor {FLOOR_pct:g} %\nHz", "red. %", "accel. red. %"], [one.row() for one in kept]
        ),
    )


def measure(effort: Effort) -> Measured:
    variations = corners(GOAL_VARIATIONS) if effort.is_quick else list(GOAL_VARIATIONS)
    with phase_rig(effort) as rig:
        bounds = bounds_of(rig, variations)
        cells: list[Cell] = rig.work(
            [
                (f"{one.label}: {freq_Hz:g} Hz", partial(measure_cell, rig, one, bounds, freq_Hz))
                for one in variations
                for freq_Hz in FREQS_Hz
            ]
        )
        floor_Hz = QUICK_FLOOR_Hz if effort.is_quick else FLOOR_Hz
        kept: list[Kept] = rig.work(
            [
                (f"floor: {freq_Hz:g} Hz", partial(measure_kept, rig, freq_Hz))
                for freq_Hz in floor_Hz
            ]
        )
    return Measured(
        values={
            "phase_least_share": min(cell.share for cell in cells),
            "phase_cells_below_09": float(sum(cell.share < LEAST_SHARE for cell in cells)),
            "phase_adapt_s": max(cell.adapt_s for cell in cells),
            "phase_accel_floor_worst_pct": max(0.0, FLOOR_pct - min(one.accel_pct for one in kept)),
        },
        reported={"cells": len(cells)},
        tables=tables_of(cells, kept),
    )
