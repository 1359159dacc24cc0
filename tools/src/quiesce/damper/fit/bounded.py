"""Small linear least-squares problems with bounds, many at once. Ours, because scipy's lsq_linear
solves one at a time."""

import numpy as np

_SWEEPS = 200
_RIDGE = 1e-8


def bounded_least_squares(
    basis: np.ndarray, target: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Amounts [problems, terms] within low .. high [terms] that minimise, for each problem,
    ||target - sum of amount times basis||; basis [problems, terms, samples], target [problems,
    samples] or [samples]. Columns that are zero get the amount nearest to 0.

    Problems whose free solution breaks a bound are solved by cyclic descent on the normal
    equations, which converges for a convex problem with bounds.
    """
    sizes = np.sqrt(np.einsum("pts,pts->pt", basis, basis))
    safe = np.where(sizes > 0.0, sizes, 1.0)
    scaled = basis / safe[:, :, None]
    gram = np.einsum("pts,pus->ptu", scaled, scaled)
    right = np.einsum("pts,ps->pt", scaled, np.broadcast_to(target, basis[:, 0].shape))
    terms = gram.shape[1]
    gram[:, np.arange(terms), np.arange(terms)] += _RIDGE + (sizes <= 0.0)
    amounts = np.linalg.solve(gram, right[:, :, None])[:, :, 0]
    low_scaled, high_scaled = low * safe, high * safe
    broken = ((amounts < low_scaled) | (amounts > high_scaled)).any(axis=1)
    if broken.any():
        amounts[broken] = descend(
            gram[broken],
            right[broken],
            np.clip(amounts[broken], low_scaled[broken], high_scaled[broken]),
            low_scaled[broken],
            high_scaled[broken],
        )
    return amounts / safe


def descend(
    gram: np.ndarray, right: np.ndarray, amounts: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Cyclic coordinate descent within the bounds."""
    diagonal = np.einsum("ptt->pt", gram)
    for _ in range(_SWEEPS):
        before = amounts.copy()
        for k in range(amounts.shape[1]):
            slope = right[:, k] - np.einsum("pt,pt->p", gram[:, k], amounts)
            amounts[:, k] = np.clip(amounts[:, k] + slope / diagonal[:, k], low[:, k], high[:, k])
        if np.max(np.abs(amounts - before)) <= 1e-10 * np.max(np.abs(amounts), initial=1e-300):
            break
    return amounts
