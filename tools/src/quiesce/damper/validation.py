"""What the folds say of a model: an error for each kind of new data, one number to choose by, and
in how many of many redrawn validations one model comes before another.

The number is the geometric mean over the kinds of the mean over their folds: a kind that is hard
for all models then counts no more than one in which they are all good.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from quiesce.damper.data.folds import Fold
from quiesce.damper.data.split import Segment
from quiesce.damper.score import Simulate

# Blocks that a validated test is cut into: neighbouring rows err together.
BLOCKS = 12
_LEAST_BLOCK_ROWS = 4
# Redrawn validations behind a share.
DRAWS = 2000
_SEED = 26


@dataclass(frozen=True)
class Blocks:
    """One validated test: sums of squares over its blocks in N2, [blocks]."""

    error_N2: tuple[float, ...]
    force_N2: tuple[float, ...]

    @property
    def error(self) -> float:
        """||F - F_model|| / ||F||."""
        return float(np.sqrt(sum(self.error_N2) / max(sum(self.force_N2), 1e-300)))


@dataclass(frozen=True)
class FoldScore:
    """A refit without a fold's validation rows, on them."""

    kind: str  # of data.folds.STANDS_FOR
    left_out: str
    tests: tuple[Blocks, ...]

    @property
    def error(self) -> float:
        """Mean over the tests of their own errors."""
        return float(np.mean([one.error for one in self.tests]))


def fold_score(fold: Fold, forces_N: Sequence[np.ndarray]) -> FoldScore:
    """forces_N: the model's at the rows of each validation segment."""
    tests = [
        blocks_of(segment.record.force_N[segment.rows], force_N)
        for segment, force_N in zip(fold.validation, forces_N, strict=True)
    ]
    return FoldScore(fold.kind, fold.left_out, tuple(tests))


def forces_on(simulate: Simulate, segments: Sequence[Segment]) -> list[np.ndarray]:
    """The model's force in N at the rows of each segment, run free from its record's first row and
    averaged as the file's was."""
    whole: dict[int, np.ndarray] = {}
    for one in segments:
        if id(one.record) not in whole:
            whole[id(one.record)] = one.record.averaged(simulate(one.record))
    return [whole[id(one.record)][one.rows] for one in segments]


def blocks_of(measured_N: np.ndarray, model_N: np.ndarray) -> Blocks:
    """A model that diverges has infinite errors."""
    count = max(1, min(BLOCKS, len(measured_N) // _LEAST_BLOCK_ROWS))
    edges = np.linspace(0, len(measured_N), count + 1).round().astype(int)[:-1]
    with np.errstate(all="ignore"):
        squares = (model_N - measured_N) ** 2
    squares = np.where(np.isfinite(squares), squares, np.inf)
    return Blocks(
        tuple(map(float, np.add.reduceat(squares, edges))),
        tuple(map(float, np.add.reduceat(measured_N**2, edges))),
    )


def errors_by_kind(folds: Sequence[FoldScore]) -> dict[str, float]:
    """Mean over each kind's folds."""
    kinds = dict.fromkeys(one.kind for one in folds)
    return {
        kind: float(np.mean([one.error for one in folds if one.kind == kind])) for kind in kinds
    }


def overall(by_kind: Mapping[str, float]) -> float:
    """Geometric mean."""
    return float(np.exp(np.mean(np.log(np.maximum(list(by_kind.values()), 1e-300)))))


# Redrawn validations


def redrawn(folds: Sequence[FoldScore]) -> np.ndarray:
    """The overall error of DRAWS validations in which the folds of a kind, and the blocks of every
    test, are drawn anew with replacement: [draws]. Models with the same folds get the same draws,
    so that theirs can be compared draw by draw."""
    kinds = dict.fromkeys(one.kind for one in folds)
    logs = np.zeros(DRAWS)
    for number, kind in enumerate(kinds):
        own = [one for one in folds if one.kind == kind]
        errors = np.stack([fold_draws(one, (number, k)) for k, one in enumerate(own)])
        picked = drawn(len(own), len(own), (number,))
        means = np.take_along_axis(errors, picked, axis=0).mean(axis=0)
        logs += np.log(np.maximum(means, 1e-300)) / len(kinds)
    return np.exp(logs)


def fold_draws(fold: FoldScore, key: tuple[int, ...]) -> np.ndarray:
    """Errors of a fold, its tests' blocks drawn anew: [draws]."""
    errors = []
    for k, one in enumerate(fold.tests):
        picked = drawn(len(one.error_N2), len(one.error_N2), (*key, k))
        error_N2, force_N2 = np.array(one.error_N2), np.array(one.force_N2)
        sums = error_N2[picked].sum(axis=0) / np.maximum(force_N2[picked].sum(axis=0), 1e-300)
        errors.append(np.sqrt(sums))
    return np.mean(errors, axis=0)


@lru_cache(maxsize=256)
def drawn(size: int, count: int, key: tuple[int, ...]) -> np.ndarray:
    """Numbers below `size`, [count, draws]."""
    return np.random.default_rng([_SEED, *key]).integers(0, size, (count, DRAWS))


def share_before(one: Sequence[FoldScore], other: Sequence[FoldScore]) -> float | None:
    """Part of the draws in which `one` has the smaller error; None where their folds differ, or
    there are none."""
    if not one or shape_of(one) != shape_of(other):
        return None
    with np.errstate(invalid="ignore"):
        first, second = redrawn(one), redrawn(other)
    return float(np.mean(first < second) + 0.5 * np.mean(first == second))


def shape_of(folds: Sequence[FoldScore]) -> list[tuple[str, str, tuple[int, ...]]]:
    return [
        (one.kind, one.left_out, tuple(len(test.error_N2) for test in one.tests)) for one in folds
    ]
