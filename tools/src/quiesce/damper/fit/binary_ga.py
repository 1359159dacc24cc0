"""A binary genetic algorithm as published for dampers (squeeze mode, Bouc-Wen and biviscous).

A chromosome holds one code of `bits` bits a variable; a code counts evenly from the lowest value of
the search range to the highest, by their logarithm where a positive range is wide. Published:
coding, selection by fitness, crossover, mutation, the less fit of parents and offspring eliminated.
Not published, and chosen here: the Settings, Gray codes, tournaments of two, one-point crossover,
one bit flipped a chromosome on average, the logarithm. The algorithm is pymoo's.

Ours, too: epochs. A code changes one variable at a time, so that where two can stand in for each
other a population settles beside the optimum, where depends on the seed and on the last bit of the
processor's arithmetic. So each epoch begins anew in ranges that are narrower, lie about the best so
far and along the directions in which the best differ most and least. PLAIN leaves that out. No
least squares: both end at a code.
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
    narrowing: float = 0.7  # of the longest range, from epoch to epoch
    slenderness: float = 0.3  # of the shortest range, of the longest, at least


NARROWING = Settings()
PLAIN = Settings(epochs=1)


@dataclass(frozen=True)
class Window:
    """What codes count through, in search coordinates 0 .. 1: about `centre` [variables], along the
    columns of `axes` [variables, variables], each as long as its range."""

    centre: np.ndarray
    axes: np.ndarray

    def parts(self, shares: np.ndarray) -> np.ndarray:
        """Search coordinates from shares 0 .. 1 of the ranges, [candidates, variables] each."""
        return np.clip(self.centre + (shares - 0.5) @ self.axes.T, 0.0, 1.0)


class Elite:
    """The best of all that were tried, all different, the best of them first: `parts` [at most
    `size`, variables]."""

    def __init__(self, size: int, variables: int) -> None:
        self.size = size
        self.parts = np.empty((0, variables))
        self.errors = np.empty(0)

    def offer(self, parts: np.ndarray, errors: np.ndarray) -> None:
        finite = np.isfinite(errors)
        every, first = np.unique(
            np.concatenate([self.parts, parts[finite]]), axis=0, return_index=True
        )
        errors = np.concatenate([self.errors, errors[finite]])[first]
        order = np.argsort(errors, kind="stable")[: self.size]
        self.parts, self.errors = every[order], errors[order]


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
    elite = Elite(settings.population, len(problem.variables))
    try:
        for epoch in range(settings.epochs):
            evolve(problem, window, settings, rng, clock, elite)
            if clock.is_over() or clock.best is None:
                break
            length = settings.narrowing ** (epoch + 1)
            window = window_of(elite.parts, length, settings.slenderness)
    except KeyboardInterrupt:
        clock.was_stopped = True
    return clock.result([])


def fit_plain_ga(
    problem: Problem, seed: int, effort: Effort = EFFORT, progress: Progress | None = None
) -> Fit:
    """In one epoch."""
    return fit_binary_ga(problem, seed, effort, progress, PLAIN)


def evolve(
    problem: Problem,
    window: Window,
    settings: Settings,
    rng: np.random.Generator,
    clock: Clock,
    elite: Elite,
) -> None:
    """One epoch, from a random population."""
    from quiesce.base.searches import by_pymoo  # slow to load

    first = rng.random((settings.population, settings.bits * len(problem.variables))) < 0.5
    search = by_pymoo.ga(first, rng, settings.crossover)
    genes = next(search)
    generations = settings.generations // settings.epochs
    for generation in range(generations + 1):
        parts = window.parts(decoded(genes, settings.bits))
        values = values_of(problem, parts)
        errors = errors_of(problem, values)
        elite.offer(parts, errors)
        clock.offer(values, errors, f"generation {generation}")
        if generation == generations or clock.is_over():
            break
        genes = search.send(errors)


def whole_range(problem: Problem) -> Window:
    count = len(problem.variables)
    return Window(np.full(count, 0.5), np.eye(count))


def window_of(parts: np.ndarray, length: float, slenderness: float) -> Window:
    """About the first of the best [several, variables], along the principal axes of how the others
    differ from it: `length` where they differ most, down to `slenderness` of that where least."""
    apart = parts - parts[0]
    squares, directions = np.linalg.eigh(apart.T @ apart)
    spreads = np.sqrt(np.maximum(squares, 0.0))
    most = spreads.max()
    ratios = np.maximum(spreads / most, slenderness) if most > 0.0 else np.ones(len(spreads))
    return Window(parts[0], directions * (length * ratios))


def decoded(genes: np.ndarray, bits: int) -> np.ndarray:
    """Shares 0 .. 1 of the ranges [candidates, variables] from genes [candidates, variables *
    bits]."""
    return numbers_of(genes.reshape(len(genes), -1, bits)) / ((1 << bits) - 1)
