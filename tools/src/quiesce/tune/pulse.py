"""One pulse of current for each half period of the vibration: how to shape it best.

Inside optimisation a pulse has a phase of the excitation, theta; the tables hold phases of the
displacement's fundamental as the accelerometer tells it, psi = theta + its phase.
"""

from dataclasses import dataclass, replace

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.optimum.descent import Optimum, improve
from quiesce.optimum.goal import Goal, Reference
from quiesce.optimum.periodic import Drive, Floats, Orbit, solve

INTERVALS = 120
SHARP = 1e-3  # ramps below this part of half a turn are steps
SLOPE_PART = 1e-6


@dataclass(frozen=True)
class Pulse:
    """level_A within width_deg around centre_deg (modulo 180), else floor_A.

    The edges are ramps of ramp_deg around those angles; they never overlap: a ramp is at most as
    wide as the pulse and as the gap between pulses.
    """

    centre_deg: float
    width_deg: float
    level_A: float
    floor_A: float
    ramp_deg: float = 0.0

    def moved(self, by_deg: float) -> "Pulse":
        return replace(self, centre_deg=(self.centre_deg + by_deg) % 180.0)


class PulseShape:
    """Parameters: centre, width and ramp in half turns, level and floor in parts of full current.

    Their order: centre, width, level, floor, ramp. Intervals get the mean of the pulse over them.
    """

    def __init__(self, count: int = INTERVALS, has_ramp: bool = True) -> None:
        self._edges = np.arange(count + 1) / count
        self._count = count
        self.low = np.array([-10.0, 0.0, 0.0, 0.0, 0.0])
        self.high = np.array([10.0, 1.0, 1.0, 1.0, 0.5 if has_ramp else 0.0])

    def command(self, parameters: Floats) -> Floats:
        centre, width, level, floor, ramp = parameters
        return floor + (level - floor) * self._covered(centre, width, ramp)

    def slopes(self, parameters: Floats) -> Floats:
        steps = SLOPE_PART * np.eye(len(parameters))
        rows = [self.command(parameters + step) - self.command(parameters - step) for step in steps]
        return np.array(rows).T / (2.0 * SLOPE_PART)

    def _covered(self, centre: float, width: float, ramp: float) -> Floats:
        """[n] part of each interval that is inside the pulse."""
        ramp = max(min(ramp, width, 1.0 - width), SHARP)
        from_start = self._edges - (centre - 0.5 * width)
        ahead, behind = from_start + 0.5 * ramp, from_start - 0.5 * ramp
        inside = (_twice_integrated(ahead, width) - _twice_integrated(behind, width)) / ramp
        return np.diff(inside) * self._count


def _twice_integrated(turn: Floats, width: float) -> Floats:
    """Second integral from 0 of a function of period 1 that is 1 up to width, then 0."""
    turns, part = np.divmod(turn, 1.0)
    inside = np.minimum(part, width)
    whole = width * (0.5 * turns * (turns - 1.0) + turns * (1.0 - 0.5 * width + part))
    return whole + 0.5 * inside**2 + width * (part - inside)


def _parameters(drive: Drive, pulse: Pulse) -> Floats:
    full_A = drive.plant.max_current_A
    return np.array(
        [
            pulse.centre_deg / 180.0,
            pulse.width_deg / 180.0,
            pulse.level_A / full_A,
            pulse.floor_A / full_A,
            pulse.ramp_deg / 180.0,
        ]
    )


def _pulse(drive: Drive, parameters: Floats) -> Pulse:
    """Of these parameters, with the level above the floor."""
    centre, width, level, floor, ramp = map(float, parameters)
    if floor > level:
        centre, width, level, floor = centre + 0.5, 1.0 - width, floor, level
    full_A = drive.plant.max_current_A
    ramp = min(ramp, width, 1.0 - width)
    return Pulse(
        180.0 * (centre % 1.0), 180.0 * width, level * full_A, floor * full_A, 180.0 * ramp
    )


def command_of(drive: Drive, pulse: Pulse, intervals: int = INTERVALS) -> Floats:
    """[n] currents of a pulse at a phase of the excitation."""
    command = PulseShape(intervals).command(_parameters(drive, pulse))
    return np.clip(command, 0.0, 1.0) * drive.plant.max_current_A


def best_pulse(
    ref: Reference, goal: Goal, first: Pulse, has_ramp: bool = True
) -> tuple[Pulse, Optimum]:
    """From one pulse at a phase of the excitation to a local optimum, at such a phase too."""
    shape = PulseShape(has_ramp=has_ramp)
    optimum = improve(ref, goal, shape, _parameters(ref.drive, first))
    return _pulse(ref.drive, optimum.parameters), optimum


def tracked(drive: Drive, pulse: Pulse, start: Floats | None = None) -> Orbit:
    """The steady state in which the pulse has its phase of the displacement's fundamental.

    The phase of the excitation where that happens is found by the secant method. UsageError where
    it is not.
    """
    theta_deg, step_deg, miss_deg = 0.0, 0.0, np.inf
    orbit = solve(drive, command_of(drive, pulse), start=start)
    theta_deg = -orbit.tracked_deg
    for _ in range(60):
        orbit = solve(drive, command_of(drive, pulse.moved(theta_deg)), start=orbit.state)
        last_deg, miss_deg = miss_deg, _turned(-orbit.tracked_deg - theta_deg)
        if abs(miss_deg) < 1e-4:
            return orbit
        slope = (miss_deg - last_deg) / step_deg if step_deg else -1.0
        step_deg = float(np.clip(-miss_deg / min(slope, -0.3), -20.0, 20.0))
        theta_deg += step_deg
    raise UsageError(f"at {drive.freq_Hz:g} Hz the pulse does not come to rest in phase")


def _turned(angle_deg: float) -> float:
    """Within -90 .. 90: pulses repeat every 180 degrees."""
    return (angle_deg + 90.0) % 180.0 - 90.0
