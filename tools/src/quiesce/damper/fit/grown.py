"""Fits of models that grow: a network starts from the fit of the one with an element less."""

import numpy as np

from quiesce.damper.fit.problem import SEARCH_SUBSTEPS, Problem
from quiesce.damper.fit.search import Clock, Effort, Fit, Progress, polish_all, sobol

# Random points that are looked at for each start that is polished.
_LOOKS = 32
EFFORT = Effort(polished=6, polish_evaluations=40)


def grown_fit(
    problem: Problem,
    seed: int,
    smaller: tuple[Problem, Fit] | None,
    effort: Effort = EFFORT,
    progress: Progress | None = None,
) -> Fit:
    """Least squares from the best of many random points; half of them have, where there is a fit of
    the smaller model, its values for variables of the same name. The best end is polished on."""
    clock = Clock(problem, effort, progress)
    errors: list[float] = []
    try:
        values = starts(problem, seed, smaller, effort.polished)
        errors = polish_all(problem, values, effort, clock)
        if clock.best is not None and not clock.is_over():
            errors = errors[1:] + polish_all(problem, clock.best[None, :], effort, clock)
    except KeyboardInterrupt:
        clock.was_stopped = True
    return clock.result(sorted(errors))


def starts(
    problem: Problem, seed: int, smaller: tuple[Problem, Fit] | None, count: int
) -> np.ndarray:
    """The best of random points, [count, variables]; those that grew compete among themselves."""
    rng = np.random.default_rng(seed)
    values = problem.values_from(sobol(len(problem.nonlinear), _LOOKS * count, rng))
    groups = [values]
    if smaller is not None:
        grown, fresh = np.array_split(values, 2)
        groups = [grow(problem, grown, *smaller), fresh]
    chosen = []
    for k, group in enumerate(groups):
        projected, errors = problem.project(group, SEARCH_SUBSTEPS)
        share = (count + len(groups) - 1 - k) // len(groups)
        chosen.append(projected[np.argsort(errors)[:share]])
    return np.concatenate(chosen)


def grow(problem: Problem, values: np.ndarray, before: Problem, fit: Fit) -> np.ndarray:
    """Values with those of the smaller fit where names agree."""
    known = dict(zip([one.name for one in before.variables], fit.values, strict=True))
    out = values.copy()
    for k, one in enumerate(problem.variables):
        if one.name in known:
            out[:, k] = np.clip(known[one.name], *one.bounds)
    return out
