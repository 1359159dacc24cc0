"""How well a sine of unknown frequency, amplitude, phase and offset can be known at all.

The Cramer-Rao bound, from the Fisher matrix of the very samples: no asymptotic formula, so that
few cycles, and the image at negative frequency with them, are part of it.
"""

from dataclasses import dataclass

import numpy as np

# Records of one block of the computation.
_BLOCK = 256


@dataclass(frozen=True)
class Bound:
    """Least standard deviations of unbiased estimates, one a record."""

    freq_Hz: np.ndarray
    phase_rad: np.ndarray  # at the last sample of the window
    amplitude_m_s2: np.ndarray


def sine_bound(
    freq_Hz: np.ndarray,
    phase_rad: np.ndarray,
    amplitude_m_s2: np.ndarray,
    noise_m_s2: np.ndarray,
    window_ticks: np.ndarray,
    rate_Hz: int,
) -> Bound:
    """Bound over window_ticks samples that end with the one where the phase is phase_rad.

    noise_m_s2: RMS of white noise in each sample.
    """
    freq, phase, amplitude, noise = (
        np.broadcast_to(np.asarray(value, dtype=float), np.shape(window_ticks))
        for value in (freq_Hz, phase_rad, amplitude_m_s2, noise_m_s2)
    )
    deviations = np.empty((len(window_ticks), 3))
    for length in np.unique(window_ticks):
        chosen = np.flatnonzero(window_ticks == length)
        for first in range(0, len(chosen), _BLOCK):
            some = chosen[first : first + _BLOCK]
            deviations[some] = unit_deviations(freq[some], phase[some], int(length), rate_Hz)
    relative = noise / amplitude
    return Bound(
        freq_Hz=deviations[:, 0] * relative,
        phase_rad=deviations[:, 1] * relative,
        amplitude_m_s2=deviations[:, 2] * noise,
    )


def unit_deviations(
    freq_Hz: np.ndarray, phase_rad: np.ndarray, ticks: int, rate_Hz: int
) -> np.ndarray:
    """Of frequency, phase and amplitude, for amplitude 1 and noise 1: records x 3.

    Time in units of the window keeps the matrix well conditioned.
    """
    share = np.arange(1 - ticks, 1) / ticks
    window_s = ticks / rate_Hz
    angle = phase_rad[:, None] + 2.0 * np.pi * (freq_Hz * window_s)[:, None] * share
    slope = np.stack(
        [-2.0 * np.pi * share * np.sin(angle), -np.sin(angle), np.cos(angle), np.ones_like(angle)]
    )
    fisher = np.einsum("irn,jrn->rij", slope, slope)
    variance = np.diagonal(np.linalg.inv(fisher), axis1=1, axis2=2)
    deviation = np.sqrt(variance[:, :3])
    deviation[:, 0] /= window_s
    return deviation
