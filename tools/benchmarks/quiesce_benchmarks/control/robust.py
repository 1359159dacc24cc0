"""Plants that are not the one that the table was made for, without retuning."""

import itertools
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from quiesce_benchmarks.control.measures import (
    converge_s,
    dither_loss_pct,
    fraction_of,
    reduction_pct,
    second_amplitudes,
)
from quiesce_benchmarks.control.rig import DISPLACEMENT, OPEN_LOOP, Rig, constant, grid_A
from quiesce_benchmarks.control.ruler import Ruler
from quiesce_benchmarks.control.scenarios import steady
from quiesce_benchmarks.control.steady import TRACE_COLUMNS, SHIPPED_s
from quiesce_benchmarks.control.variants import Variation, goal_variation, varied_plant

FREQS_Hz = (5.0, 10.0, 15.0, 20.0)
LAGS_s = (0.002, 0.005, 0.010)
FORCES = (0.7, 1.0, 1.5)
DRIVES_V = (0.09, 0.12)
STRUCTURES = (0.9, 1.0, 1.1)
GRID_STEP_A = 0.5

GOAL_VARIATIONS = tuple(
    goal_variation(*values) for values in itertools.product(LAGS_s, FORCES, DRIVES_V, STRUCTURES)
)


@dataclass(frozen=True)
class Cell:
    """One plant at one frequency. Reductions against its own 0 A, in the last 2 s."""

    variation: Variation
    freq_Hz: float
    amp_pct: float
    accel_pct: float
    mean_current_A: float
    shipped_amp_pct: float  # the table without adaptation
    constant_A: float  # best constant current for displacement
    constant_amp_pct: float
    bound_amp_pct: float | None
    converge_s: float
    dither_loss_pct: float

    @property
    def fraction(self) -> float | None:
        if self.bound_amp_pct is None:
            return None
        return fraction_of(self.amp_pct, self.bound_amp_pct)

    @property
    def below_constant_pts(self) -> float:
        return self.constant_amp_pct - self.amp_pct

    def row(self) -> dict[str, Any]:
        return {
            **asdict(self),
            "fraction": self.fraction,
            "below_constant_pts": self.below_constant_pts,
        }


def measure_cell(
    rig: Rig, ruler: Ruler, variation: Variation, freq_Hz: float, duration_s: float, step_A: float
) -> Cell:
    plant = varied_plant(rig, variation)
    short, long = steady(freq_Hz, SHIPPED_s), steady(freq_Hz, duration_s)
    base = rig.run(short, OPEN_LOOP, plant).figures

    def amp_pct(figures: dict[str, Any]) -> float:
        return reduction_pct(figures["amp_um"], base["amp_um"])

    constants = {
        current_A: amp_pct(rig.run(short, constant(current_A), plant).figures)
        for current_A in grid_A(rig.full_A, step_A)
    }
    best_A = max(constants, key=lambda current_A: constants[current_A])
    control = rig.judged.control(DISPLACEMENT)
    run = rig.run_once(long, control, plant, TRACE_COLUMNS)
    shipped = rig.run(short, rig.judged.control(DISPLACEMENT, "off"), plant)
    assert run.trace is not None
    over_time = second_amplitudes(run.trace["t_s"], run.trace["x5_um"], freq_Hz)
    reached = amp_pct(run.figures)
    found = max(reached, amp_pct(shipped.figures), constants[best_A])
    return Cell(
        variation=variation,
        freq_Hz=freq_Hz,
        amp_pct=reached,
        accel_pct=reduction_pct(run.figures["accel_rms_mm_s2"], base["accel_rms_mm_s2"]),
        mean_current_A=run.figures["mean_current_A"],
        shipped_amp_pct=amp_pct(shipped.figures),
        constant_A=best_A,
        constant_amp_pct=constants[best_A],
        bound_amp_pct=ruler.amp_pct_of(plant, freq_Hz, found),
        converge_s=converge_s(over_time),
        dither_loss_pct=dither_loss_pct(over_time, base["amp_um"]),
    )


def corners(variations: Sequence[Variation]) -> list[Variation]:
    """The extremes of every quantity, each with the others at both ends."""
    return [
        one
        for one in variations
        if one.variant.rise_s in (LAGS_s[0], LAGS_s[-1])
        and one.variant.force in (FORCES[0], FORCES[-1])
        and one.variant.freq in (STRUCTURES[0], STRUCTURES[-1])
    ]
