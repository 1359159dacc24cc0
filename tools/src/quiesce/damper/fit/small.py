"""Fits of problems with few nonlinear variables, in few simulations.

A handful of evenly spread starts, the linear variables projected out; from the best of them
Levenberg and Marquardt's least squares over the nonlinear variables. Where the residual is then
white noise there is nothing left to explain and the fit ends; else the next starts follow, and the
global search where they disagree. The least squares are ours, because scipy's ask for residual and
derivative one after the other, which here come from one batch.
"""

import numpy as np

from quiesce.damper.fit.intervals import whiteness
from quiesce.damper.fit.problem import SEARCH_SUBSTEPS, Problem
from quiesce.damper.fit.projected import Projected
from quiesce.damper.fit.search import EFFORT, Clock, Effort, Fit, Progress, agree, fit, sobol

STARTS = 8
# Starts that least squares go on from, one after the other.
TRIED = 3
# A residual this small is nothing but integration error.
EXPLAINED = 5e-4
_STEP = 1e-5  # of derivatives, in search coordinates
_FIRST_DAMPING = 1e-3
_LEAST_DAMPING = 1e-9
_MOST_DAMPING = 1e6
_ENOUGH = 1e-4  # relative decrease of the error with which the descent ends
_LARGEST_MOVE = 0.3  # of a search coordinate in one step


def fit_small(
    problem: Problem,
    seed: int,
    effort: Effort = EFFORT,
    progress: Progress | None = None,
    known: np.ndarray | None = None,
) -> Fit:
    """See above. known: values to begin with among others, [any, variables]. Ctrl-C or the end of
    `effort.seconds` ends it with the best so far."""
    if not problem.nonlinear:
        return fit(problem, seed, effort, progress)
    clock = Clock(problem, effort, progress)
    projected = Projected(problem)
    ends: list[float] = []
    try:
        starts = sobol(len(problem.nonlinear), STARTS, np.random.default_rng(seed))
        if known is not None:
            starts = np.vstack([starts, np.clip(problem.parts_of(known), 0.0, 1.0)])
        values, residuals = projected.solve(starts, SEARCH_SUBSTEPS)
        errors = np.linalg.norm(residuals, axis=1)
        for k in np.argsort(errors)[:TRIED]:
            if clock.is_over():
                break
            values, error, is_white = descend(projected, starts[k], effort, clock)
            if not projected.check(values):
                return fit(problem, seed, effort, progress)
            ends.append(error)
            clock.offer(values[None, :], np.array([error]), f"start {len(ends)}")
            if is_white or error <= EXPLAINED or agree(ends):
                return clock.result(sorted(ends))
        if not clock.is_over():
            found = fit(problem, seed, effort, progress, starts=np.array([clock.best]))
            clock.offer(found.values[None, :], np.array([found.error]), "searched")
            clock.was_stopped = not found.is_complete
    except KeyboardInterrupt:
        clock.was_stopped = True
    return clock.result(sorted(ends))


def descend(
    projected: Projected, start: np.ndarray, effort: Effort, clock: Clock
) -> tuple[np.ndarray, float, bool]:
    """Values, error, and whether the residual is white. The error at a trial and its derivative
    come from one batch: they cost little more than the error alone."""
    low, high = coordinates_within(projected.problem)
    at = np.clip(start, low, high)
    values, residual, slope = linearised(projected, at, high)
    error = float(np.linalg.norm(residual))
    damping = _FIRST_DAMPING
    for _ in range(effort.polish_evaluations):
        if damping > _MOST_DAMPING or not np.isfinite(error) or clock.is_over():
            break
        move = step(slope, residual, damping)
        trial = np.clip(at + move, low, high)
        if np.max(np.abs(trial - at), initial=0.0) < 1e-9:
            break
        new_values, new_residual, new_slope = linearised(projected, trial, high)
        new_error = float(np.linalg.norm(new_residual))
        if not new_error < error:
            damping *= 10.0
            continue
        gain = 1.0 - new_error / error
        at, values, residual, slope, error = trial, new_values, new_residual, new_slope, new_error
        damping = max(0.1 * damping, _LEAST_DAMPING)
        if gain < _ENOUGH:
            break
    is_white = bool(np.isfinite(error)) and whiteness(residual).is_white
    return values, error, is_white


def coordinates_within(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """Bounds of the nonlinear variables as search coordinates."""
    some = [problem.variables[k] for k in problem.nonlinear]
    low, high = (np.array([one.to_part(one.bounds[side]) for one in some]) for side in (0, 1))
    return low, high


def linearised(
    projected: Projected, at: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values, residual [samples] and its derivative [samples, nonlinear] by one-sided differences
    that stay below `high`."""
    steps = np.where(at + _STEP > high, -_STEP, _STEP)
    points = np.vstack([at, at + np.diag(steps)])
    values, residuals = projected.solve(points)
    with np.errstate(invalid="ignore"):
        slope = ((residuals[1:] - residuals[0]) / steps[:, None]).T
    return values[0], residuals[0], np.where(np.isfinite(slope), slope, 0.0)


def step(slope: np.ndarray, residual: np.ndarray, damping: float) -> np.ndarray:
    """Of Levenberg and Marquardt, scaled by each variable's own effect, at most _LARGEST_MOVE."""
    gram = slope.T @ slope
    scale = np.diag(gram) + 1e-12 * np.max(np.diag(gram), initial=1e-300)
    move = np.linalg.solve(gram + damping * np.diag(scale), -slope.T @ residual)
    return move * min(1.0, _LARGEST_MOVE / max(np.max(np.abs(move)), 1e-300))
