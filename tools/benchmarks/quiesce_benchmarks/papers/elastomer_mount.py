"""The published elastomer and its mass of 5 kg in closed form (seed 003, eqs 25 to 31, Fig 6)."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Complexes = NDArray[np.complex128]
Floats = NDArray[np.float64]

RADII_mm = ((3.5, 12.7), (17.7, 21.5))  # of the two rings, eq 25
THICKNESS_m = 0.003
PUBLISHED_AREA_m2 = 9.36e-4
PUBLISHED_N_m = (3.37e5, 6.24e5)  # least and most, eq 29
RISE_MPa = (0.7649, -0.1391)  # per A, per A^2: eq 31
MASS_kg = 5.0


def area_m2() -> float:
    """Of both rings, eq 26."""
    return sum(math.pi * (outer**2 - inner**2) for inner, outer in RADII_mm) * 1e-6


def rise(current_A: float) -> float:
    """K(i), eq 31."""
    return RISE_MPa[0] * current_A + RISE_MPa[1] * current_A**2


def current_of_most_A(modulus_MPa: float) -> float:
    """Where the stiffness reaches the published most, eq 29."""
    wanted = PUBLISHED_N_m[1] * THICKNESS_m / area_m2() / 1e6 - modulus_MPa
    return (RISE_MPa[0] - math.sqrt(RISE_MPa[0] ** 2 + 4.0 * RISE_MPa[1] * wanted)) / (
        -2.0 * RISE_MPa[1]
    )


@dataclass(frozen=True)
class Bode:
    """A spring of loss-factor damping, d = loss k / w (eq 30), and the mass on it."""

    stiffness_N_m: float
    loss_factor: float

    @property
    def natural_Hz(self) -> float:
        return math.sqrt(self.stiffness_N_m / MASS_kg) / (2.0 * math.pi)

    def spring(self) -> complex:
        return self.stiffness_N_m * (1.0 + 1j * self.loss_factor)

    def receptance_m_N(self, freq_Hz: Floats) -> Complexes:
        """Displacement of the mass per force on it."""
        return 1.0 / (self.spring() - MASS_kg * (2.0 * np.pi * freq_Hz) ** 2)

    def transmissibility(self, freq_Hz: Floats) -> Complexes:
        """Displacement of the mass per that of its base, Fig 7."""
        return self.spring() * self.receptance_m_N(freq_Hz)
