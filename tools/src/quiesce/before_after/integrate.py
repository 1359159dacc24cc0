"""Velocity and displacement from acceleration, in the frequency domain, above a stated corner."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len

# Of the high-pass and the low-pass, whose phases are zero.
ORDER = 4
# At each end, in periods of the low corner: faded in or out, and left out of the result.
FADING_PERIODS = 2.0


def gain(freq_Hz: np.ndarray, low_Hz: float, high_Hz: float) -> np.ndarray:
    """Amplitude of Butterworth's filters of ORDER, 1/sqrt(2) at either corner; real, zero phase."""
    with np.errstate(divide="ignore"):
        low = 1.0 / np.sqrt(1.0 + (low_Hz / freq_Hz) ** (2 * ORDER))
    return low / np.sqrt(1.0 + (freq_Hz / high_Hz) ** (2 * ORDER))


def fading_samples(rate_Hz: float, low_Hz: float) -> int:
    return math.ceil(FADING_PERIODS * rate_Hz / low_Hz)


@dataclass(frozen=True)
class Faded:
    """Spectrum of a record without its mean, whose ends are faded by half a cosine: cut off sharply
    they would have low frequencies that were never there, and integration makes those large."""

    freq_Hz: np.ndarray
    spectrum: np.ndarray
    size: int
    kept: slice

    def through(self, response: np.ndarray) -> np.ndarray:
        """The signal through that response, without what was faded."""
        return np.fft.irfft(self.spectrum * response, self.size)[self.kept]


def faded(values: np.ndarray, rate_Hz: float, low_Hz: float) -> Faded:
    count, fading = len(values), fading_samples(rate_Hz, low_Hz)
    ramp = 0.5 - 0.5 * np.cos(np.pi * (np.arange(fading) + 0.5) / fading)
    shaped = values - values.mean()
    shaped[:fading] *= ramp
    shaped[-fading:] *= ramp[::-1]
    # Zeros after it, so that nothing comes round.
    size = next_fast_len(count + 2 * fading, real=True)
    freq_Hz = np.fft.rfftfreq(size, 1.0 / rate_Hz)
    return Faded(freq_Hz, np.fft.rfft(shaped, size), size, slice(fading, count - fading))


def integrated(
    values: np.ndarray, rate_Hz: float, times: int, low_Hz: float, high_Hz: float
) -> np.ndarray:
    """`values` without their mean, through both filters, integrated so many times; shorter by
    fading_samples at each end."""
    record = faded(values, rate_Hz, low_Hz)
    response = gain(record.freq_Hz, low_Hz, high_Hz).astype(complex)
    response[1:] /= (2j * np.pi * record.freq_Hz[1:]) ** times
    response[0] = 0.0
    return record.through(response)
