"""A binary genetic algorithm as published for dampers (squeeze mode, Bouc-Wen and biviscous).

A chromosome holds one code of `bits` bits a variable; a code counts evenly from the lowest value of
the search range to the highest, by their logarithm where a positive range is wide. Published:
coding, selection by fitness, crossover, mutation, a constant population. Not published, and chosen
here: the Settings, Gray codes, tournaments of two, one-point crossover, elitism, the logarithm. It
ends where the paper's does, at the resolution of a code. A code changes one variable at a time, so
that where two can stand in for each other it stays beside the optimum: `fit_polished_ga` goes on
from there by least squares, which is not the paper's.
"""

from dataclasses import dataclass

import numpy as np

from quiesce.damper.fit.population import errors_of
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.search import EFFORT, Clock, Effort, Fit, Progress, polish_all


@dataclass(frozen=True)
class Settings:
    bits: int = 12  # a variable
    population: int = 60
    generations: int = 200
    crossover: float = 0.8  # probability of a pair
    elite: int = 1  # best ones that stay as they are


PUBLISHED = Settings()


def fit_binary_ga(
    problem: Problem,
    seed: int,
    effort: Effort = EFFORT,
    progress: Progress | None = None,
    settings: Settings = PUBLISHED,
) -> Fit:
    """Of `effort` counts only when to stop (seconds, stop); size and length are in the settings.
    Ctrl-C ends it with the best so far."""
    clock = Clock(problem, effort, progress)
    rng = np.random.default_rng(seed)
    length = settings.bits * len(problem.variables)
    genes = rng.random((settings.population, length)) < 0.5
    try:
        for generation in range(settings.generations + 1):
            values = decoded(problem, genes, settings.bits)
            errors = errors_of(problem, values)
            clock.offer(values, errors, f"generation {generation}")
            if generation == settings.generations or clock.is_over():
                break
            genes = next_generation(genes, errors, settings, rng)
    except KeyboardInterrupt:
        clock.was_stopped = True
    return clock.result([])


def fit_polished_ga(
    problem: Problem, seed: int, effort: Effort = EFFORT, progress: Progress | None = None
) -> Fit:
    """The genetic algorithm, then least squares from its best."""
    clock = Clock(problem, effort, progress)
    found = fit_binary_ga(problem, seed, effort, progress)
    clock.was_stopped = not found.is_complete
    clock.offer(found.values[None, :], np.array([found.error]), "polishing")
    return clock.result(polish_all(problem, found.values[None, :], effort, clock))


def decoded(problem: Problem, genes: np.ndarray, bits: int) -> np.ndarray:
    """Values [candidates, variables] from genes [candidates, variables * bits]."""
    gray = genes.reshape(len(genes), -1, bits)
    binary = np.logical_xor.accumulate(gray, axis=2)
    codes = binary @ (1 << np.arange(bits)[::-1])
    parts = codes / ((1 << bits) - 1)
    columns = [one.to_value(part) for one, part in zip(problem.variables, parts.T, strict=True)]
    return np.stack(columns, axis=1)


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
