"""What a search makes small: the mean over all steady states of what vibration and current remain.

Of every steady state, in percent: displacement amplitude and RMS acceleration left of what they are
at 0 A, and the mean current of the largest. A weight of 0 leaves a part out. One cost is the
weighted mean of the three; a search over several objectives takes the parts that have a weight.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.rules.optimize.search import Costs

PARTS = ("displacement", "acceleration", "current")
OBJECTIVES = {
    "balanced": (1.0, 1.0, 0.0),
    "displacement": (1.0, 0.0, 0.0),
    "acceleration": (0.0, 1.0, 0.0),
    "thrifty": (1.0, 1.0, 0.2),
}


@dataclass(frozen=True)
class Steady:
    """One steady state of one run; reductions against 0 A with the same excitation."""

    amp_reduction_pct: float
    accel_rms_reduction_pct: float
    mean_current_A: float


Outcome = tuple[Steady, ...]  # of every steady state of every scenario, in their order


@dataclass(frozen=True)
class Objective:
    weights: tuple[float, float, float]  # of PARTS
    max_current_A: float

    @property
    def names(self) -> list[str]:
        return [name for name, weight in zip(PARTS, self.weights, strict=True) if weight > 0]

    def parts(self, outcome: Sequence[Steady]) -> np.ndarray:
        """The three parts, each the mean over all steady states, in %."""
        return np.mean([self.parts_of(steady) for steady in outcome], axis=0)

    def parts_of(self, steady: Steady) -> tuple[float, float, float]:
        return (
            100.0 - steady.amp_reduction_pct,
            100.0 - steady.accel_rms_reduction_pct,
            100.0 * steady.mean_current_A / self.max_current_A,
        )

    def cost(self, outcome: Sequence[Steady]) -> float:
        """Weighted mean of the parts, in %."""
        return float(np.dot(self.weights, self.parts(outcome)) / sum(self.weights))

    def single(self, outcomes: Sequence[Outcome]) -> Costs:
        return np.array([[self.cost(outcome)] for outcome in outcomes])

    def several(self, outcomes: Sequence[Outcome]) -> Costs:
        chosen = [weight > 0 for weight in self.weights]
        return np.array([self.parts(outcome)[chosen] for outcome in outcomes])


def parse_weights(objective: str, assignments: Sequence[str]) -> tuple[float, float, float]:
    """Weights of a named objective, with single ones replaced by NAME=VALUE."""
    weights = dict(zip(PARTS, OBJECTIVES[objective], strict=True))
    for assignment in assignments:
        name, _, text = assignment.partition("=")
        try:
            value = float(text)
        except ValueError:
            value = -1.0
        if name not in weights or not 0.0 <= value <= 1e6:
            raise UsageError(
                f"--weight {assignment}: expected NAME=VALUE, a name of {', '.join(PARTS)} and a "
                "value in 0 .. 1000000"
            )
        weights[name] = value
    if not any(weights.values()):
        raise UsageError("--weight: all weights are 0; at least one must be positive")
    return weights["displacement"], weights["acceleration"], weights["current"]
