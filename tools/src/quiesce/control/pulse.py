"""One pulse of current for each half period of the vibration: how to shape it best.

Inside optimisation a pulse has a phase of the excitation, theta; the tables hold phases of the
displacement's fundamental, psi = theta + its phase.
"""

from dataclasses import dataclass

import numpy as np

from quiesce.control.descent import Optimum, improve
from quiesce.control.goal import Goal, Reference
from quiesce.control.periodic import Drive, Floats, Orbit, solve
from quiesce.errors import UsageError

INTERVALS = 120


@dataclass(frozen=True)
class Pulse:
    """level_A within width_deg around centre_deg (modulo 180), else floor_A."""

    centre_deg: float
    width_deg: float
    level_A: float
    floor_A: float

    def moved(self, by_deg: float) -> "Pulse":
        return Pulse((self.centre_deg + by_deg) % 180.0, self.width_deg, self.level_A, self.floor_A)


class PulseShape:
    """Parameters: centre and width in half turns, level and floor in parts of full current.

    An interval that an edge divides gets the mean of level and floor over it.
    """

    low = np.array([-10.0, 0.0, 0.0, 0.0])
    high = np.array([10.0, 1.0, 1.0, 1.0])

    def __init__(self, count: int = INTERVALS) -> None:
        self._edges = np.arange(count + 1) / count
        self._count = count

    def covered(self, parameters: Floats) -> Floats:
        """[n] part of each interval that is inside the pulse."""
        centre, width = parameters[:2]
        start = centre - 0.5 * width
        # Length of the pulse between 0 and each edge, counted over all its repetitions.
        turns, part = np.divmod(self._edges - start, 1.0)
        inside = turns * width + np.minimum(part, width)
        return np.diff(inside) * self._count

    def command(self, parameters: Floats) -> Floats:
        level, floor = parameters[2:]
        return floor + (level - floor) * self.covered(parameters)

    def slopes(self, parameters: Floats) -> Floats:
        centre, width, level, floor = parameters
        covered = self.covered(parameters)
        first, last = self._at(centre - 0.5 * width), self._at(centre + 0.5 * width)
        jump = (level - floor) * self._count
        by_centre, by_width = np.zeros(self._count), np.zeros(self._count)
        by_centre[last] += jump
        by_centre[first] -= jump
        by_width[last] += 0.5 * jump
        by_width[first] += 0.5 * jump
        return np.column_stack([by_centre, by_width, covered, 1.0 - covered])

    def _at(self, turn: float) -> int:
        return int(turn % 1.0 * self._count) % self._count


def _parameters(drive: Drive, pulse: Pulse) -> Floats:
    full_A = drive.plant.max_current_A
    return np.array(
        [
            pulse.centre_deg / 180.0,
            pulse.width_deg / 180.0,
            pulse.level_A / full_A,
            pulse.floor_A / full_A,
        ]
    )


def _pulse(drive: Drive, parameters: Floats) -> Pulse:
    """Of these parameters, with the level above the floor."""
    centre, width, level, floor = map(float, parameters)
    if floor > level:
        centre, width, level, floor = centre + 0.5, 1.0 - width, floor, level
    full_A = drive.plant.max_current_A
    return Pulse(180.0 * (centre % 1.0), 180.0 * width, level * full_A, floor * full_A)


def command_of(drive: Drive, pulse: Pulse, intervals: int = INTERVALS) -> Floats:
    """[n] currents of a pulse at a phase of the excitation."""
    command = PulseShape(intervals).command(_parameters(drive, pulse))
    return np.clip(command, 0.0, 1.0) * drive.plant.max_current_A


def best_pulse(ref: Reference, goal: Goal, first: Pulse) -> tuple[Pulse, Optimum]:
    """From one pulse at a phase of the excitation to a local optimum, at such a phase too."""
    optimum = improve(ref, goal, PulseShape(), _parameters(ref.drive, first))
    return _pulse(ref.drive, optimum.parameters), optimum


def tracked(drive: Drive, pulse: Pulse, start: Floats | None = None) -> Orbit:
    """The steady state in which the pulse has its phase of the displacement's fundamental.

    The phase of the excitation where that happens is found by the secant method. UsageError where
    it is not.
    """
    theta_deg, step_deg, miss_deg = 0.0, 0.0, np.inf
    orbit = solve(drive, command_of(drive, pulse), start=start)
    theta_deg = -orbit.disp_phase_deg
    for _ in range(60):
        orbit = solve(drive, command_of(drive, pulse.moved(theta_deg)), start=orbit.state)
        last_deg, miss_deg = miss_deg, _turned(-orbit.disp_phase_deg - theta_deg)
        if abs(miss_deg) < 1e-4:
            return orbit
        slope = (miss_deg - last_deg) / step_deg if step_deg else -1.0
        step_deg = float(np.clip(-miss_deg / min(slope, -0.3), -20.0, 20.0))
        theta_deg += step_deg
    raise UsageError(f"at {drive.freq_Hz:g} Hz the pulse does not come to rest in phase")


def _turned(angle_deg: float) -> float:
    """Within -90 .. 90: pulses repeat every 180 degrees."""
    return (angle_deg + 90.0) % 180.0 - 90.0
