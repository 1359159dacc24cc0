"""Searches that papers name (quiesce.base.searches.methods) over all variables of a problem, none
projected out, no polish: as many trials as the squeeze-mode paper's genetic algorithm gets, and
the same search coordinates."""

import numpy as np

from quiesce.base.searches.methods import METHODS
from quiesce.damper.fit.binary_ga import PLAIN
from quiesce.damper.fit.population import errors_of, values_of
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.search import EFFORT, Clock, Effort, Fit, Progress, sobol

POPULATION = PLAIN.population
TRIALS = POPULATION * (PLAIN.generations + 1)


def fit_named(
    name: str,
    problem: Problem,
    seed: int,
    effort: Effort = EFFORT,
    progress: Progress | None = None,
    trials: int = TRIALS,
) -> Fit:
    """Of `effort` counts only when to stop (seconds, stop). Ctrl-C ends it with the best so far."""
    clock = Clock(problem, effort, progress)
    rng = np.random.default_rng(seed)
    search = METHODS[name](sobol(len(problem.variables), POPULATION, rng), rng)
    count = 0
    try:
        points = next(search)
        while count < trials and not clock.is_over():
            values = values_of(problem, points)
            errors = errors_of(problem, values)
            count += len(values)
            clock.offer(values, errors, f"{name}, trial {count}")
            points = search.send(np.where(np.isfinite(errors), errors, 1e3))
    except KeyboardInterrupt:
        clock.was_stopped = True
    return clock.result([])
