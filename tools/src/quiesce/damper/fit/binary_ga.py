"""A binary genetic algorithm as published for dampers (squeeze mode, Bouc-Wen and biviscous).

A chromosome holds one code of `bits` bits a variable; a code counts evenly from the lowest value of
the search range to the highest, by their logarithm where a positive range is wide. Published:
coding, selection by fitness, crossover, mutation, the less fit of parents and offspring eliminated.
Not published, and chosen here: the Settings, Gray codes, tournaments of two, one-point crossover,
one bit flipped a chromosome on average, the logarithm. The algorithm is pymoo's.

Ours, too: epochs. A code changes one variable at a time, so that where two can stand in for each
other a population settles beside the optimum. So each epoch begins anew in ranges that are narrower
and lie about the best so far. PLAIN leaves that out. No least squares: both end at a code.
"""

from dataclasses import dataclass

import numpy as np

from quiesce.base.searches.gray import numbers_of
from quiesce.damper.fit.population import errors_of, values_of
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.search import EFFORT, Clock, Effort, Fit, Progress


@dataclass(frozen=True)
class Settings:
    bits: int = 12  # a variable
    population: int = 60
    generations: int = 200  # of all epochs
    crossover: float = 0.8  # probability of a pair
    epochs: int = 10
    narrowing: float = 0.7  # of the ranges, from epoch to epoch


NARROWING = Settings()
PLAIN = Settings(epochs=1)


@dataclass(frozen=True)
class Window:
    """What codes count through, in search coordinates 0 .. 1, [variables] each."""

    low: np.ndarray
    high: np.ndarray


def fit_binary_ga(
    problem: Problem,
    seed: int,
    effort: Effort = EFFORT,
    progress: Progress | None = None,
    settings: Settings = NARROWING,
) -> Fit:
    """Of `effort` counts only when to stop (seconds, stop); size and length are in the settings.
    Ctrl-C ends it with the best so far."""
    clock = Clock(problem, effort, progress)
    rng = np.random.default_rng(seed)
    window = whole_range(problem)
    try:
        for epoch in range(settings.epochs):
            evolve(problem, window, settings, rng, clock)
            if clock.is_over() or clock.best is None:
                break
            window = window_about(problem, clock.best, settings.narrowing ** (epoch + 1))
    except KeyboardInterrupt:
        clock.was_stopped = True
    return clock.result([])


def fit_plain_ga(
    problem: Problem, seed: int, effort: Effort = EFFORT, progress: Progress | None = None
) -> Fit:
    """In one epoch."""
    return fit_binary_ga(problem, seed, effort, progress, PLAIN)


def evolve(
    problem: Problem, window: Window, settings: Settings, rng: np.random.Generator, clock: Clock
) -> None:
    """One epoch, from a random population."""
    from quiesce.base.searches import by_pymoo  # slow to load

    first = rng.random((settings.population, settings.bits * len(problem.variables))) < 0.5
    search = by_pymoo.ga(first, rng, settings.crossover)
    genes = next(search)
    generations = settings.generations // settings.epochs
    for generation in range(generations + 1):
        values = decoded(problem, genes, settings.bits, window)
        errors = errors_of(problem, values)
        clock.offer(values, errors, f"generation {generation}")
        if generation == generations or clock.is_over():
            break
        genes = search.send(errors)


def whole_range(problem: Problem) -> Window:
    count = len(problem.variables)
    return Window(np.zeros(count), np.ones(count))


def window_about(problem: Problem, values: np.ndarray, width: float) -> Window:
    """Of this width about the values, as far as the search ranges go."""
    parts = [
        float(one.to_part(value)) for one, value in zip(problem.variables, values, strict=True)
    ]
    low = np.clip(np.array(parts) - 0.5 * width, 0.0, 1.0)
    high = np.clip(np.array(parts) + 0.5 * width, 0.0, 1.0)
    return Window(low, high)


def decoded(problem: Problem, genes: np.ndarray, bits: int, window: Window) -> np.ndarray:
    """Values [candidates, variables] from genes [candidates, variables * bits]."""
    codes = numbers_of(genes.reshape(len(genes), -1, bits))
    parts = window.low + (window.high - window.low) * codes / ((1 << bits) - 1)
    return values_of(problem, parts)
