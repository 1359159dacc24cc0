"""Sequential programming on the exact simulator: from one periodic current to a local optimum.

Each step linearises displacement and acceleration over the period by the parameters of the
current, solves the convex problem that results inside a trust region, and keeps the answer only
where the true cost falls. The largest and the least displacement are variables above and below the
samples, so that half peak-to-peak is linear; the RMS acceleration is a norm, bounded from below by
planes that touch it (one more wherever a solution violates them), or minimised alone by bounded
least squares. The solvers are SciPy's (HiGHS).
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.optimize import linprog, lsq_linear

from quiesce.base.errors import UsageError
from quiesce.optimum.goal import ACCEL_PENALTY, AMP_PENALTY, Goal, Reference
from quiesce.optimum.periodic import Drive, Floats, Orbit, solve

STEPS = 80
CLOSE = 1e-5  # predicted gain in cost that is not worth a step
FIRST_TRUST = 0.25  # largest change of a parameter
LEAST_TRUST = 5e-3
CUTS = 12
EXTREME = 0.4  # samples within this part of peak-to-peak of an extreme can become one


class Shape(Protocol):
    """Periodic currents described by m parameters."""

    low: Floats  # [m] least and largest of each parameter
    high: Floats

    def command(self, parameters: Floats) -> Floats:
        """Currents [n] over half a period, in parts of the full current."""
        ...

    def slopes(self, parameters: Floats) -> Floats:
        """[n, m] d command / d parameter."""
        ...


@dataclass(frozen=True)
class Optimum:
    """Parameters of a current and what it does."""

    parameters: Floats  # [m]
    command_A: Floats  # [n] over half a period from theta = 0
    orbit: Orbit
    cost: float


@dataclass(frozen=True)
class _Model:
    """The problem around some parameters: figures relative to 0 A, linear in their change [m]."""

    top: Floats  # displacement, where it is large
    top_slopes: Floats
    bottom: Floats  # and where it is small
    bottom_slopes: Floats
    accel: Floats  # its norm is the RMS
    accel_slopes: Floats
    current: float
    current_slopes: Floats
    floor: Floats  # least and largest change
    ceiling: Floats

    def cost(self, goal: Goal, change: Floats) -> float:
        top = (self.top + self.top_slopes @ change).max()
        bottom = (self.bottom + self.bottom_slopes @ change).min()
        accel = np.linalg.norm(self.accel + self.accel_slopes @ change)
        current = self.current + self.current_slopes @ change
        return goal.cost(0.5 * float(top - bottom), float(accel), float(current))


def improve(ref: Reference, goal: Goal, shape: Shape, parameters: Floats) -> Optimum:
    """Descends from these parameters to a local optimum."""
    best = _with_slopes(ref.drive, _judged(ref, goal, shape, parameters, None))
    trust = FIRST_TRUST
    for _ in range(STEPS):
        model = _linearised(ref, shape, best, trust)
        change = _best_change(model, goal)
        predicted = model.cost(goal, np.zeros_like(change)) - model.cost(goal, change)
        quality = 0.0
        if predicted >= CLOSE:
            trial = _trial(ref, goal, shape, best, change)
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


def _judged(
    ref: Reference, goal: Goal, shape: Shape, parameters: Floats, start: Floats | None
) -> Optimum:
    full_A = ref.drive.plant.max_current_A
    command_A = np.clip(shape.command(parameters), 0.0, 1.0) * full_A
    orbit = solve(ref.drive, command_A, start=start)
    return Optimum(parameters, command_A, orbit, ref.cost(goal, orbit))


def _trial(
    ref: Reference, goal: Goal, shape: Shape, best: Optimum, change: Floats
) -> Optimum | None:
    parameters = np.clip(best.parameters + change, shape.low, shape.high)
    try:
        return _judged(ref, goal, shape, parameters, best.orbit.state)
    except UsageError:
        return None


def _with_slopes(drive: Drive, optimum: Optimum) -> Optimum:
    orbit = solve(drive, optimum.command_A, start=optimum.orbit.state, sensitive=True)
    return Optimum(optimum.parameters, optimum.command_A, orbit, optimum.cost)


def _linearised(ref: Reference, shape: Shape, at: Optimum, trust: float) -> _Model:
    full_A = ref.drive.plant.max_current_A
    orbit, amp_m = at.orbit, ref.orbit.amp_m
    slopes = shape.slopes(at.parameters)
    disp = orbit.disp_m / amp_m
    disp_slopes = orbit.disp_per_A @ slopes * (full_A / amp_m)
    reach = EXTREME * (disp.max() - disp.min())
    top, bottom = disp > disp.max() - reach, disp < disp.min() + reach
    scale = 1.0 / (ref.orbit.accel_rms_m_s2 * np.sqrt(len(disp)))
    accel_slopes = orbit.accel_per_A @ slopes * (full_A * scale)
    return _Model(
        disp[top],
        disp_slopes[top],
        disp[bottom],
        disp_slopes[bottom],
        *_compressed(orbit.accel_m_s2 * scale, accel_slopes),
        orbit.mean_current_A / full_A,
        slopes.mean(axis=0),
        np.maximum(-trust, shape.low - at.parameters),
        np.minimum(trust, shape.high - at.parameters),
    )


def _compressed(values: Floats, slopes: Floats) -> tuple[Floats, Floats]:
    """The same norm of values + slopes change, in m + 1 rows."""
    triangle = np.linalg.qr(np.column_stack([slopes, values]), mode="r")
    return triangle[:, -1], triangle[:, :-1]


def _best_change(model: _Model, goal: Goal) -> Floats:
    if goal == Goal(amp=0.0, accel=goal.accel):
        # A range of no width is not allowed.
        ceiling = np.maximum(model.ceiling, model.floor + 1e-12)
        return lsq_linear(model.accel_slopes, -model.accel, (model.floor, ceiling), tol=1e-8).x
    touched = [np.zeros_like(model.floor)]
    for _ in range(CUTS):
        change, promised = _linear_programme(model, goal, touched)
        touched.append(change)
        if model.cost(goal, change) < promised + 0.1 * CLOSE:
            break
    return min(touched, key=lambda each: model.cost(goal, each))


def _linear_programme(model: _Model, goal: Goal, touched: list[Floats]) -> tuple[Floats, float]:
    """The best change and its cost, as far as the planes at the points touched tell.

    Variables: change [m], highest and lowest displacement, acceleration, what amplitude and
    acceleration have beyond their limits.
    """
    slack = [AMP_PENALTY, ACCEL_PENALTY]
    weights = [*(goal.current * model.current_slopes), 0.5 * goal.amp, -0.5 * goal.amp, goal.accel]
    limits = np.array([goal.amp_limit, goal.accel_limit])
    of_limits = np.array([[0.5, -0.5, 0.0, -1.0, 0.0], [0.0, 0.0, 1.0, 0.0, -1.0]])
    is_limited = np.isfinite(limits)
    planes, right = _planes(model, touched)
    rows = [
        _rows(model.top_slopes, [-1.0, 0.0, 0.0, 0.0, 0.0]),
        _rows(-model.bottom_slopes, [0.0, 1.0, 0.0, 0.0, 0.0]),
        planes,
        np.pad(of_limits, ((0, 0), (len(model.floor), 0)))[is_limited],
    ]
    free = [(None, None), (None, None), (0.0, None), (0.0, None), (0.0, None)]
    solution = linprog(
        weights + slack,
        A_ub=np.vstack(rows),
        b_ub=np.concatenate([-model.top, model.bottom, right, limits[is_limited]]),
        bounds=[*zip(model.floor, model.ceiling, strict=True), *free],
        method="highs",
    )
    if solution.x is None:
        return np.zeros_like(model.floor), np.inf
    change = np.clip(solution.x[: len(model.floor)], model.floor, model.ceiling)
    return change, float(solution.fun) + goal.current * model.current


def _rows(slopes: Floats, others: list[float]) -> Floats:
    return np.column_stack([slopes, np.tile(others, (len(slopes), 1))])


def _planes(model: _Model, touched: list[Floats]) -> tuple[Floats, Floats]:
    """norm(accel) >= norm there + slope there (change - there), for every point touched."""
    slopes, right = [], []
    for there in touched:
        accel = model.accel + model.accel_slopes @ there
        norm = np.linalg.norm(accel)
        slope = accel @ model.accel_slopes / norm
        slopes.append(slope)
        right.append(slope @ there - norm)
    return _rows(np.array(slopes), [0.0, 0.0, -1.0, 0.0, 0.0]), np.array(right)
