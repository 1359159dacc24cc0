"""A float64 estimate of the dominant frequency over the same trailing window, without any hurry.

Nonlinear least squares on a rectangular window: up to TONES sinusoids and a constant, fitted
jointly by Gauss-Newton steps. The next tone is searched in what the others leave, on a grid, with
the exact projection on cosine, sine and constant (no asymptotics: few cycles are no special case).
Among the tones that stand out of the residual, with at least MIN_SHARE of the strongest one's
acceleration, the one with MOST_SHARE of their energy is the dominant one, else the one with the
largest displacement; of a tone and its third harmonic the tone, where it displaces more.
"""

from functools import lru_cache

import numpy as np

BAND_Hz = (1.0, 50.0)
TONES = 3
MIN_SHARE = 0.05
MOST_SHARE = 9 / 16  # of the squares of the accelerations
HARMONIC_GAP_BINS = 0.25
# Least amplitude in standard deviations that white noise like the residual gives it.
MIN_SIGMA = 6.0
# A drift below the band is a tone like any other to the fit.
FIT_Hz = (0.02, 60.0)
GRID_PER_BIN = 6
STEPS = 8
MAX_MOVE_BINS = 0.3
_BLOCK = 64


@lru_cache(maxsize=64)
def projections(ticks: int, rate_Hz: int) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, and for each an orthonormal pair of vectors for cosine and sine, free of DC."""
    spacing_Hz = rate_Hz / ticks / GRID_PER_BIN
    grid_Hz = np.arange(BAND_Hz[0], BAND_Hz[1] + spacing_Hz, spacing_Hz)
    angle = 2.0 * np.pi * grid_Hz[:, None] * (np.arange(ticks) - 0.5 * (ticks - 1)) / rate_Hz
    vectors = np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=2)
    return grid_Hz, np.linalg.qr(vectors)[0][:, :, 1:].transpose(1, 0, 2).copy()


def strongest_Hz(residual: np.ndarray, rate_Hz: int) -> np.ndarray:
    """Frequency of the grid that explains most of each row."""
    grid_Hz, vectors = projections(residual.shape[1], rate_Hz)
    energy = np.square(np.tensordot(residual, vectors, axes=(1, 0))).sum(axis=2)
    return grid_Hz[np.argmax(energy, axis=1)]


def regressors(freqs_Hz: np.ndarray, time_s: np.ndarray) -> np.ndarray:
    """Constant, then cosine and sine of each tone: rows x columns x ticks."""
    angle = 2.0 * np.pi * freqs_Hz[:, :, None] * time_s
    ones = np.ones((len(freqs_Hz), 1, len(time_s)))
    return np.concatenate([ones, np.cos(angle), np.sin(angle)], axis=1)


def solve(columns: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Least squares of each row; a trace of ridge keeps merging tones solvable."""
    gram = np.einsum("bin,bjn->bij", columns, columns)
    ridge = 1e-12 * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(gram.shape[1])
    return np.linalg.solve(gram + ridge, np.einsum("bin,bn->bi", columns, values)[..., None])[
        ..., 0
    ]


def refine(
    freqs_Hz: np.ndarray, windows: np.ndarray, time_s: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequencies after Gauss-Newton steps, amplitudes, residual."""
    tones = freqs_Hz.shape[1]
    span_s = len(time_s) * (time_s[1] - time_s[0])
    for _ in range(STEPS):
        columns = regressors(freqs_Hz, time_s)
        weights = solve(columns, windows)
        a, b = weights[:, 1 : tones + 1, None], weights[:, tones + 1 :, None]
        cosine, sine = columns[:, 1 : tones + 1], columns[:, tones + 1 :]
        slope = 2.0 * np.pi * time_s * (b * cosine - a * sine) * (1.0 / span_s)
        residual = windows - np.einsum("bin,bi->bn", columns, weights)
        move = solve(np.concatenate([columns, slope], axis=1), residual)[:, 2 * tones + 1 :]
        move = np.clip(move, -MAX_MOVE_BINS, MAX_MOVE_BINS) / span_s
        freqs_Hz = np.clip(freqs_Hz + move, *FIT_Hz)
    columns = regressors(freqs_Hz, time_s)
    weights = solve(columns, windows)
    amplitude = np.hypot(weights[:, 1 : tones + 1], weights[:, tones + 1 :])
    return freqs_Hz, amplitude, windows - np.einsum("bin,bi->bn", columns, weights)


def dominant_Hz(windows: np.ndarray, rate_Hz: int, tones: int) -> np.ndarray:
    """Dominant frequency of each row of samples."""
    ticks = windows.shape[1]
    time_s = (np.arange(ticks) - 0.5 * (ticks - 1)) / rate_Hz
    windows = windows - windows.mean(axis=1, keepdims=True)
    freqs_Hz, residual = np.empty((len(windows), 0)), windows
    for _ in range(tones):
        added = np.concatenate([freqs_Hz, strongest_Hz(residual, rate_Hz)[:, None]], axis=1)
        freqs_Hz, amplitude, residual = refine(added, windows, time_s)
    is_in_band = (freqs_Hz >= BAND_Hz[0]) & (freqs_Hz <= BAND_Hz[1])
    sigma = np.sqrt(2.0 / ticks) * residual.std(axis=1, keepdims=True)
    strongest = np.where(is_in_band, amplitude, 0.0).max(axis=1, keepdims=True)
    is_strong = (amplitude >= MIN_SHARE * strongest) & (amplitude >= MIN_SIGMA * sigma)
    is_known = is_in_band & is_strong
    displacement = np.where(is_known, amplitude / np.square(freqs_Hz), -1.0)
    energy = np.where(is_known, np.square(amplitude), 0.0)
    farthest = np.argmax(displacement, axis=1)
    most = np.argmax(energy, axis=1)
    has_most = energy.max(axis=1) >= MOST_SHARE * energy.sum(axis=1)
    # Where none is known, the first one found, the strongest.
    best = np.where(is_known.any(axis=1), np.where(has_most, most, farthest), 0)
    rows = np.arange(len(windows))
    gap_Hz = np.abs(3.0 * freqs_Hz - freqs_Hz[rows, best][:, None])
    is_base = (
        is_known
        & (gap_Hz < HARMONIC_GAP_BINS * rate_Hz / ticks)
        & (displacement > displacement[rows, best][:, None])
    )
    return freqs_Hz[rows, np.where(is_base.any(axis=1), np.argmax(is_base, axis=1), best)]


def trailing_Hz(
    samples: np.ndarray, ends: np.ndarray, lengths: np.ndarray, rate_Hz: int, tones: int = TONES
) -> np.ndarray:
    """Dominant frequency of the lengths samples before and with each of ends.

    NaN where there are not so many samples, or none are asked for.
    """
    found = np.full(len(ends), np.nan)
    usable = (lengths > 0) & (ends + 1 >= lengths)
    for length in np.unique(lengths[usable]):
        chosen = np.flatnonzero(usable & (lengths == length))
        for first in range(0, len(chosen), _BLOCK):
            some = chosen[first : first + _BLOCK]
            rows = ends[some, None] + np.arange(1 - length, 1)[None, :]
            found[some] = dominant_Hz(samples[rows], rate_Hz, tones)
    return found
