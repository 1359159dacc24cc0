"""Inverses in a loop with a damper: wanted force, inverse, coil, damper, force; and how far the
force is from what the damper could have given.

Motions and wanted forces are of kinds that no training has: sines, sweeps, band noise. What the
damper could give lies between its forces at 0 and at the largest current, its states those at a
constant current, without the coil's lag; where the wanted force does not resist, it is the force
without current.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.data.record import Record
from quiesce.damper.excitation import random_motion, sine, sweep, times
from quiesce.damper.inverse import InverseByInterpolation, check_finite, forces_by
from quiesce.damper.inverses.demand import Inverse, commanded, judged
from quiesce.damper.inverses.excited import SPEED_PART, STROKE_PART, moved
from quiesce.damper.model_file import DamperModel
from quiesce.damper.score import Simulate

RATE_Hz = 1000.0  # of the controller
DURATION_s = 8.0
SETTLED_s = 0.5  # before it nothing is scored
_FORCE_PART = 0.8  # amplitude of a wanted force, of the damper's largest
_CONSTANTS = 21
_IDEAL = 41
_LEAD = np.radians(30.0)  # of a wanted force before the velocity
CONSTANT, IDEAL = "constant", "ideal"


@dataclass(frozen=True)
class Task:
    """A motion with a wanted force, and what the damper could give of it, [samples]."""

    demand: Record
    target_N: np.ndarray

    @property
    def scored(self) -> slice:
        return slice(int(SETTLED_s * self.demand.rate_Hz), len(self.demand))


@dataclass(frozen=True)
class Run:
    """What a method made of a task."""

    task: Task
    current_A: np.ndarray  # commanded
    force_N: np.ndarray

    @property
    def squared_N2(self) -> float:
        return float(np.sum((self.force_N - self.task.target_N)[self.task.scored] ** 2))


def error_pct(runs: Sequence[Run]) -> float:
    """100 ||F - target|| / ||target|| over all runs."""
    size = sum(float(np.sum(one.task.target_N[one.task.scored] ** 2)) for one in runs)
    return 100.0 * float(np.sqrt(sum(one.squared_N2 for one in runs) / max(size, 1e-300)))


def shapes(time_s: np.ndarray, seed: int, reach: tuple[float, float]) -> dict[str, tuple]:
    """Displacement in m and wanted force from -1 to 1, by name."""
    amplitude_m, speed_m_s = reach

    def slow(freq_Hz: float) -> float:
        return min(amplitude_m, speed_m_s / (2.0 * np.pi * freq_Hz))

    leading = np.cos(2.0 * np.pi * 1.5 * time_s + _LEAD)
    return {
        "sine, force ahead": (sine(time_s, slow(1.5), 1.5), leading),
        "sine, slow force": (sine(time_s, slow(3.0), 3.0), sine(time_s, 1.0, 0.7)),
        "sweep": (
            sweep(time_s, amplitude_m, speed_m_s, 0.5, 5.0),
            np.sin(2.0 * np.pi * (5.0 * time_s - 2.25 * time_s**2 / time_s[-1])),
        ),
        "band noise": (
            random_motion(time_s, amplitude_m, speed_m_s, (0.5, 5.0), seed),
            random_motion(time_s, 1.0, 1e9, (0.5, 8.0), seed + 1),
        ),
    }


def tasks_for(
    damper: DamperModel,
    simulate: Simulate,
    max_current_A: float,
    seed: int,
    duration_s: float = DURATION_s,
) -> list[Task]:
    """UsageError where the damper's file states no stroke or no speed, or where its force is not
    finite."""
    if not (damper.speed_m_s > 0.0 and damper.stroke_m > 0.0):
        raise UsageError(f"{damper.name}: the file states no stroke or no speed")
    time_s = times(duration_s, RATE_Hz)
    reach = (STROKE_PART * damper.stroke_m, SPEED_PART * damper.speed_m_s)
    forces = forces_by(damper, None if damper.is_kernel else simulate)
    out = []
    for name, (disp_m, shape) in shapes(time_s, seed, reach).items():
        record = moved(name, time_s, disp_m, np.zeros(len(time_s)))
        bank = forces(record, np.linspace(0.0, max_current_A, _CONSTANTS))
        check_finite(damper, bank)
        wanted_N = _FORCE_PART * float(np.abs(bank).max()) * shape
        demand = judged(replace(record, force_N=wanted_N))
        out.append(Task(demand, nearest(bank, demand)))
    return out


def nearest(bank_N: np.ndarray, demand: Record) -> np.ndarray:
    """What can be had of a judged demand, from forces [currents, samples], none first."""
    side = np.sign(demand.velocity_m_s)
    along = side * bank_N
    near = np.clip(side * demand.force_N, along.min(axis=0), along.max(axis=0))
    return np.where(demand.force_N == 0.0, bank_N[0], side * near)


@dataclass(frozen=True)
class Tracker:
    """A damper in the loop."""

    simulate: Simulate
    tasks: Sequence[Task]

    def follow(self, task: Task, current_A: np.ndarray) -> Run:
        force_N = self.simulate(replace(task.demand, command=current_A))
        return Run(task, current_A, force_N)

    def runs(self, inverse: Inverse) -> list[Run]:
        return [self.follow(task, commanded(inverse, task.demand)) for task in self.tasks]

    def constant(self, max_current_A: float) -> tuple[float, list[Run]]:
        """The best one current for all tasks together, and its runs: a peer that has seen them."""
        grid_A = np.linspace(0.0, max_current_A, _CONSTANTS)
        tried = {
            float(level): [
                self.follow(task, np.full(len(task.demand), level)) for task in self.tasks
            ]
            for level in grid_A
        }
        best_A = min(tried, key=lambda level: error_pct(tried[level]))
        return best_A, tried[best_A]


@dataclass(frozen=True)
class Compared:
    """Runs by method, peers last; constant_A of the peer `constant`."""

    runs: Mapping[str, list[Run]]
    constant_A: float

    def errors_pct(self) -> dict[str, float]:
        return {name: error_pct(runs) for name, runs in self.runs.items()}


def compare(
    damper: DamperModel,
    simulate: Simulate,
    inverses: Mapping[str, Inverse],
    max_current_A: float,
    seed: int,
    duration_s: float = DURATION_s,
) -> Compared:
    """Of inverses by name, beside the best constant current and the inverse by interpolation that
    has the very damper, without looking ahead to its coil."""
    tracker = Tracker(simulate, tasks_for(damper, simulate, max_current_A, seed, duration_s))
    runs = {name: tracker.runs(one) for name, one in inverses.items()}
    constant_A, runs[CONSTANT] = tracker.constant(max_current_A)
    own = InverseByInterpolation(
        damper, max_current_A, _IDEAL, None if damper.is_kernel else simulate
    )
    runs[IDEAL] = [
        tracker.follow(task, own.currents(task.demand, task.demand.force_N))
        for task in tracker.tasks
    ]
    return Compared(runs, constant_A)
