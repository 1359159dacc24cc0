"""Inverse by steps of the current: at every sample the current moves by the part of the way that a
forward model's force is short of the wanted one.

Source: review of MR damper models, eq 35, with the check of the sign that it lacks (judged in
demand.py) and without its division by zero. The model runs at several constant currents side by
side, each with its own state, and its force at the present current is interpolated.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import tomli_w

from quiesce.damper.data.record import Record
from quiesce.damper.inverse import forces_by
from quiesce.damper.inverses.demand import Source
from quiesce.damper.inverses.keys import number, table_of
from quiesce.damper.learned.model import Report, silent
from quiesce.damper.model_file import DamperModel, model_of_text
from quiesce.damper.simulate import simulator

NAME = "steps"
TITLE = "steps of the current (eq 35)"
HELP = "moves the current by the part of the force that is missing (a damper file in the loop)"
TRACKER = "has no tracker; its rest is tracker inverse with the same model's map"
CURRENTS = 11
TOLERANCE = 0.01  # of the largest force of the tests


@dataclass(frozen=True)
class SteppedInverse:
    damper: DamperModel
    tolerance_N: float
    max_current_A: float

    def currents(self, demand: Record) -> np.ndarray:
        simulate = None if self.damper.is_kernel else simulator(self.damper)
        grid_A = np.linspace(0.0, self.max_current_A, CURRENTS)
        side = np.sign(demand.velocity_m_s)
        along = side * forces_by(self.damper, simulate)(demand, grid_A)
        out = np.empty(len(demand))
        current_A = 0.0
        for k, wanted_N in enumerate(side * demand.force_N):
            column = along[:, k]
            now_N = float(np.interp(current_A, grid_A, column))
            current_A = stepped_current(
                current_A, wanted_N, now_N, column[0], column[-1], self.max_current_A,
                self.tolerance_N,
            )  # fmt: skip
            out[k] = current_A
        return out

    def parameters(self) -> dict[str, Any]:
        import tomllib

        return {
            "tolerance_N": self.tolerance_N,
            "damper": tomllib.loads(self.damper.to_toml()),
        }


def stepped_current(
    current_A: float,
    wanted_N: float,
    force_N: float,
    weakest_N: float,
    strongest_N: float,
    most_A: float,
    tolerance_N: float,
) -> float:
    """The next current, within 0 .. most_A, from forces along the motion (> 0 resists): a forward
    model's now and at both ends. Kept within the tolerance; raised or lowered by the part of the
    way that is missing."""
    missing_N = wanted_N - force_N
    if abs(missing_N) <= tolerance_N:
        return current_A
    if missing_N > 0.0:
        reach_N = strongest_N - force_N
        part = 1.0 if reach_N <= 0.0 else min(missing_N / reach_N, 1.0)
        return current_A + part * (most_A - current_A)
    reach_N = force_N - weakest_N
    part = 1.0 if reach_N <= 0.0 else min(-missing_N / reach_N, 1.0)
    return current_A - part * current_A


def read(keys: Mapping[str, Any], max_current_A: float, where: str) -> SteppedInverse:
    damper = model_of_text(tomli_w.dumps(table_of(keys, "damper", where)), f"{where}: damper")
    return SteppedInverse(damper, number(keys, "tolerance_N", where), max_current_A)


def make(source: Source, seed: int = 0, progress: Report = silent) -> SteppedInverse:
    """The seed is not used: nothing is drawn."""
    damper = source.model_for(NAME)
    largest_N = max(float(np.abs(one.record.force_N[one.rows]).max()) for one in source.segments)
    tolerance_N = max(TOLERANCE * largest_N, 1e-9)
    progress(f"steps: within {tolerance_N:.3g} N the current stays")
    return SteppedInverse(damper, tolerance_N, source.max_current_A)
