"""The firmware's integers beside float64, on what the building's and the car's sensors say."""

import numpy as np
from quiesce.base.table import format_table
from quiesce.law.recipes import RECIPES
from quiesce.law.tables import Table

from quiesce_benchmarks.laws import rigs
from quiesce_benchmarks.laws.firmware_laws import demands
from quiesce_benchmarks.part import Effort, Measured

TITLE = "integers: every recipe beside float64"
FIGURES = (
    ("law_float_error_worst_pct", "%", 1.0, "lower"),
    ("law_float_flips_worst_pct", "%", None, "lower"),
)
TICKS, QUICK_TICKS = 60000, 10000
NEEDS_TWO_ENDS = ("groundhook", "groundhook_on_off", "mixed_hooks", "bilinear")
# So that a law covers its output's range.
LOUDNESS = {"acceleration": 10.0, "velocity": 0.3, "displacement": 0.02, "stroke": 0.02,
            "stroke velocity": 0.3, "force": 1000.0}  # fmt: skip


def signals(table: Table, ticks: int, seed: int) -> np.ndarray:
    """Three tones each and noise, as loud as an earthquake."""
    rng = np.random.default_rng(seed)
    t = np.arange(ticks)[:, None] / 1000.0
    loud = np.array([LOUDNESS[one.quantity.name] for one in table.signals()])
    tones = sum(
        rng.uniform(0.2, 0.5, len(loud))
        * np.sin(2 * np.pi * rng.uniform(0.5, 25, len(loud)) * t + rng.uniform(0, 6, len(loud)))
        for _ in range(3)
    )
    units = np.array([one.quantity.per_unit for one in table.signals()])
    exact = loud * (tones + 0.01 * rng.standard_normal((ticks, len(loud))))
    return np.rint(exact * units) / units


def errors_pct(table: Table, values: np.ndarray) -> tuple[float, float]:
    """Largest difference over the range that is covered, and how many ticks a decision differs in:
    a sign may change a tick earlier or later."""
    ours = demands(table, values)
    exact = table.forces_N(values) if table.demands == "force" else table.currents_A(values)
    size = np.ptp(exact)
    apart = np.abs(ours - exact).max(axis=1)
    decides = table.law in ("signs", "friction")
    flips = 100.0 * float(np.mean(apart > 0.01 * size)) if decides else 0.0
    left = apart[apart <= 0.01 * size] if decides else apart
    return 100.0 * float(left.max() / size), flips


def measure(effort: Effort) -> Measured:
    rows, worst, flips = [], 0.0, 0.0
    ticks = QUICK_TICKS if effort.is_quick else TICKS
    for recipe in RECIPES:
        rig = rigs.CAR if recipe.name in NEEDS_TWO_ENDS else rigs.BUILDING
        table = rigs.made(rig, recipe.name).table
        error, flipped = errors_pct(table, signals(table, ticks, effort.seed))
        worst, flips = max(worst, error), max(flips, flipped)
        rows.append([recipe.name, table.law, f"{error:.4f}", f"{flipped:.4f}"])
    found = format_table(["recipe", "law", "error, % of range", "decisions off, %"], rows, (0, 1))
    values: dict[str, float | None] = {
        "law_float_error_worst_pct": worst,
        "law_float_flips_worst_pct": flips,
    }
    return Measured(values, tables=(found,))
