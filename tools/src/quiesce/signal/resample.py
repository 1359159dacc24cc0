"""Resampling to the control rate: band-limited interpolation with a Kaiser-windowed sinc.

The kernel is symmetric and evaluated at exact times, so the result has no delay and linear phase
at any ratio of rates. Its band is that of the slower rate: flat within 1e-4 up to PASS of that
rate's Nyquist frequency, ATTENUATION_dB down from the Nyquist frequency on (no aliases when rates
fall, no images when they rise). The ends are continued by odd reflection, so that an offset leaves
no step there.
"""

import numpy as np

PASS = 0.8
ATTENUATION_dB = 90.0
# As shown to the user, on two lines.
METHOD = (
    f"Kaiser-windowed sinc, linear phase, no delay,\n           pass band to {PASS:g} of the lower "
    f"Nyquist frequency, {ATTENUATION_dB:g} dB beyond it"
)
_CHUNK = 1 << 14


def half_taps() -> int:
    """Samples of the slower rate on each side of the kernel's centre (Kaiser's formula)."""
    transition_rad = np.pi * (1.0 - PASS)
    return int(np.ceil((ATTENUATION_dB - 7.95) / (2.285 * transition_rad) / 2.0)) + 1


def kernel(offset: np.ndarray) -> np.ndarray:
    """Kernel at offsets in samples of the slower rate; integrates to 1."""
    half = half_taps()
    cutoff = (1.0 + PASS) / 2.0
    shape = np.sqrt(np.clip(1.0 - (offset / half) ** 2, 0.0, None))
    beta = 0.1102 * (ATTENUATION_dB - 8.7)  # Kaiser's, above 50 dB
    window = np.where(np.abs(offset) <= half, np.i0(beta * shape) / np.i0(beta), 0.0)
    return cutoff * np.sinc(cutoff * offset) * window


def extend_odd(values: np.ndarray, count: int) -> np.ndarray:
    """`count` samples more at each end, mirrored about the end points; longer than the signal,
    the mirror image is held."""
    reach = min(count, len(values) - 1)
    head = 2.0 * values[0] - values[reach:0:-1]
    tail = 2.0 * values[-1] - values[-2 : -reach - 2 : -1]
    return np.concatenate(
        [np.full(count - reach, head[0]), head, values, tail, np.full(count - reach, tail[-1])]
    )


def is_same_rate(count: int, rate_Hz: float, new_rate_Hz: float) -> bool:
    """Rates so close that over all samples they part by less than 1/1000 of a sample."""
    return abs(new_rate_Hz / rate_Hz - 1.0) * count < 1e-3


def resample(values: np.ndarray, rate_Hz: float, new_rate_Hz: float) -> np.ndarray:
    """Samples at n / new_rate_Hz from samples at n / rate_Hz, over the same duration."""
    if is_same_rate(len(values), rate_Hz, new_rate_Hz):
        return values.copy()
    shrink = min(1.0, new_rate_Hz / rate_Hz)
    reach = int(np.ceil(half_taps() / shrink))
    extended = extend_odd(np.asarray(values, dtype=float), reach + 1)
    count = int(np.floor((len(values) - 1) * new_rate_Hz / rate_Hz + 1e-9)) + 1
    steps = np.arange(-reach, reach + 2)
    out = np.empty(count)
    for first in range(0, count, _CHUNK):
        position = np.arange(first, min(first + _CHUNK, count)) * (rate_Hz / new_rate_Hz)
        index = np.floor(position).astype(int)
        offset = steps[None, :] - (position - index)[:, None]
        weights = shrink * kernel(shrink * offset)
        samples = extended[index[:, None] + steps[None, :] + reach + 1]
        out[first : first + len(position)] = np.sum(weights * samples, axis=1)
    return out
