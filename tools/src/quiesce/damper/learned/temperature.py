"""How a damper's force falls as its fluid warms up, to make data for models with temperature.

Viscosity follows Arrhenius' law, the yield stress falls slowly and linearly. Source: a common
reading of Shi's model, which prints neither equation nor numbers.
"""

from dataclasses import dataclass, replace

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.data.record import Record

ZERO_C_IN_K = 273.15


@dataclass(frozen=True)
class ThermalFactors:
    """Factors are 1 at reference_C."""

    activation_K: float = 2000.0  # b_T of c = c0 exp(b_T (1/T - 1/T0)), T in K
    yield_1_K: float = 2e-3  # a_T of fy = fy0 (1 - a_T (T - T0))
    reference_C: float = 25.0

    def viscous(self, temperature_C: np.ndarray) -> np.ndarray:
        kelvin = np.asarray(temperature_C, float) + ZERO_C_IN_K
        if np.any(kelvin <= 0.0):
            raise UsageError("a temperature below -273.15 C; state temperatures in degrees Celsius")
        return np.exp(self.activation_K * (1.0 / kelvin - 1.0 / (self.reference_C + ZERO_C_IN_K)))

    def yielding(self, temperature_C: np.ndarray) -> np.ndarray:
        """Never below 0."""
        rise_K = np.asarray(temperature_C, float) - self.reference_C
        return np.maximum(1.0 - self.yield_1_K * rise_K, 0.0)


def warmed(
    record: Record,
    viscous_N: np.ndarray,
    yield_N: np.ndarray,
    temperature_C: np.ndarray,
    factors: ThermalFactors,
) -> Record:
    """The record with the force of a damper at this temperature; viscous_N and yield_N are the two
    parts of the force at factors.reference_C."""
    force_N = viscous_N * factors.viscous(temperature_C) + yield_N * factors.yielding(temperature_C)
    return replace(record, force_N=force_N, temperature_C=np.asarray(temperature_C, float))
