"""Takagi-Sugeno model with clusters as rules: the clusters by k-means, then one least squares for
the linear forces of all rules together."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.cluster.vq import kmeans2

from quiesce.damper.data.split import Segment
from quiesce.damper.learned.inputs import Box, input_keys, stacked
from quiesce.damper.learned.model import LearnedDamper, Report, limits_of, silent
from quiesce.damper.library import Scales

_LEAST_WIDTH = 0.05


@dataclass(frozen=True)
class Settings:
    rules: int = 16
    overlap: float = 0.7  # width of a cluster in distances to its nearest neighbours
    ridge: float = 1e-6


# Of --effort quick, and what stands where time runs out.
BRIEF = Settings()


@dataclass(frozen=True)
class Clusters:
    """centres and widths [rules, inputs], scaled."""

    centres: np.ndarray
    widths: np.ndarray

    def weights(self, u: np.ndarray) -> np.ndarray:
        """Normalised, [rows, rules]."""
        distance = (u[:, None, :] - self.centres) / self.widths
        exponents = -0.5 * np.sum(distance**2, axis=2)
        weights = np.exp(exponents - exponents.max(axis=1, keepdims=True))
        return weights / weights.sum(axis=1, keepdims=True)

    def regressors(self, u: np.ndarray) -> np.ndarray:
        """Force for a unit of each gain and offset, [rows, rules * (inputs + 1)]."""
        ones = np.concatenate([u, np.ones((len(u), 1))], axis=1)
        return (self.weights(u)[:, :, None] * ones[:, None, :]).reshape(len(u), -1)


def clusters_of(u: np.ndarray, settings: Settings, seed: int) -> Clusters:
    count = min(settings.rules, len(u))
    centres, _ = kmeans2(u, count, iter=40, minit="++", seed=np.random.default_rng(seed))
    apart = np.linalg.norm(centres[:, None, :] - centres[None, :, :], axis=2)
    neighbours = np.sort(apart, axis=1)[:, 1 : 1 + max(1, u.shape[1])]
    width = np.maximum(settings.overlap * neighbours.mean(axis=1), _LEAST_WIDTH)
    return Clusters(centres, np.repeat(width[:, None], u.shape[1], axis=1))


def train(
    segments: Sequence[Segment],
    scales: Scales,
    seed: int = 0,
    settings: Settings | None = None,
    progress: Report = silent,
) -> LearnedDamper:
    settings = settings or Settings()
    box = Box.of(segments, input_keys(segments))
    u, force_N = stacked(segments, box)
    clusters = clusters_of(u, settings, seed)
    a = clusters.regressors(u)
    gram = a.T @ a
    mean_square = np.trace(gram) / len(gram)
    solved = np.linalg.solve(gram + settings.ridge * mean_square * np.eye(len(gram)), a.T @ force_N)
    conclusions = solved.reshape(len(clusters.centres), -1)
    progress(f"ts_fuzzy: {len(conclusions)} rules")
    rules = [
        {
            "centre": centre.tolist(),
            "width": width.tolist(),
            "gain_N": conclusion[:-1].tolist(),
            "offset_N": float(conclusion[-1]),
        }
        for centre, width, conclusion in zip(
            clusters.centres, clusters.widths, conclusions, strict=True
        )
    ]
    return LearnedDamper(
        "ts_fuzzy",
        **limits_of(scales),
        parameters={**box.tables(), "rule": rules},
        parameter_count=solved.size + clusters.centres.size + len(rules),
        notes=(f"{len(rules)} rules around clusters of the inputs",),
    )
