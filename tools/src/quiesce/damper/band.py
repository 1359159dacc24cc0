"""Prediction bands: where 95 % of the rows that refits leave out lie about the refits' forces.

From the residuals on those rows (the folds of the validation), in the manner of split conformal
prediction (Lei and others, J. Am. Stat. Assoc. 113, 2018) but without its guarantee: refits of
parametric models start at the fit to everything, which has seen the rows, and rows of a fold are
not new tests. The width follows the level of the force: width = part * level^power *
scale^(1 - power). The level of a row is the largest model force within half a cycle of it, so that
a band is as wide where a force passes through zero as at its peaks. The power comes from a line
through the logarithms of every block's deviation and level; the part is then the quantile over all
rows, every test counting the same.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper.data.channels import cycles_of
from quiesce.damper.data.split import Segment

SHARE = 0.95
# Rows of a test that its residuals are taken from, at most.
_MOST_ROWS = 2000
# Levels have to span this ratio for a power to be told; otherwise widths are in proportion.
_LEAST_RATIO = 1.5
_BLOCKS = 12


@dataclass(frozen=True)
class Band:
    """Half widths in N: part * scale_N * (level / scale_N)^power. `part` is infinite for a model
    that diverges."""

    part: float
    power: float  # 0: the same everywhere, 1: in proportion to the level
    scale_N: float
    kinds: tuple[str, ...] = ()  # of folds that it came from, of data.folds.LEAVES_OUT

    def half_width_N(self, level_N: np.ndarray) -> np.ndarray:
        level = np.maximum(np.abs(level_N) / self.scale_N, 1e-6)
        return self.part * self.scale_N * level**self.power


@dataclass(frozen=True)
class LeftOut:
    """Rows that a refit left out: measured less modelled force, and the force's level, in N,
    [rows]."""

    residual_N: np.ndarray
    level_N: np.ndarray


def left_out_of(segment: Segment, force_N: np.ndarray) -> LeftOut:
    """force_N: the model's at the segment's rows."""
    level_N = levels_along(segment, force_N)
    residual_N = segment.record.force_N[segment.rows] - force_N
    step = -(-len(force_N) // _MOST_ROWS)
    return LeftOut(residual_N[::step], level_N[::step])


def levels_along(segment: Segment, force_N: np.ndarray) -> np.ndarray:
    """The largest force within half a cycle of each row, in N; of all rows where the motion has no
    cycles."""
    from scipy.ndimage import maximum_filter1d

    size_N = np.abs(force_N)
    cycle = cycles_of(segment.record.disp_m[segment.rows])
    rows = len(size_N) if cycle is None else min(len(size_N), round(float(np.median(cycle))))
    return maximum_filter1d(size_N, max(1, rows), mode="nearest")


def band_of(left_out: Sequence[LeftOut], kinds: tuple[str, ...] = ()) -> Band | None:
    """kinds: of the folds that left them out. None without a row."""
    tests = [one for one in left_out if len(one.residual_N)]
    if not tests:
        return None
    scale_N = max(float(np.max(one.level_N)) for one in tests)
    if not all(np.isfinite(one.residual_N).all() for one in tests) or not scale_N > 0.0:
        return Band(float("inf"), 1.0, max(scale_N, 1e-300) if np.isfinite(scale_N) else 1.0, kinds)
    power = power_of(tests, scale_N)
    shape = Band(1.0, power, scale_N)
    parts = np.concatenate(
        [np.abs(one.residual_N) / shape.half_width_N(one.level_N) for one in tests]
    )
    weights = np.concatenate(
        [np.full(len(one.residual_N), 1.0 / len(one.level_N)) for one in tests]
    )
    return Band(weighted_quantile(parts, weights, SHARE), power, scale_N, kinds)


def power_of(tests: Sequence[LeftOut], scale_N: float) -> float:
    """Slope of log deviation over log level of the tests' blocks, within 0 .. 1."""
    levels, sizes = [], []
    for one in tests:
        count = min(_BLOCKS, len(one.level_N))
        for rows in np.array_split(np.arange(len(one.level_N)), count):
            levels.append(float(np.max(one.level_N[rows])))
            sizes.append(float(np.sqrt(np.mean(one.residual_N[rows] ** 2))))
    x = np.log(np.maximum(levels, 1e-6 * scale_N))
    y = np.log(np.maximum(sizes, 1e-9 * scale_N))
    if np.ptp(x) < np.log(_LEAST_RATIO):
        return 1.0
    return float(np.clip(np.polyfit(x, y, 1)[0], 0.0, 1.0))


def weighted_quantile(values: np.ndarray, weights: np.ndarray, share: float) -> float:
    """The least value that `share` of the weight does not exceed."""
    order = np.argsort(values)
    passed = np.cumsum(weights[order])
    at = int(np.searchsorted(passed, share * passed[-1]))
    return float(values[order[min(at, len(order) - 1)]])


def coverage(band: Band, segments: Sequence[Segment], forces_N: Sequence[np.ndarray]) -> float:
    """Part of the measured rows inside the band about these model forces, every test counting the
    same."""
    inside = [
        np.mean(
            np.abs(segment.record.force_N[segment.rows] - force_N)
            <= band.half_width_N(levels_along(segment, force_N))
        )
        for segment, force_N in zip(segments, forces_N, strict=True)
    ]
    return float(np.mean(inside))
