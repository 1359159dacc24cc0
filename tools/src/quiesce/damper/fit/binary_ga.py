"""A binary genetic algorithm as published for dampers (squeeze mode, Bouc-Wen and biviscous).

A chromosome holds one code of `bits` bits a variable; a code counts evenly from the lowest value of
the search range to the highest, by their logarithm where a positive range is wide. Published:
coding, selection by fitness, crossover, mutation, a constant population. Not published, and chosen
here: the Settings, Gray codes, tournaments of two, one-point crossover, elitism, the logarithm.

Ours, too: epochs. A code changes one variable at a time, so that where two can stand in for each
other a population settles beside the optimum. So each epoch begins anew in ranges that are narrower
and lie about the best so far. PLAIN leaves that out. No least squares: both end at a code.
"""

from dataclasses import dataclass

import numpy as np

from quiesce.damper.fit.population import errors_of, values_of
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.search import EFFORT, Clock, Effort, Fit, Progress


@dataclass(frozen=True)
class Settings:
    bits: int = 12  # a variable
    population: int = 60
    generations: int = 200  # of all epochs
    crossover: float = 0.8  # probability of a pair
    elite: int = 1  # best ones that stay as they are
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
    genes = rng.random((settings.population, settings.bits * len(problem.variables))) < 0.5
    generations = settings.generations // settings.epochs
    for generation in range(generations + 1):
        values = decoded(problem, genes, settings.bits, window)
        errors = errors_of(problem, values)
        clock.offer(values, errors, f"generation {generation}")
        if generation == generations or clock.is_over():
            break
        genes = next_generation(genes, errors, settings, rng)


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
    gray = genes.reshape(len(genes), -1, bits)
    binary = np.logical_xor.accumulate(gray, axis=2)
    codes = binary @ (1 << np.arange(bits)[::-1])
    parts = window.low + (window.high - window.low) * codes / ((1 << bits) - 1)
    return values_of(problem, parts)


def next_generation(
    genes: np.ndarray, errors: np.ndarray, settings: Settings, rng: np.random.Generator
) -> np.ndarray:
    """Tournaments, one-point crossover of neighbours, mutation of a bit a chromosome on average."""
    count, length = genes.shape
    rivals = rng.integers(count, size=(2, count))
    winners = np.where(errors[rivals[0]] <= errors[rivals[1]], rivals[0], rivals[1])
    out = genes[winners].copy()
    for first in range(0, count - 1, 2):
        if rng.random() < settings.crossover:
            cut = rng.integers(1, length)
            pair = out[first : first + 2, cut:].copy()
            out[first : first + 2, cut:] = pair[::-1]
    out ^= rng.random(out.shape) < 1.0 / length
    best = np.argsort(errors)[: settings.elite]
    out[: settings.elite] = genes[best]
    return out
