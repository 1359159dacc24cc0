"""The one search for all laws: points spread evenly, then differential evolution from the best."""

from collections.abc import Callable

import numpy as np
from scipy.optimize import differential_evolution
from scipy.stats import qmc

# Points [n d] -> costs [n], inf where refused. One that was asked for before costs no trial.
Evaluate = Callable[[np.ndarray], np.ndarray]

POPULATION = 8  # 5 is the least of differential evolution
SPREAD_SHARE = 0.5  # of the trials
REFUSED = 1e9  # a finite cost: differential evolution takes differences


def spread(count: int, dimensions: int, seed: int) -> np.ndarray:
    """Scrambled points of Sobol's sequence in the unit cube; more of them begin with the same."""
    power = int(np.ceil(np.log2(max(count, 1))))
    return qmc.Sobol(dimensions, rng=seed).random_base2(power)[:count]


def search(evaluate: Evaluate, first: np.ndarray, trials: int, seed: int) -> None:
    """At most so many trials, the first point among them. All chance comes from the seed, and the
    points of a generation are asked for at once: it does not matter how many run at a time."""
    dimensions = len(first)
    if dimensions == 0 or trials <= 0:
        return
    generations = int((1.0 - SPREAD_SHARE) * trials) // POPULATION
    even = spread(trials - 1 - generations * POPULATION, dimensions, seed)
    points = np.vstack([first, even])
    costs = evaluate(points)
    if generations == 0:
        return

    def generation(transposed: np.ndarray) -> np.ndarray:
        found = evaluate(np.atleast_2d(transposed.T))
        return np.where(np.isfinite(found), found, REFUSED)

    differential_evolution(
        generation, [(0.0, 1.0)] * dimensions,
        init=points[np.argsort(costs, kind="stable")[:POPULATION]], maxiter=generations, tol=0.0,
        mutation=(0.4, 0.9), polish=False, updating="deferred", vectorized=True, rng=seed,
    )  # fmt: skip
