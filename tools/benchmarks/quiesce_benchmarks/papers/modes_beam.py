"""The stated cantilever as finite elements: which sign its second shape has at the tip.

Shaft 300 x 30 x 2 mm and disc of 50 x 5 mm, aluminium (seed paper, IV.A): Euler-Bernoulli beam
elements, the disc a mass with rotary inertia at the end.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

Floats = NDArray[np.float64]

LENGTH_m, WIDTH_m, THICKNESS_m = 0.300, 0.030, 0.002
DISC_RADIUS_m, DISC_THICKNESS_m = 0.025, 0.005
MODULUS_Pa, DENSITY_kg_m3 = 68.9e9, 2700.0  # aluminium 6061
ELEMENTS_A_NODE = 4


def element(length_m: float) -> tuple[Floats, Floats]:
    """Stiffness and consistent mass [4 x 4] of deflection and slope at both ends."""
    bending = MODULUS_Pa * WIDTH_m * THICKNESS_m**3 / 12.0
    mass_kg = DENSITY_kg_m3 * WIDTH_m * THICKNESS_m * length_m
    scale = np.diag([1.0, length_m, 1.0, length_m])
    stiffness = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]])
    mass = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]])
    return (
        scale @ stiffness @ scale * bending / length_m**3,
        scale @ mass @ scale * mass_kg / 420.0,
    )


def modes(nodes: int, count: int) -> tuple[Floats, Floats]:
    """Frequencies [count], Hz, and mass-normalised shapes [nodes x count], kg^-1/2, of nodes at
    equal distances from the clamp to the tip, which is the last."""
    elements = nodes * ELEMENTS_A_NODE
    stiffness, mass = element(LENGTH_m / elements)
    size = 2 * (elements + 1)
    K, M = np.zeros((size, size)), np.zeros((size, size))
    for at in range(0, size - 2, 2):
        K[at : at + 4, at : at + 4] += stiffness
        M[at : at + 4, at : at + 4] += mass
    disc_kg = DENSITY_kg_m3 * np.pi * DISC_RADIUS_m**2 * DISC_THICKNESS_m
    M[-2, -2] += disc_kg
    M[-1, -1] += disc_kg * DISC_RADIUS_m**2 / 4.0
    free = slice(2, size)  # clamped at its first node
    omega2, shapes = eigh(K[free, free], M[free, free], subset_by_index=(0, count - 1))
    at_nodes = shapes[2 * ELEMENTS_A_NODE - 2 :: 2 * ELEMENTS_A_NODE]
    signs = np.sign(at_nodes[0])
    return np.sqrt(omega2) / (2.0 * np.pi), at_nodes * signs
