"""Radial basis functions and rules fitted to samples: few centres, chosen one after the other among
many by what each adds (orthogonal least squares), then linear least squares."""

from dataclasses import dataclass, replace

import numpy as np

from quiesce.network.integers import output_of, radial_layer
from quiesce.network.layers import Layers

_RIDGE = 1e-6  # of the mean square of a column
_MOST_ROWS = 4000
_MOST_CANDIDATES = 400
_WIDTHS = (2.0, 1.0, 0.7, 0.5, 0.35, 0.25)  # 1 / sharpness, of inputs in -1 .. 1


@dataclass(frozen=True)
class RadialFit:
    """A current in parts of the largest: bias and coefficients [units], or [units 1 + values]."""

    centres: np.ndarray  # [units values]
    sharpness: float
    is_normalised: bool
    bias: float
    coefficients: np.ndarray

    def layers(self, unit_mA: float) -> Layers:
        sharpnesses = np.full(self.centres.shape, self.sharpness)
        layer = radial_layer(self.centres, sharpnesses, self.is_normalised)
        return Layers((layer,), output_of(unit_mA * self.bias, unit_mA * self.coefficients))

    def parts(self, x: np.ndarray) -> np.ndarray:
        """[rows] in float64, before anything of it is rounded, at x [rows values]."""
        if not self.is_normalised:
            return self.bias + gaussians(x, self.centres, self.sharpness) @ self.coefficients
        near = np.exp(-(self.sharpness**2) * _relative(x, self.centres))
        conclusions = self.coefficients[:, 0] + x @ self.coefficients[:, 1:].T
        return self.bias + np.sum(near * conclusions, axis=1) / np.sum(near, axis=1)


def gaussians(x: np.ndarray, centres: np.ndarray, sharpness: float) -> np.ndarray:
    """[rows units]."""
    return np.exp(-(sharpness**2) * _squares(x, centres))


def _squares(x: np.ndarray, centres: np.ndarray) -> np.ndarray:
    return np.sum((x[:, None, :] - centres) ** 2, axis=2)


def chosen(design: np.ndarray, target: np.ndarray, count: int) -> np.ndarray:
    """Indices of up to `count` columns of design [rows candidates], the one that adds most to what
    the ones before it say of target [rows] at each step."""
    left = design - design.mean(axis=0)
    rest = target - target.mean()
    least = 1e-8 * float(np.max(np.sum(left**2, axis=0)))
    taken: list[int] = []
    for _ in range(min(count, design.shape[1])):
        size = np.sum(left**2, axis=0)
        gain = np.where(size > least, (left.T @ rest) ** 2 / np.maximum(size, least), -1.0)
        gain[taken] = -1.0
        best = int(np.argmax(gain))
        if gain[best] < 0.0:
            break
        taken.append(best)
        unit = left[:, best] / np.sqrt(size[best])
        rest = rest - unit * (unit @ rest)
        left = left - np.outer(unit, unit @ left)
    return np.array(taken)


def least_squares(design: np.ndarray, target: np.ndarray) -> np.ndarray:
    gram = design.T @ design
    ridge = _RIDGE * np.trace(gram) / len(gram) * np.eye(len(gram))
    return np.linalg.solve(gram + ridge, design.T @ target)


def with_centres(
    x: np.ndarray, target: np.ndarray, candidates: np.ndarray, sharpness: float, units: int
) -> RadialFit:
    """Up to `units` of the candidates [n values], and a constant."""
    design = gaussians(x, candidates, sharpness)
    taken = chosen(design, target, units)
    found = least_squares(np.column_stack([np.ones(len(x)), design[:, taken]]), target)
    return RadialFit(candidates[taken], sharpness, False, float(found[0]), found[1:])


def as_rules(fit: RadialFit, x: np.ndarray, target: np.ndarray) -> RadialFit:
    """Rules at the same places, with conclusions of first order."""
    near = np.exp(-(fit.sharpness**2) * _relative(x, fit.centres))
    parts = near / near.sum(axis=1, keepdims=True)
    ones = np.column_stack([np.ones(len(x)), x])
    design = (parts[:, :, None] * ones[:, None, :]).reshape(len(x), -1)
    found = least_squares(design, target).reshape(len(fit.centres), -1)
    return RadialFit(fit.centres, fit.sharpness, True, 0.0, found)


def _relative(x: np.ndarray, centres: np.ndarray) -> np.ndarray:
    squares = _squares(x, centres)
    return squares - squares.min(axis=1, keepdims=True)


def best_rules(fit: RadialFit, x: np.ndarray, target: np.ndarray) -> RadialFit:
    """Rules at the same places, of the width that does best on every fifth row, which is not fitted
    before it is chosen."""
    held = np.arange(len(x)) % 5 == 0
    told = ~held

    def error(sharpness: float) -> float:
        one = as_rules(replace(fit, sharpness=sharpness), x[told], target[told])
        return float(np.mean((np.clip(one.parts(x[held]), 0.0, 1.0) - target[held]) ** 2))

    best = min((1.0 / width for width in _WIDTHS), key=error)
    return as_rules(replace(fit, sharpness=best), x, target)


def fitted(
    x: np.ndarray, target: np.ndarray, units: int, rng: np.random.Generator, of_rules: bool
) -> tuple[RadialFit, float]:
    """To rows x [rows values] within -1 .. 1 and target [rows] in parts of the largest; the width
    that does best on every fifth row, which is not fitted, and its root mean square there."""
    rows = rng.permutation(len(x))[:_MOST_ROWS]
    held, fit = rows[::5], np.setdiff1d(rows, rows[::5])
    candidates = x[fit[:_MOST_CANDIDATES]]
    best: tuple[float, RadialFit] | None = None
    for width in _WIDTHS:
        one = with_centres(x[fit], target[fit], candidates, 1.0 / width, units)
        if of_rules:
            one = as_rules(one, x[fit], target[fit])
        parts = np.clip(one.layers(1.0).sums_mA(x[held]), 0.0, 1.0)
        error = float(np.sqrt(np.mean((parts - target[held]) ** 2)))
        if best is None or error < best[0]:
            best = (error, one)
    assert best is not None
    return best[1], best[0]
