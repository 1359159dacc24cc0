"""An inverse as the force map that the controller's tracker `inverse` reads, where it can be one:
its answer has to follow from force and velocity, mid-stroke, alone."""

from typing import Protocol, runtime_checkable

import numpy as np

from quiesce.damper.force_map import MAX_CURRENTS, map_words, why_no_map
from quiesce.damper.inverse import Monotone, SteadyForces
from quiesce.damper.inverses.demand import Inverse
from quiesce.damper.inverses.mapped import MapInverse
from quiesce.damper.learned.inputs import Box

_FORCES = 2001
# Of the largest speed of the training, from where the answer is not held any more.
_PARTS = (0.1, 0.15, 0.22, 0.32, 0.45, 0.65, 1.0)
# What methods that have a map say of themselves as TRACKER.
COMPILED = "tracker inverse reads its compiled map"


@runtime_checkable
class Steady(Protocol):
    """An inverse that answers a force that lasts in mid-stroke."""

    box: Box
    max_current_A: float

    def steady_A(self, force_N: np.ndarray, velocity_m_s: float) -> np.ndarray: ...


def compiled(inverse: Inverse) -> MapInverse | None:
    """None where there is none."""
    if not isinstance(inverse, Steady):
        return None
    found = steady_map(inverse)
    return None if why_no_map(found) else MapInverse(map_words(found))


def steady_map(inverse: Steady) -> Monotone:
    """At every velocity the force at which the inverse begins to ask for each current. Where it
    asks for less current for more force, the largest current so far stands."""
    box, index = inverse.box, inverse.box.keys.index
    force, velocity = index("force_N"), index("velocity_m_s")
    largest_N = float(np.abs([box.low[force], box.high[force]]).max())
    speed_m_s = float(min(-box.low[velocity], box.high[velocity]))
    velocities = speed_m_s * np.concatenate([-np.array(_PARTS)[::-1], _PARTS])
    currents_A = np.linspace(0.0, inverse.max_current_A, MAX_CURRENTS)
    wanted_N = np.linspace(0.0, largest_N, _FORCES)
    rows = []
    for one_m_s in velocities:
        asked = inverse.steady_A(np.sign(one_m_s) * wanted_N, float(one_m_s))
        rows.append(beginnings(np.maximum.accumulate(asked), wanted_N, currents_A))
    limits = np.full(len(velocities), inverse.max_current_A)
    steady = SteadyForces(velocities, currents_A, np.array(rows))
    return Monotone(inverse.max_current_A, limits, steady)


def beginnings(asked_A: np.ndarray, wanted_N: np.ndarray, currents_A: np.ndarray) -> np.ndarray:
    """The forces at which `asked_A` (not falling over `wanted_N`) passes each current; for 0 A the
    largest without any, for a current that is never asked for the largest of all."""
    above = np.searchsorted(asked_A, currents_A, side="left")
    above[0] = np.searchsorted(asked_A, 1e-3 * currents_A[-1], side="right")
    at = np.clip(above, 1, len(wanted_N) - 1)
    low, high = asked_A[at - 1], asked_A[at]
    part = np.where(high > low, (currents_A - low) / np.where(high > low, high - low, 1.0), 1.0)
    forces = wanted_N[at - 1] + np.clip(part, 0.0, 1.0) * (wanted_N[at] - wanted_N[at - 1])
    forces = np.where(above == 0, 0.0, np.where(above >= len(wanted_N), wanted_N[-1], forces))
    return np.maximum.accumulate(forces)
