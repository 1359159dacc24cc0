"""Differential evolution as in the thesis on the RD-8040-1.

Mutation V = X_i + F (X_j - X_l) on the target vector itself, binomial crossover, greedy selection;
all variables, none projected out, no polish. Ours, because neither pymoo nor scipy has this
mutation: theirs take a third vector or the best one.
What leaves the search range is set to its end: the thesis does not say.
"""

from dataclasses import dataclass

import numpy as np

from quiesce.damper.fit.population import errors_of, ranges_of
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.search import EFFORT, Clock, Effort, Fit, Progress


@dataclass(frozen=True)
class Settings:
    generations: int
    mutation: float  # F
    crossover: float  # CR
    population: int = 0  # 0: per_variable for each variable
    per_variable: int = 20


MODIFIED_BOUC_WEN = Settings(generations=200, mutation=0.8, crossover=0.8)
HYSTERETIC = Settings(generations=40, mutation=0.5, crossover=0.8, population=800)


def settings_for(problem: Problem) -> Settings:
    """As the thesis did it: for models with states as for its modified Bouc-Wen model, for others
    as for its hysteretic (hyperbolic tangent) model."""
    return MODIFIED_BOUC_WEN if problem.model.states > 0 else HYSTERETIC


def fit_thesis_de(
    problem: Problem,
    seed: int,
    effort: Effort = EFFORT,
    progress: Progress | None = None,
    settings: Settings | None = None,
) -> Fit:
    """Of `effort` counts only when to stop (seconds, stop); size and length are in the settings.
    Ctrl-C ends it with the best so far."""
    settings = settings or settings_for(problem)
    clock = Clock(problem, effort, progress)
    rng = np.random.default_rng(seed)
    low, high = ranges_of(problem)
    count = settings.population or settings.per_variable * len(low)
    values = low + (high - low) * rng.random((count, len(low)))
    try:
        errors = errors_of(problem, values)
        clock.offer(values, errors, "generation 0")
        for generation in range(settings.generations):
            if clock.is_over():
                break
            trials = np.clip(mutants(values, settings, rng), low, high)
            trial_errors = errors_of(problem, trials)
            is_better = trial_errors <= errors
            values = np.where(is_better[:, None], trials, values)
            errors = np.where(is_better, trial_errors, errors)
            clock.offer(values, errors, f"generation {generation + 1}")
    except KeyboardInterrupt:
        clock.was_stopped = True
    return clock.result([])


def mutants(values: np.ndarray, settings: Settings, rng: np.random.Generator) -> np.ndarray:
    """V crossed with its own target, [candidates, variables]; one entry at least is of V."""
    count, variables = values.shape
    target = np.arange(count)
    # Two others, different from the target and from each other.
    first = (target + rng.integers(1, count, count)) % count
    second = (target + rng.integers(1, count - 1, count)) % count
    lower = (first - target) % count
    second = np.where((second - target) % count >= lower, (second + 1) % count, second)
    moved = values + settings.mutation * (values[first] - values[second])
    is_crossed = rng.random(values.shape) < settings.crossover
    is_crossed[target, rng.integers(variables, size=count)] = True
    return np.where(is_crossed, moved, values)
