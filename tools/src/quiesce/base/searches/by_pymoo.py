"""Searches of pymoo, which is an extra: particle swarm (adaptive inertia and attractions),
covariance matrix adaptation, evolution strategy. One that ends begins anew from random points."""

from collections.abc import Callable, Generator
from typing import Any

import numpy as np

from quiesce.base.extras import extra

SEARCH = ("search", "--method pso, cmaes or es")
Points = Generator[np.ndarray, np.ndarray, None]


def require_pymoo() -> None:
    """UsageError where it is not there: before a search, not in it."""
    with extra(*SEARCH):
        import pymoo  # noqa: F401


def pso(first: np.ndarray, rng: np.random.Generator) -> Points:
    """Particle swarm."""
    with extra(*SEARCH):
        from pymoo.algorithms.soo.nonconvex.pso import PSO

    return again(lambda points: PSO(pop_size=len(points), sampling=points), first, rng)


def cmaes(first: np.ndarray, rng: np.random.Generator) -> Points:
    """Covariance matrix adaptation, from the first point."""
    with extra(*SEARCH):
        from pymoo.algorithms.soo.nonconvex.cmaes import CMAES

    return again(
        lambda points: CMAES(x0=points[0], sigma=0.3, popsize=len(points), normalize=False),
        first,
        rng,
    )


def es(first: np.ndarray, rng: np.random.Generator) -> Points:
    """Evolution strategy with self-adapted steps."""
    with extra(*SEARCH):
        from pymoo.algorithms.soo.nonconvex.es import ES

    parents = max(2, len(first) // 7)
    return again(
        lambda points: ES(n_offsprings=len(points), pop_size=parents, sampling=points[:parents]),
        first,
        rng,
    )


def again(make: Callable[[np.ndarray], Any], first: np.ndarray, rng: np.random.Generator) -> Points:
    points = first
    while True:
        yield from asked(make(points), first.shape[1], rng)
        points = rng.random(first.shape)


def asked(algorithm: Any, dimensions: int, rng: np.random.Generator) -> Points:
    """What the algorithm asks for and is told, until it ends."""
    with extra(*SEARCH):
        from pymoo.core.problem import Problem
        from pymoo.core.termination import NoTermination

    problem = Problem(n_var=dimensions, n_obj=1, xl=0.0, xu=1.0)
    algorithm.setup(problem, termination=NoTermination(), seed=int(rng.integers(1 << 31)))
    while algorithm.has_next():
        asked_for = algorithm.ask()
        points = np.clip(asked_for.get("X").astype(float), 0.0, 1.0)
        costs = yield points
        asked_for.set("F", np.where(np.isfinite(costs), costs, 1e9)[:, None])
        algorithm.tell(infills=asked_for)
