"""Fitting: a global search over the nonlinear variables, then least squares over all."""

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import differential_evolution, least_squares
from scipy.stats import qmc

from quiesce.damper.fit.problem import SEARCH_SUBSTEPS, Problem

# Ends whose errors are this close agree.
_AGREEMENT = 1.001

Progress = Callable[[str, float], None]  # what is being done, error so far


@dataclass(frozen=True)
class Effort:
    """How long to search."""

    population: int = 64
    generations: int = 40
    polished: int = 4  # candidates that are polished
    polish_evaluations: int = 60
    seconds: float = np.inf  # of the whole fit
    stop: threading.Event | None = None  # set from outside: end with the best so far


EFFORT = Effort()


@dataclass
class Fit:
    """Values of the problem's variables; error ||F - F_model|| / ||F|| as the problem weighs it."""

    values: np.ndarray
    error: float
    evaluations: int
    seconds: float
    is_complete: bool  # neither interrupted nor out of time
    others: list[float] = field(default_factory=list)  # errors of the other polished candidates


class Clock:
    """Remembers the best candidate; knows when time is up."""

    def __init__(self, problem: Problem, effort: Effort, progress: Progress | None) -> None:
        self.problem = problem
        self.progress = progress
        self.start_s = time.monotonic()
        self.seconds = effort.seconds
        self.stop = effort.stop
        self.best: np.ndarray | None = None
        self.error = np.inf
        self.was_stopped = False

    def offer(self, values: np.ndarray, errors: np.ndarray, what: str) -> None:
        index = int(np.argmin(errors))
        if errors[index] < self.error:
            self.best, self.error = values[index].copy(), float(errors[index])
        if self.progress is not None:
            self.progress(what, self.error)

    def is_over(self) -> bool:
        is_stopped = self.stop is not None and self.stop.is_set()
        if is_stopped or time.monotonic() - self.start_s > self.seconds:
            self.was_stopped = True
        return self.was_stopped

    def result(self, others: list[float]) -> Fit:
        values = self.best
        if values is None:
            values, errors = self.problem.project(middle(self.problem))
            values, self.error = values[0], float(errors[0])
        return Fit(
            values,
            self.error,
            self.problem.evaluations,
            time.monotonic() - self.start_s,
            not self.was_stopped,
            others,
        )


def middle(problem: Problem) -> np.ndarray:
    return problem.values_from(np.full((1, len(problem.nonlinear)), 0.5))


def fit(
    problem: Problem,
    seed: int,
    effort: Effort = EFFORT,
    progress: Progress | None = None,
    starts: np.ndarray | None = None,
) -> Fit:
    """Differential evolution over the nonlinear variables (the linear ones projected out), then
    the best few polished. starts: values to begin with among others, [any, variables]. Ctrl-C or
    the end of `effort.seconds` ends it with the best so far."""
    clock = Clock(problem, effort, progress)
    errors: list[float] = []
    try:
        if not problem.nonlinear:
            clock.offer(*problem.project(np.zeros((1, len(problem.variables)))), "solving")
            candidates = clock.best[None, :] if clock.best is not None else np.empty((0, 0))
        else:
            candidates = search(problem, seed, effort, clock, starts)
        errors = polish_all(problem, candidates, effort, clock, is_agreement_enough=True)
    except KeyboardInterrupt:
        clock.was_stopped = True
    return clock.result(errors)


def search(
    problem: Problem, seed: int, effort: Effort, clock: Clock, starts: np.ndarray | None
) -> np.ndarray:
    """Candidates worth polishing, best first."""
    dimensions = len(problem.nonlinear)
    rng = np.random.default_rng(seed)
    initial = sobol(dimensions, effort.population, rng)
    if starts is not None:
        parts = problem.parts_of(starts)
        initial[: len(parts)] = np.clip(parts, 0.0, 1.0)
    found: list[tuple[np.ndarray, np.ndarray]] = []

    def cost(parts: np.ndarray) -> np.ndarray:
        values, errors = problem.project(problem.values_from(parts.T), SEARCH_SUBSTEPS)
        clock.offer(values, errors, "searching")
        found.append((values, errors))
        del found[:-2]
        return np.where(np.isfinite(errors), errors, 1e3)

    ended = differential_evolution(
        cost,
        [(0.0, 1.0)] * dimensions,
        init=initial,
        maxiter=effort.generations,
        strategy="rand1bin" if dimensions <= 2 else "currenttobest1bin",
        mutation=(0.4, 0.9),
        recombination=0.8,
        tol=1e-4,
        polish=False,
        vectorized=True,
        updating="deferred",
        rng=rng,
        callback=lambda *_args, **_more: clock.is_over(),
    )
    order = np.argsort(ended.population_energies)
    chosen = spread(ended.population[order], effort.polished)
    values, _errors = problem.project(problem.values_from(chosen), SEARCH_SUBSTEPS)
    return values


