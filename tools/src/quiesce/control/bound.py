"""The best that any periodic current can do: optimal control over half a period.

Sequential programming on the exact simulator. Each step linearises displacement and acceleration
over the period by the n commands, solves the convex problem that results inside a trust region,
and keeps the answer only where the true cost falls. The largest and the least displacement are
variables above and below the samples, so that minimising half peak-to-peak is a linear programme;
the RMS acceleration is a norm, bounded from below by planes that touch it (added where a solution
violates them), or minimised alone by bounded least squares. What is found is a best value, not a
proof: several starts guard against poor local minima.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog, lsq_linear

from quiesce.control.goal import Goal, Reference, reference
from quiesce.control.periodic import Drive, Floats, Orbit, solve
from quiesce.errors import UsageError

INTERVALS = 60
STARTS = 4
STEPS = 80
CLOSE = 1e-5  # predicted gain in cost that is not worth another step
FIRST_TRUST = 0.25  # of the full current
LEAST_TRUST = 5e-3  # of the full current
CUTS = 12
EXTREME = 0.4  # samples within this part of the amplitude of an extreme can become one


@dataclass(frozen=True)
class Optimum:
    """A current and what it does."""

    command_A: Floats  # [n] over half a period from theta = 0
    orbit: Orbit
    cost: float


@dataclass(frozen=True)
class _Model:
    """The problem around a command: figures relative to 0 A, linear in the change of the command.

    disp [m], accel [grid] and their slopes [.., n] by a change in parts of the full current.
    """

    high: Floats
    high_slope: Floats
    low: Floats
    low_slope: Floats
    accel: Floats
    accel_slope: Floats
    floor: Floats  # [n] least and largest change of each command
    ceiling: Floats

    def accel_ratio(self, change: Floats) -> float:
        return float(np.linalg.norm(self.accel + self.accel_slope @ change))

    def amp_ratio(self, change: Floats) -> float:
        high = self.high + self.high_slope @ change
        low = self.low + self.low_slope @ change
        return float(high.max() - low.min()) / 2.0

    def cost(self, goal: Goal, change: Floats) -> float:
        accel = self.accel_ratio(change)
        beyond = 0.0 if goal.accel_limit is None else max(0.0, accel - goal.accel_limit)
        return (
            goal.amp * self.amp_ratio(change)
            + goal.accel * accel
            + goal.current * float(change.mean())
            + goal.PENALTY * beyond
        )


def bound(
    drive: Drive, goal: Goal, *, intervals: int = INTERVALS, starts: int = STARTS, seed: int = 1
) -> Optimum:
    """The best current for the goal over all starts."""
    ref = reference(drive)
    found = [improve(ref, goal, start) for start in first_guesses(drive, intervals, starts, seed)]
    return min(found, key=lambda optimum: optimum.cost)


def first_guesses(drive: Drive, count: int, starts: int, seed: int) -> Iterator[Floats]:
    """Constants, the two halves of the half period, then random levels, all over full scale."""
    full_A = drive.plant.max_current_A
    first = np.repeat([0.0, full_A], [count - count // 2, count // 2])
    fixed = [np.full(count, part * full_A) for part in (1.0, 0.5, 0.0)]
    fixed += [first, np.roll(first, count // 4), full_A - first, np.roll(first, -(count // 4))]
    yield from fixed[:starts]
    rng = np.random.default_rng(seed)
    for _ in range(starts - len(fixed)):
        yield np.repeat(rng.uniform(0.0, full_A, 6), -(-count // 6))[:count]


def improve(ref: Reference, goal: Goal, command_A: Floats) -> Optimum:
    """Descends from one command to a local optimum."""
    full_A = ref.drive.plant.max_current_A
    orbit = solve(ref.drive, command_A, sensitive=True)
    best = Optimum(command_A, orbit, ref.cost(goal, orbit))
    trust = FIRST_TRUST
    for _ in range(STEPS):
        model = _linearised(ref, best, trust)
        change = _best_change(model, goal)
        predicted = best.cost - model.cost(goal, change)
        if predicted < CLOSE:
            quality = 0.0
        else:
            trial = _trial(ref, goal, best, change * full_A)
            quality = (best.cost - trial.cost) / predicted if trial else -np.inf
        if quality > 0.0:
            best = _with_slopes(ref.drive, trial)
        trust = _next_trust(trust, quality)
        if trust < LEAST_TRUST:
            break
    return best


def _next_trust(trust: float, quality: float) -> float:
    if quality > 0.75:
        return min(1.0, 2.0 * trust)
    return trust if quality > 0.25 else trust / 3.0


def _trial(ref: Reference, goal: Goal, best: Optimum, change_A: Floats) -> Optimum | None:
    command_A = np.clip(best.command_A + change_A, 0.0, ref.drive.plant.max_current_A)
    try:
        orbit = solve(ref.drive, command_A, start=best.orbit.state)
    except UsageError:
        return None
    return Optimum(command_A, orbit, ref.cost(goal, orbit))


def _with_slopes(drive: Drive, optimum: Optimum) -> Optimum:
    orbit = solve(drive, optimum.command_A, start=optimum.orbit.state, sensitive=True)
    return Optimum(optimum.command_A, orbit, optimum.cost)


def _linearised(ref: Reference, at: Optimum, trust: float) -> _Model:
    full_A = ref.drive.plant.max_current_A
    orbit, amp_m = at.orbit, ref.orbit.amp_m
    disp = orbit.disp_m / amp_m
    disp_slope = orbit.disp_per_A * (full_A / amp_m)
    high = disp > disp.max() - EXTREME * (disp.max() - disp.min())
    low = disp < disp.min() + EXTREME * (disp.max() - disp.min())
    scale = 1.0 / (ref.orbit.accel_rms_m_s2 * np.sqrt(len(disp)))
    part = at.command_A / full_A
    return _Model(
        disp[high],
        disp_slope[high],
        disp[low],
        disp_slope[low],
        *_compressed(orbit.accel_m_s2 * scale, orbit.accel_per_A * (full_A * scale)),
        np.maximum(-trust, -part),
        np.minimum(trust, 1.0 - part),
    )


def _compressed(values: Floats, slopes: Floats) -> tuple[Floats, Floats]:
    """The same norm of values + slopes change, in n + 1 rows."""
    triangle = np.linalg.qr(np.column_stack([slopes, values]), mode="r")
    return triangle[:, -1], triangle[:, :-1]


def _best_change(model: _Model, goal: Goal) -> Floats:
    if goal.amp == 0.0 and goal.current == 0.0:
        # A range of no width is not allowed.
        ceiling = np.maximum(model.ceiling, model.floor + 1e-12)
        return lsq_linear(model.accel_slope, -model.accel, (model.floor, ceiling), tol=1e-8).x
    touched = [np.zeros_like(model.floor)]
    for _ in range(CUTS):
        change, promised = _linear_programme(model, goal, touched)
        touched.append(change)
        if model.cost(goal, change) < promised + 0.1 * CLOSE:
            break
    return min(touched, key=lambda each: model.cost(goal, each))


def _linear_programme(model: _Model, goal: Goal, touched: list[Floats]) -> tuple[Floats, float]:
    """The change and its cost, as far as the planes touched so far tell.

    Variables: change [n], highest and lowest displacement, acceleration, its excess.
    """
    n = len(model.floor)
    weights = np.concatenate(
        [
            np.full(n, goal.current / n),
            [0.5 * goal.amp, -0.5 * goal.amp, goal.accel, goal.PENALTY],
        ]
    )
    high = _rows(model.high_slope, [-1.0, 0.0, 0.0, 0.0])
    low = _rows(-model.low_slope, [0.0, 1.0, 0.0, 0.0])
    planes, right = _planes(model, touched)
    rows, limits = [high, low, planes], [-model.high, model.low, right]
    if goal.accel_limit is not None:
        rows.append(_rows(np.zeros((1, n)), [0.0, 0.0, 1.0, -1.0]))
        limits.append(np.array([goal.accel_limit]))
    free = [(None, None), (None, None), (0.0, None), (0.0, None)]
    solution = linprog(
        weights,
        A_ub=np.vstack(rows),
        b_ub=np.concatenate(limits),
        bounds=[*zip(model.floor, model.ceiling, strict=True), *free],
        method="highs",
    )
    if solution.x is None:
        return np.zeros(n), np.inf
    return np.clip(solution.x[:n], model.floor, model.ceiling), float(solution.fun)


def _rows(slopes: Floats, others: list[float]) -> Floats:
    return np.column_stack([slopes, np.tile(others, (len(slopes), 1))])


def _planes(model: _Model, touched: list[Floats]) -> tuple[Floats, Floats]:
    """norm(accel) >= norm there + slope there (change - there), for every point touched."""
    slopes, right = [], []
    for there in touched:
        accel = model.accel + model.accel_slope @ there
        norm = np.linalg.norm(accel)
        slope = accel @ model.accel_slope / norm
        slopes.append(slope)
        right.append(slope @ there - norm)
    return _rows(np.array(slopes), [0.0, 0.0, -1.0, 0.0]), np.array(right)
