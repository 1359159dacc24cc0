"""Whether a damper model can give out energy that was not put in.

Two answers: a proof from the parameters where the model has one (its kernel's is_passive at every
current), else a trial: from rest, along random motions of the data's size at constant currents, the
energy taken in, int F v dt, must never fall below zero. The trial can refute, not prove. Offsets,
drifts and the rig are left out: a constant force stores and returns.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.library import Scales

# Energy below zero that counts as rounding and discretisation: part of the largest taken in.
_TOLERANCE = 2e-3
_MOTIONS = 6
_SAMPLES = 4000


@dataclass(frozen=True)
class Passivity:
    is_proved: bool
    worst: float  # least energy over the largest, in the trial; >= -_TOLERANCE passes

    @property
    def holds(self) -> bool:
        return self.is_proved or self.worst >= -_TOLERANCE

    @property
    def text(self) -> str:
        if self.is_proved:
            return "yes"
        return "in trials" if self.holds else "no"


def is_proved(
    one: library.Model, orders: Sequence[int], row: np.ndarray, currents_A: Sequence[float]
) -> bool:
    """The kernel's own criterion at these currents; a mass around it must not be negative."""
    mass = row[len(row) - len(library.RIG) + library.RIG.index("inertia_kg")]
    return mass >= 0.0 and all(
        library.module().is_passive(one.name, library.values_at(one, orders, row, current_A))
        for current_A in np.linspace(min(currents_A), max(currents_A), 9)
    )


def random_motion(rng: np.random.Generator, scales: Scales, current_A: float) -> Record:
    """Band-limited, of the data's stroke and speed, that starts from rest at 0."""
    base_Hz = scales.speed_m_s / (2.0 * np.pi * scales.disp_m)
    rate_Hz = 400.0 * base_Hz
    time_s = np.arange(_SAMPLES) / rate_Hz
    freqs_Hz = base_Hz * rng.uniform(0.1, 2.0, 8)
    phases = rng.uniform(0.0, 2.0 * np.pi, 8)
    angle = 2.0 * np.pi * freqs_Hz[:, None] * time_s + phases[:, None]
    sizes = rng.uniform(0.2, 1.0, 8)[:, None] / freqs_Hz[:, None]
    ramp = time_s / time_s[-1] * 8.0
    rise = np.where(ramp < 1.0, ramp**3 * (10.0 - 15.0 * ramp + 6.0 * ramp**2), 1.0)
    disp = rise * np.sum(sizes * np.sin(angle), axis=0)
    disp *= scales.disp_m / np.max(np.abs(disp))
    velocity = np.gradient(disp, time_s, edge_order=2)
    accel = np.gradient(velocity, time_s, edge_order=2)
    zero = np.zeros(_SAMPLES)
    return Record(
        "random motion", rate_Hz, time_s, disp, velocity, accel, zero, zero + current_A, "A"
    )


def trial(
    simulate: Callable[[Record], np.ndarray],
    scales: Scales,
    currents_A: Sequence[float],
    seed: int = 1,
) -> float:
    """Least energy over the largest, of all motions and currents. simulate: force in N without
    offset and rig."""
    rng = np.random.default_rng(seed)
    worst = 0.0
    for _ in range(_MOTIONS):
        for current_A in sorted(set(currents_A)):
            record = random_motion(rng, scales, current_A)
            power = simulate(record) * record.velocity_m_s
            if not np.isfinite(power).all():
                return -np.inf
            energy = np.cumsum(0.5 * (power[1:] + power[:-1])) / record.rate_Hz
            worst = min(worst, float(energy.min()) / max(float(energy.max()), 1e-12))
    return worst
