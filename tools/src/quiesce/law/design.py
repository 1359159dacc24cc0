"""Gains from a structure's matrices: linear quadratic forces of a Kalman filter's state."""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from quiesce.law.block import System
from quiesce.law.structure import Structure


@dataclass(frozen=True)
class Weights:
    """Of squares in the index: each body's displacement and acceleration (absolute, without the
    ground's own), each damper's stroke and force. last_share: 0 all bodies alike, 1 the last one
    only."""

    displacement_1_m2: float
    drift_1_m2: float
    accel_s4_m2: float
    force_1_N2: float
    last_share: float


@dataclass(frozen=True)
class Noise:
    """Densities: of the ground's acceleration and of each accelerometer."""

    ground_m_s2: float
    accel_m_s2: float


def lqg(structure: Structure, weights: Weights, noise: Noise) -> System:
    """From the bodies' absolute accelerations and the dampers' forces, which count as known inputs,
    to the forces that resist growing strokes. ValueError where no gains exist."""
    a, b_force, b_ground = _state_space(structure)
    c, d = _accelerations(structure)
    try:
        gain = _regulator(structure, weights, a, b_force, c, d)
        observer = _kalman(structure, noise, a, b_ground, c)
    except np.linalg.LinAlgError:
        raise ValueError("no stabilising gains: are all modes seen by sensors and dampers?")
    count = len(structure.dampers)
    from_sensors = np.hstack([observer, b_force - observer @ d])
    return System(a - observer @ c, from_sensors, -gain, np.zeros((count, from_sensors.shape[1])))


def _state_space(s: Structure) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of (q, q'): what forces and the ground do."""
    n = len(s.mass)
    inverse = np.linalg.inv(s.mass)
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ s.stiffness, -inverse @ s.damping]])
    b_force = np.vstack([np.zeros((n, len(s.dampers))), -inverse @ s.dampers.T])
    b_ground = np.concatenate([np.zeros(n), -s.base])[:, None]
    return a, b_force, b_ground


def _accelerations(s: Structure) -> tuple[np.ndarray, np.ndarray]:
    """Absolute ones of the bodies: the ground's own cancels in M (q'' + base a_g)."""
    inverse = np.linalg.inv(s.mass)
    c = s.bodies @ np.hstack([-inverse @ s.stiffness, -inverse @ s.damping])
    return c, s.bodies @ (-inverse @ s.dampers.T)


def _regulator(
    s: Structure, w: Weights, a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray
) -> np.ndarray:
    n = len(s.mass)
    share = np.full(len(s.bodies), 1.0 - w.last_share)
    share[-1] = 1.0
    places = np.hstack([s.bodies, np.zeros((len(s.bodies), n))])
    strokes = np.hstack([s.dampers, np.zeros((len(s.dampers), n))])
    weighted = share[:, None] * c
    q = w.accel_s4_m2 * c.T @ weighted
    q += w.displacement_1_m2 * places.T @ (share[:, None] * places)
    q += w.drift_1_m2 * strokes.T @ strokes
    r = w.force_1_N2 * np.eye(b.shape[1]) + w.accel_s4_m2 * d.T @ (share[:, None] * d)
    cross = w.accel_s4_m2 * weighted.T @ d
    riccati = scipy.linalg.solve_continuous_are(a, b, q, r, s=cross)
    return np.linalg.solve(r, b.T @ riccati + cross.T)


def _kalman(
    s: Structure, noise: Noise, a: np.ndarray, b_ground: np.ndarray, c: np.ndarray
) -> np.ndarray:
    ground = noise.ground_m_s2**2 * b_ground @ b_ground.T
    sensors = noise.accel_m_s2**2 * np.eye(len(s.bodies))
    covariance = scipy.linalg.solve_continuous_are(a.T, c.T, ground, sensors)
    return covariance @ c.T @ np.linalg.inv(sensors)
