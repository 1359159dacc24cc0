"""pymoo's searches: a genetic algorithm and NSGA-II over strings of bits; differential evolution,
particle swarm, covariance matrix adaptation and an evolution strategy over the unit cube.

Each is a generator of points [any, dimensions] that is sent their costs, [any] or [any,
objectives], for ever: where an algorithm ends, it begins anew from random points. Loading pymoo
takes a quarter of a second: load this module when a search begins.
"""

from collections.abc import Callable, Generator
from typing import Any

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.algorithms.soo.nonconvex.cmaes import SimpleCMAES
from pymoo.algorithms.soo.nonconvex.de import DE
from pymoo.algorithms.soo.nonconvex.es import ES
from pymoo.algorithms.soo.nonconvex.ga import GA, comp_by_cv_and_fitness
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.config import Config
from pymoo.core.problem import Problem
from pymoo.core.selection import Selection
from pymoo.core.termination import NoTermination
from pymoo.operators.crossover.spx import SPX
from pymoo.operators.mutation.bitflip import BitflipMutation
from pymoo.operators.selection.tournament import TournamentSelection
from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

Config.warnings.update(not_compiled=False)  # else pymoo prints a banner

Points = Generator[np.ndarray, np.ndarray, None]
REFUSED = 1e9  # a finite cost for what diverged: some algorithms take differences

# Of differential evolution; pymoo's own mutation of its trials, which the papers do not have, is
# left out.
DE_VARIANT, DE_SCALE, DE_CROSSOVER = "DE/best/1/bin", 0.75, 0.7
CMAES_SIGMA, CMAES_TOLERANCE = 0.3, 1e-11


class Roulette(Selection):
    """Parents with chances in proportion to what each is better than the worst."""

    def _do(
        self,
        _problem: Problem,
        people: Any,
        matings: int,
        parents: int,
        random_state: np.random.Generator,
        **_more: Any,
    ) -> np.ndarray:
        shares = roulette_shares(people.get("F")[:, 0])
        return random_state.choice(len(people), (matings, parents), p=shares)


def roulette_shares(costs: np.ndarray) -> np.ndarray:
    """Equal ones where all costs are."""
    fitness = costs.max() - costs
    total = fitness.sum()
    return fitness / total if total > 0 else np.full(len(costs), 1.0 / len(costs))


def ga(
    first: np.ndarray, rng: np.random.Generator, crossover: float, is_roulette: bool = False
) -> Points:
    """first: bits. Tournaments of two or a roulette, crossover at one point with that chance, each
    bit flips with 1 / number of bits; the best of parents and children stay."""
    selection = Roulette() if is_roulette else TournamentSelection(comp_by_cv_and_fitness)
    return again(lambda bits: GA(selection=selection, **genetic(bits, crossover)), first, rng)


def nsga2(first: np.ndarray, rng: np.random.Generator, crossover: float) -> Points:
    """Several objectives at once, over bits as `ga`."""
    return again(lambda bits: NSGA2(**genetic(bits, crossover)), first, rng)


def genetic(bits: np.ndarray, crossover: float) -> dict[str, Any]:
    return {
        "pop_size": len(bits), "sampling": bits,
        "crossover": SPX(prob=crossover), "mutation": BitflipMutation(),
    }  # fmt: skip


def de(first: np.ndarray, rng: np.random.Generator) -> Points:
    """Differential evolution."""
    figures = {"F": DE_SCALE, "CR": DE_CROSSOVER, "prob_mut": 0.0}
    return again(
        lambda points: DE(len(points), sampling=points, variant=DE_VARIANT, **figures), first, rng
    )


def pso(first: np.ndarray, rng: np.random.Generator) -> Points:
    """Particle swarm with adaptive inertia and attractions."""
    return again(lambda points: PSO(pop_size=len(points), sampling=points), first, rng)


def cmaes(first: np.ndarray, rng: np.random.Generator) -> Points:
    """Covariance matrix adaptation, from the first point. (Of pymoo's two, CMAES would take Ctrl-C
    for an end of its own.)"""
    options = {
        "popsize": len(first), "tolfun": CMAES_TOLERANCE, "tolx": CMAES_TOLERANCE,
        "verbose": -9, "verb_log": 0,
        # Its own draws from numpy's one generator, which other threads share.
        "randn": lambda *shape: rng.standard_normal(shape),
    }  # fmt: skip
    return again(
        lambda points: SimpleCMAES(
            x0=points[0], sigma=CMAES_SIGMA, opts=dict(options), normalize=False
        ),
        first,
        rng,
    )


def es(first: np.ndarray, rng: np.random.Generator) -> Points:
    """Evolution strategy with self-adapted steps."""
    parents = max(2, len(first) // 7)
    return again(
        lambda points: ES(n_offsprings=len(points), pop_size=parents, sampling=points[:parents]),
        first,
        rng,
    )


def again(make: Callable[[np.ndarray], Any], first: np.ndarray, rng: np.random.Generator) -> Points:
    """The algorithm from the first points, then from random ones whenever it has ended."""
    points = first
    while True:
        yield from asked(make(points), first.shape[1], rng)
        drawn = rng.random(first.shape)
        points = drawn < 0.5 if first.dtype == bool else drawn


def asked(algorithm: Any, dimensions: int, rng: np.random.Generator) -> Points:
    """What the algorithm asks for and is told, until it ends."""
    problem = Problem(n_var=dimensions, xl=0.0, xu=1.0)
    # Not 0: covariance matrix adaptation would take the time of day for its seed.
    seed = int(rng.integers(1, 1 << 31))
    algorithm.setup(problem, termination=NoTermination(), seed=seed)
    # An algorithm that finds nothing new asks for nothing.
    while algorithm.has_next() and (asked_for := algorithm.ask()) is not None:
        points = asked_for.get("X")
        if points.dtype != bool:
            points = np.clip(points.astype(float), 0.0, 1.0)
        costs = (yield points).reshape(len(points), -1)
        problem.n_obj = costs.shape[1]
        asked_for.set("F", np.where(np.isfinite(costs), costs, REFUSED))
        algorithm.tell(infills=asked_for)


def front(costs: np.ndarray) -> np.ndarray:
    """Indices of costs [any, objectives] that no other is at least as good as everywhere and better
    than somewhere."""
    return np.sort(NonDominatedSorting().do(costs, only_non_dominated_front=True))
