"""Which factors a figure depends on: Morris' elementary effects and Sobol's indices.

Sobol's are scipy's. Morris' are the few lines that they are: a path with a failed run is left out,
which libraries that want all values do not do.
"""

from dataclasses import dataclass

import numpy as np

from quiesce.campaign.design import MORRIS, SALTELLI, Design

INTERVAL_95 = (0.025, 0.975)
RESAMPLES = 200
# With fewer there is no interval to speak of.
LEAST_BASE = 8
LEAST_PATHS = 2


@dataclass(frozen=True)
class Sensitivity:
    """head: what the values are; a row a factor. note: on how many samples it stands."""

    head: tuple[str, ...]
    rows: dict[str, tuple[float, ...]]
    note: str


def sensitivity(design: Design, values: np.ndarray) -> Sensitivity | None:
    """values: of a figure, a sample each, NaN where a run failed. None for other designs, for a
    figure that does not change, and where too much failed."""
    if not design.sampled or design.method not in (MORRIS, SALTELLI):
        return None
    known = values[np.isfinite(values)]
    if known.size == 0 or np.ptp(known) == 0.0:
        return None
    found = morris if design.method == MORRIS else sobol
    return found(design, values)


def _names(design: Design) -> list[str]:
    return [design.factors[i].name for i in design.sampled]


def morris(design: Design, values: np.ndarray) -> Sensitivity | None:
    """Effects are per whole range of a factor: mu* their mean size, mu their mean, sigma how much
    they differ along the way."""
    dimensions = len(design.sampled)
    shares = design.shares.reshape(-1, dimensions + 1, dimensions)
    moved = np.diff(shares, axis=1)
    which = np.argmax(np.abs(moved), axis=2)  # factor of each step
    steps = np.take_along_axis(moved, which[..., None], axis=2)[..., 0]
    effects = np.diff(values.reshape(-1, dimensions + 1), axis=1) / steps
    whole = np.isfinite(effects).all(axis=1)
    if whole.sum() < LEAST_PATHS:
        return None
    # In the order of the factors.
    ordered = np.take_along_axis(effects[whole], np.argsort(which[whole], axis=1), axis=1)
    columns = (np.abs(ordered).mean(0), ordered.mean(0), ordered.std(0, ddof=1))
    rows = _rows(design, columns)
    return Sensitivity(("mu*", "mu", "sigma"), rows, f"{whole.sum()} of {len(whole)} paths")


def sobol(design: Design, values: np.ndarray) -> Sensitivity | None:
    """First: share of the variance that a factor explains alone; total: with all its interactions;
    each with half of its 95 % interval, of bases drawn again and again, the same ones each time."""
    dimensions = len(design.sampled)
    blocks = values.reshape(-1, dimensions + 2)
    whole = blocks[np.isfinite(blocks).all(axis=1)]
    if len(whole) < LEAST_BASE:
        return None
    count = 1 << (len(whole).bit_length() - 1)  # scipy wants a power of 2
    used = whole[:count]
    rng = np.random.default_rng(design.seed)
    draws = [_indices(used[rng.integers(count, size=count)]) for _ in range(RESAMPLES)]
    low, high = np.nanquantile(draws, INTERVAL_95, axis=0)
    (first, total), half = _indices(used), 0.5 * (high - low)
    rows = _rows(design, (first, half[0], total, half[1]))
    return Sensitivity(("first", "+-", "total", "+-"), rows, f"{count} of {len(blocks)} bases")


def _indices(blocks: np.ndarray) -> np.ndarray:
    """First and total, a column a factor. blocks: a, b, and a with each of b's, a row a base."""
    from scipy.stats import sobol_indices

    a, b, *crossed = blocks.T
    answers = {"f_A": a[None], "f_B": b[None], "f_AB": np.array(crossed)[:, None]}
    found = sobol_indices(func=answers, n=len(blocks))
    return np.array([np.atleast_1d(found.first_order), np.atleast_1d(found.total_order)])


def _rows(design: Design, columns: tuple[np.ndarray, ...]) -> dict[str, tuple[float, ...]]:
    return {
        name: tuple(float(column[i]) for column in columns) for i, name in enumerate(_names(design))
    }
