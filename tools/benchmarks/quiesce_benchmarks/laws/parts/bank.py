"""Tracker `bank`: banks of models fitted to damper files with hysteresis, in the loop with the
firmware's own tracker, beside the map of tracker `inverse` and the ideal inverse."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from quiesce.base.paths import root
from quiesce.base.table import format_table
from quiesce.damper.data.record import Record
from quiesce.damper.inverses import banked, mapped
from quiesce.damper.inverses.banked import BankInverse
from quiesce.damper.inverses.demand import Source, judged
from quiesce.damper.inverses.tracking import CONSTANT, IDEAL, compare, tasks_for
from quiesce.damper.simulate import simulator_of_file
from quiesce.law.forms.network import DEMAND
from quiesce.law.signal import BY_NAME

from quiesce_benchmarks.laws.firmware_laws import Tracker
from quiesce_benchmarks.part import Effort, Measured

TITLE = "bank: models with memory in the loop with their dampers"
FIGURES = (
    ("bank_float_error_pct", "%", 1.0, "lower"),
    ("bank_float_flips_pct", "%", None, "lower"),
    ("bank_better_than_map_of", "dampers", None, "higher"),
    ("bank_over_map", "error over the map's, worst damper", None, "lower"),
    ("bank_tracking_error_pct", "%", None, "lower"),
    ("bank_map_tracking_error_pct", "%", None, "lower"),
    ("bank_ideal_tracking_error_pct", "%", None, "lower"),
    ("bank_fit_error_pct", "%", None, "lower"),
)
# The largest command, A, or V where that is what a file's "current" is.
DAMPERS = {
    "spencer_prototype": 2.25,
    "rd1005_kwok_bouc_wen_soft": 1.5,
    "rd1005_kwok_tanh_smooth": 1.8,
    "utfsm_network": 1.0,
    "seat_damper": 2.25,
}
QUICK = ("spencer_prototype", "rd1005_kwok_bouc_wen_soft")
SECONDS, QUICK_SECONDS = 8.0, 3.0
INPUTS = (DEMAND, BY_NAME["stroke"], BY_NAME["stroke velocity"])
FLIP = 0.01  # of the range: further apart it is another decision


@dataclass(frozen=True)
class InFirmware:
    """A bank as the controller's own tracker works it off."""

    inverse: BankInverse

    @property
    def max_current_A(self) -> float:
        return self.inverse.max_current_A

    def currents(self, demand: Record) -> np.ndarray:
        values = np.column_stack([demand.force_N, demand.disp_m, demand.velocity_m_s])
        return Tracker(self.inverse.words, INPUTS).currents_A(values)

    def parameters(self) -> dict[str, Any]:
        return self.inverse.parameters()


@dataclass(frozen=True)
class Tracked:
    damper: str
    fit_error_pct: float  # of the worst model
    error_pct: dict[str, float]
    float_error_pct: float
    float_flips_pct: float


def apart_pct(inverse: BankInverse, demands: list[Record]) -> tuple[float, float]:
    """Largest difference of integers from float64 over the range that is covered, but where another
    decision is made, and how many ticks those are."""
    ours = np.concatenate([InFirmware(inverse).currents(one) for one in demands])
    exact = np.concatenate([inverse.currents(one) for one in demands])
    parts = np.abs(ours - exact) / np.ptp(exact)
    flips = parts > FLIP
    return 100.0 * float(parts[~flips].max()), 100.0 * float(flips.mean())


def tracked(damper: str, most_A: float, seed: int, seconds: float) -> Tracked:
    model, simulate = simulator_of_file(root() / f"sim_hil/data/dampers/{damper}.toml")
    source = Source([], most_A, model)
    bank = banked.make(source, seed)
    inverses = {"bank": InFirmware(bank), "map": mapped.make(source)}
    found = compare(model, simulate, inverses, most_A, seed, seconds)
    tasks = [judged(one.demand) for one in tasks_for(model, simulate, most_A, seed, seconds)]
    error, flips = apart_pct(bank, tasks)
    return Tracked(damper, max(bank.fit_error_pct), found.errors_pct(), error, flips)


def measure(effort: Effort) -> Measured:
    dampers = QUICK if effort.is_quick else tuple(DAMPERS)
    seconds = QUICK_SECONDS if effort.is_quick else SECONDS
    found = [tracked(one, DAMPERS[one], effort.seed, seconds) for one in dampers]

    def worst(name: str) -> float:
        return max(one.error_pct[name] for one in found)

    values: dict[str, float | None] = {
        "bank_float_error_pct": max(one.float_error_pct for one in found),
        "bank_float_flips_pct": max(one.float_flips_pct for one in found),
        "bank_better_than_map_of": float(
            sum(one.error_pct["bank"] < one.error_pct["map"] for one in found)
        ),
        "bank_over_map": max(one.error_pct["bank"] / one.error_pct["map"] for one in found),
        "bank_tracking_error_pct": worst("bank"),
        "bank_map_tracking_error_pct": worst("map"),
        "bank_ideal_tracking_error_pct": worst(IDEAL),
        "bank_fit_error_pct": max(one.fit_error_pct for one in found),
    }
    reported = {one.damper: one.error_pct for one in found}
    return Measured(values, {"bank": reported}, (table(found),))


def table(found: list[Tracked]) -> str:
    names = ("bank", "map", IDEAL, CONSTANT)
    rows = [
        [
            one.damper,
            *(f"{one.error_pct[name]:.1f}" for name in names),
            f"{one.fit_error_pct:.1f}",
            f"{one.float_error_pct:.3f}",
        ]
        for one in found
    ]
    head = ["force error, %", *names, "worst model's fit", "integers, % of range"]
    return format_table(head, rows)
