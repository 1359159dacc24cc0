"""The best constant current of a plant under one excitation."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from quiesce.optimum.goal import Goal, reference
from quiesce.optimum.periodic import Drive, Orbit, solve

STEP_A = 0.25
REFINED_A = 1e-3


@dataclass(frozen=True)
class Constant:
    """A constant current and what it does."""

    current_A: float
    orbit: Orbit


def best_constant(drive: Drive, goal: Goal) -> Constant:
    """Tried in steps of 0.25 A (and full scale), then refined between the best one's neighbours."""
    ref = reference(drive)
    full_A = drive.plant.max_current_A

    def cost(current_A: float) -> float:
        return ref.cost(goal, solve(drive, current_A))

    tried = np.append(np.arange(0.0, full_A, STEP_A), full_A)
    costs = [cost(current_A) for current_A in tried]
    at = int(np.argmin(costs))
    around = (tried[max(at - 1, 0)], tried[min(at + 1, len(tried) - 1)])
    refined = minimize_scalar(cost, bounds=around, method="bounded", options={"xatol": REFINED_A})
    best_A = refined.x if refined.fun < costs[at] else tried[at]
    return Constant(float(best_A), solve(drive, best_A))