def sobol(dimensions: int, count: int, rng: np.random.Generator) -> np.ndarray:
    """Evenly spread points of the unit cube, [count, dimensions]."""
    whole = 1 << (count - 1).bit_length()
    return qmc.Sobol(max(1, dimensions), seed=rng).random(whole)[:count, :dimensions]


def spread(parts: np.ndarray, count: int, apart: float = 0.05) -> np.ndarray:
    """The first `count` rows that are not all but the same."""
    kept: list[np.ndarray] = []
    for row in parts:
        if len(kept) < count and all(np.max(np.abs(row - other)) > apart for other in kept):
            kept.append(row)
    return np.array(kept)


def polish_all(
    problem: Problem,
    candidates: np.ndarray,
    effort: Effort,
    clock: Clock,
    is_agreement_enough: bool = False,
) -> list[float]:
    """Errors of the ends, rising. is_agreement_enough: end where the two best ends agree; what a
    search came to by two ways needs no third."""
    errors: list[float] = []
    for k, values in enumerate(candidates):
        if clock.is_over() or (is_agreement_enough and agree(errors)):
            break
        polished, error = polish(problem, values, effort.polish_evaluations, clock.is_over)
        errors.append(error)
        clock.offer(polished[None, :], np.array([error]), f"polishing {k + 1}/{len(candidates)}")
    return sorted(errors)


def agree(ends: Sequence[float]) -> bool:
    """Whether the two best ends have one error."""
    best = sorted(ends)[:2]
    return len(best) == 2 and best[1] <= _AGREEMENT * best[0]


class _TimeIsUp(Exception):
    pass


def polish(
    problem: Problem,
    values: np.ndarray,
    most: int,
    is_over: Callable[[], bool] = lambda: False,
    tolerance: float = 1e-10,
) -> tuple[np.ndarray, float]:
    """Least squares over all variables from here: values and error. tolerance: relative decrease
    or move with which it ends."""
    low, high = np.array([one.bounds for one in problem.variables]).T
    size = np.array(
        [
            max(abs(value), 1e-2 * one.natural) if not one.is_log else max(value, 1e-300)
            for one, value in zip(problem.variables, values, strict=True)
        ]
    )
    start = np.clip(values, low, high) / size
    best = [np.inf, start]

    def residuals(scaled: np.ndarray) -> np.ndarray:
        if is_over():
            raise _TimeIsUp
        with np.errstate(all="ignore"):
            out = problem.residuals(scaled * size)
        out = np.where(np.isfinite(out), out, 1e3)
        error = float(np.sqrt(np.sum(out**2)))
        if error < best[0]:
            best[:] = [error, scaled.copy()]
        return out

    def jacobian(scaled: np.ndarray) -> np.ndarray:
        values = scaled * size
        with np.errstate(all="ignore"):
            out = problem.jacobian(values, problem.difference_steps(values)) * size
        return np.where(np.isfinite(out), out, 0.0)

    try:
        least_squares(
            residuals,
            start,
            jac=jacobian,
            bounds=(low / size, high / size),
            method="trf",
            x_scale="jac",
            max_nfev=most,
            ftol=tolerance,
            xtol=tolerance,
            gtol=1e-12,
        )
    except _TimeIsUp:
        pass
    return best[1] * size, float(best[0])


def from_starts(
    problem: Problem, seed: int, count: int, effort: Effort, progress: Progress | None = None
) -> Fit:
    """Least squares from `count` random starts: what baselines get."""
    clock = Clock(problem, effort, progress)
    errors: list[float] = []
    try:
        chosen = sobol(len(problem.nonlinear), count, np.random.default_rng(seed))
        values, found = problem.project(problem.values_from(chosen), SEARCH_SUBSTEPS)
        clock.offer(values, found, "starting")
        errors = polish_all(problem, values, effort, clock)
    except KeyboardInterrupt:
        clock.was_stopped = True
    return clock.result(errors)
