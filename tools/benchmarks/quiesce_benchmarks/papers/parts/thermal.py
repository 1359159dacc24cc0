"""Support vectors that know the fluid's temperature, in closed loop while the damper warms up.

Review of MR damper models, 3.2.3 and Fig 7: no equation, no number is printed, only that it does
better than a model without. Here both learn from the same rows of the same tests at five
temperatures, one without that column, and make the current of the same force tracker on the same
plant, from cold to steadily hot.
"""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from quiesce.base.table import format_table
from quiesce.damper.inverses.support_vector import train
from quiesce.damper.library import Scales

from quiesce_benchmarks.papers.thermal_loop import (
    COLD_C,
    CONDUCTANCE_W_K,
    TICK_RATE_HZ,
    error_of,
    rig_records,
    road,
    run,
    whole,
    write_plant,
)
from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.seeds import generator

TITLE = "a damper that warms up, tracked by support vectors with and without its temperature"
FIGURES = (("thermal_closed_loop", "-", 1.0, "lower"),)
TEMPERATURES_C = [15.0, 35.0, 55.0, 75.0, 95.0]
# A damper of 0.8 kg has some 500 J/K and takes half an hour: the force follows the temperature at
# once, so that a fiftieth of that shows the same warm-up in less time.
HEAT_CAPACITY_J_K = 10.0
QUARTERS = 4
KNOWING, BLIND = "with temperature", "without"


def trial(seed: int, seconds: float) -> dict[str, Any]:
    """One warm-up with each model; every draw of chance is of this seed."""
    segments = whole(rig_records(generator(seed, "thermal", "rig"), TEMPERATURES_C))
    scales = Scales.of(segments)
    base_m_s2 = road(generator(seed, "thermal", "road"), seconds)
    rows = [slice(k * len(base_m_s2) // QUARTERS, (k + 1) * len(base_m_s2) // QUARTERS)
            for k in range(QUARTERS)]  # fmt: skip
    out: dict[str, Any] = {"seed": seed}
    with tempfile.TemporaryDirectory() as folder:
        plant = write_plant(Path(folder), HEAT_CAPACITY_J_K)
        for name in (KNOWING, BLIND):
            model = train(segments, scales, seed, with_temperature=name == KNOWING)
            loop = run(plant, base_m_s2, model.current_A, generator(seed, "thermal", "noise"))
            out[name] = {
                "error": error_of(loop),
                "quarters": [error_of(loop, each) for each in rows],
                "end_C": float(np.mean(loop.fluid_C[rows[-1]])),
                "accel_rms_m_s2": float(np.sqrt(np.mean(loop.accel_m_s2**2))),
                "vectors": len(model.coefficients),
            }
    return out


def ratio(one: dict[str, Any], quarter: int | None = None) -> float:
    parts = [
        one[name]["error"] if quarter is None else one[name]["quarters"][quarter]
        for name in (KNOWING, BLIND)
    ]
    return parts[0] / parts[1]


def table(trials: list[dict[str, Any]]) -> str:
    head = ["seed", "error with T %", "without %", "ratio", "coldest quarter", "hottest", "end C"]
    rows = [
        [
            str(one["seed"]),
            *(f"{100.0 * one[name]['error']:.1f}" for name in (KNOWING, BLIND)),
            f"{ratio(one):.3f}",
            f"{ratio(one, 0):.3f}",
            f"{ratio(one, QUARTERS - 1):.3f}",
            f"{one[KNOWING]['end_C']:.0f}",
        ]
        for one in trials
    ]
    return format_table(head, rows, left=())


def measure(effort: Effort) -> Measured:
    seconds = 30.0 if effort.is_quick else 80.0
    count = 1 if effort.is_quick else 5
    trials = [trial(effort.seed + 100 * k, seconds) for k in range(count)]
    ratios = [ratio(one) for one in trials]
    value = float(np.mean(ratios))
    reported = {
        "ratio": value,
        "worst_ratio": max(ratios),
        "best_ratio": min(ratios),
        "error_with_pct": 100.0 * float(np.mean([one[KNOWING]["error"] for one in trials])),
        "error_without_pct": 100.0 * float(np.mean([one[BLIND]["error"] for one in trials])),
        "cold_C": COLD_C,
        "end_C": float(np.mean([one[KNOWING]["end_C"] for one in trials])),
        "seconds": seconds,
        "tick_rate_Hz": TICK_RATE_HZ,
        "heat_capacity_J_K": HEAT_CAPACITY_J_K,
        "conductance_W_K": CONDUCTANCE_W_K,
        "trials": trials,
    }
    return Measured({"thermal_closed_loop": value}, reported, (table(trials),))
