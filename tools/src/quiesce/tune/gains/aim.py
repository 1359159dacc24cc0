"""What a tuning minimises: one number from all records."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from quiesce.compare.figures import Figures
from quiesce.tune.gains.defaults import INDEX, WORST_WEIGHT

Runs = Mapping[str, Figures]  # by record, means over seeds; INDEX among the figures


@dataclass(frozen=True)
class Aim:
    """(mean + weight x worst) / (1 + weight) of a figure over the records."""

    figure: str = INDEX
    worst_weight: float = WORST_WEIGHT

    def cost(self, runs: Runs) -> float:
        return self.of([one[self.figure] for one in runs.values()])

    def of(self, values: list[float]) -> float:
        return (float(np.mean(values)) + self.worst_weight * max(values)) / (1 + self.worst_weight)

    @property
    def text(self) -> str:
        """As pages say it."""
        if self.worst_weight == 0:
            return f"mean {self.figure}"
        return (
            f"(mean + {self.worst_weight:g} x worst) / {1 + self.worst_weight:g} of {self.figure}"
        )
