"""Which elements of many a bank is made of, and what they weigh in each of its models.

Weights are the least squares that are not negative. Elements are added one by one, each the one
that is best beside those that are there, then exchanged; all of it on the products of the signals,
[signals, signals], so that the ticks are summed once.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

RIDGE = 1e-9  # of a signal's mean square: two that are nearly the same share what they weigh
LEAST_GAIN = 0.01  # of the error: an element that takes less away is not worth its instructions
TRIED = 10  # of those that promise most by the slope of the error
FLOOR = 1.0  # of the largest model's mean square: a small force may be missed by as much


@dataclass(frozen=True)
class Products:
    """Means over all ticks, of signals that have been scaled to 1: among signals, with the forces
    of each model [models, signals], of the forces themselves [models]."""

    of_signals: np.ndarray
    with_force: np.ndarray
    of_force: np.ndarray
    scale: np.ndarray  # that each signal was divided by

    @classmethod
    def of(cls, signals: np.ndarray, force_N: np.ndarray) -> "Products":
        """Signals [ticks, signals], forces [models, ticks]."""
        size = np.sqrt(np.mean(signals**2, axis=0))
        scale = np.where(size > 0.0, size, 1.0)
        scaled = signals / scale
        count = len(signals)
        return cls(
            scaled.T @ scaled / count, force_N @ scaled / count, np.mean(force_N**2, axis=1), scale
        )

    @property
    def importance(self) -> np.ndarray:
        return 1.0 / (self.of_force + FLOOR * self.of_force.max())

    def fitted(self, chosen: Sequence[int]) -> tuple[float, np.ndarray]:
        """The error, its parts weighted by importance, and weights [models, chosen] of scaled
        signals."""
        from scipy.optimize import nnls

        inner = self.of_signals[np.ix_(chosen, chosen)] + RIDGE * np.eye(len(chosen))
        lower = np.linalg.cholesky(inner)
        outer = self.with_force[:, chosen]
        sides = np.linalg.solve(lower, outer.T)
        weights = np.stack([nnls(lower.T, side)[0] for side in sides.T])
        left = self.of_force - 2.0 * np.sum(weights * outer, axis=1)
        left += np.einsum("ki,ij,kj->k", weights, inner, weights)
        return float(np.sum(self.importance * left)), weights

    def promising(self, chosen: Sequence[int], weights: np.ndarray, others: np.ndarray) -> list:
        """The others beside which most of the error would go, by its slope, best first."""
        slope = self.with_force[:, others] - weights @ self.of_signals[np.ix_(chosen, others)]
        gain = self.importance @ np.maximum(slope, 0.0) ** 2
        return [int(others[i]) for i in np.argsort(-gain)[:TRIED]]


def choose(
    products: Products, always: Sequence[int], candidates: Sequence[int], most: int
) -> tuple[float, list[int], np.ndarray]:
    """At most `most` of the candidates, at least one, beside those that are always there. Error,
    which ones, weights [models, always + chosen] of the signals as they were."""
    chosen: list[int] = []
    error, weights = products.fitted(always)
    while len(chosen) < most:
        found = best_beside(products, [*always, *chosen], weights, candidates)
        if found is None or (chosen and found[0] > (1.0 - LEAST_GAIN) * error):
            break
        chosen.append(found[1])
        error, weights = products.fitted([*always, *chosen])
    for one in list(chosen):
        rest = [other for other in chosen if other != one]
        _, without = products.fitted([*always, *rest])
        found = best_beside(products, [*always, *rest], without, candidates)
        if found is not None and found[0] < error:
            chosen = [*rest, found[1]]
            error, weights = products.fitted([*always, *chosen])
    return error, chosen, weights / products.scale[[*always, *chosen]]


def best_beside(
    products: Products, chosen: Sequence[int], weights: np.ndarray, candidates: Sequence[int]
) -> tuple[float, int] | None:
    """Error and candidate; None where all are chosen."""
    others = np.array([one for one in candidates if one not in chosen], dtype=int)
    if not len(others):
        return None
    return min(
        (products.fitted([*chosen, one])[0], one)
        for one in products.promising(chosen, weights, others)
    )
