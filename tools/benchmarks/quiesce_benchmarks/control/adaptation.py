"""How the adaptation goes on over time, from a cold start."""

from dataclasses import dataclass

import numpy as np
from quiesce.engine.trace import Trace

from quiesce_benchmarks.control.measures import second_amplitudes
from quiesce_benchmarks.control.rig import OPEN_LOOP, Rig
from quiesce_benchmarks.control.safety import TRIM_COLUMNS
from quiesce_benchmarks.control.scenarios import steady
from quiesce_benchmarks.control.steady import TRACE_COLUMNS, SHIPPED_s
from quiesce_benchmarks.control.variants import Variation, goal_variation, varied_plant

# The plant as it is, and the two that are farthest from what the table was made for.
SHOWN = (
    Variation("the plant as it is"),
    goal_variation(0.010, 0.7, 0.12, 1.0),
    goal_variation(0.002, 1.5, 0.09, 1.0),
)
FREQ_Hz = 5.0
SETTING = "displacement"


@dataclass(frozen=True)
class Trajectory:
    label: str
    amp_pct: np.ndarray  # reduction in each second
    trims: Trace  # t_s and TRIM_COLUMNS; empty where the law does not adapt


def measure_trajectory(rig: Rig, variation: Variation, duration_s: float) -> Trajectory:
    plant = varied_plant(rig, variation)
    scenario = steady(FREQ_Hz, duration_s)
    columns = (*TRACE_COLUMNS, *(TRIM_COLUMNS if rig.judged.adapts else ()))
    run = rig.run(scenario, rig.judged.control(SETTING), plant, columns)
    base_um = rig.run(steady(FREQ_Hz, SHIPPED_s), OPEN_LOOP, plant).figures["amp_um"]
    assert run.trace is not None
    peaks_um = second_amplitudes(run.trace["t_s"], run.trace["x5_um"], FREQ_Hz)
    thinned = {
        name: values[::100]
        for name, values in run.trace.items()
        if name == "t_s" or name in TRIM_COLUMNS
    }
    return Trajectory(
        variation.label,
        100.0 * (1.0 - peaks_um / base_um),
        thinned if rig.judged.adapts else {},
    )
