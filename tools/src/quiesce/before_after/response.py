"""Spectra by Welch's method, and how a channel answers to the reference: H1, coherence, bands."""

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

from quiesce.before_after.levels import CONFIDENCE, Estimate

OVERLAP = 0.5
# Averages that a spectrum aims at, between the resolutions that are useful.
AVERAGES = 30
LEAST_AVERAGES = 8
FINEST_Hz = 0.05
# What two neighbouring segments of a Hann window have in common, squared: 1/6.
NEIGHBOURS = (1.0 / 6.0) ** 2
GROUPS = 20  # of a jackknife


def segment_samples(counts: tuple[int, ...], rate_Hz: float) -> int:
    """Of spectra that are compared: as many averages as the shortest record can give, or the finest
    useful resolution."""
    longest = min(counts) * 2 // (AVERAGES + 1)
    return max(16, min(longest, round(rate_Hz / FINEST_Hz)))


@dataclass(frozen=True)
class Segments:
    """Spectra of the overlapping segments of a record, [segment, frequency], scaled so that the
    mean of |spectra|^2 is the one-sided density in unit^2/Hz."""

    freq_Hz: np.ndarray
    spectra: np.ndarray

    @property
    def averages(self) -> float:
        """Independent ones that are worth as much (Welch 1967)."""
        count = len(self.spectra)
        return count / (1.0 + 2.0 * NEIGHBOURS * (count - 1.0) / count)

    def density(self) -> np.ndarray:
        return np.mean(np.abs(self.spectra) ** 2, axis=0)


def segments(values: np.ndarray, rate_Hz: float, size: int) -> Segments:
    """Hann window, each segment without its mean. ValueError where there is not one segment."""
    step = size - int(size * OVERLAP)
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(size) / size)
    parts = np.lib.stride_tricks.sliding_window_view(values, size)[::step]
    spectra = np.fft.rfft((parts - parts.mean(axis=1, keepdims=True)) * window)
    scale = np.full(spectra.shape[1], math.sqrt(2.0 / (rate_Hz * float(np.sum(window**2)))))
    scale[0] /= math.sqrt(2.0)
    if size % 2 == 0:
        scale[-1] /= math.sqrt(2.0)
    return Segments(np.fft.rfftfreq(size, 1.0 / rate_Hz), spectra * scale)


@dataclass(frozen=True)
class Response:
    """From the reference to a channel. averages: independent ones; reach: of the 95 % circle around
    H1 in the complex plane, so that |H1| - reach .. |H1| + reach holds |H|."""

    freq_Hz: np.ndarray
    h1: np.ndarray
    h2: np.ndarray
    coherence: np.ndarray
    reach: np.ndarray
    averages: float

    @property
    def chance_coherence(self) -> float:
        """What two signals that have nothing in common exceed at a frequency in 5 %."""
        return 1.0 - (1.0 - CONFIDENCE) ** (1.0 / (self.averages - 1.0))


def response(reference: Segments, channel: Segments) -> Response:
    """Bendat and Piersol, Random Data, 4th ed.: H1 and H2 (6.37, 6.42), its circle (9.90)."""
    own, other, cross = _means(reference.spectra, channel.spectra)
    with np.errstate(divide="ignore", invalid="ignore"):
        h1, h2 = cross / own, other / np.conj(cross)
        coherence = np.clip(np.abs(cross) ** 2 / (own * other), 0.0, 1.0)
        spread = (1.0 - coherence) * other / own
    freedom = 2.0 * reference.averages - 2.0
    factor = 2.0 / freedom * stats.f.ppf(CONFIDENCE, 2.0, freedom)
    reach = np.sqrt(factor * spread)
    return Response(reference.freq_Hz, h1, h2, coherence, reach, reference.averages)


def _means(one: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Densities of both, and the cross density conj(one) * other."""
    return (
        np.mean(np.abs(one) ** 2, axis=0),
        np.mean(np.abs(other) ** 2, axis=0),
        np.mean(np.conj(one) * other, axis=0),
    )


def answer_rms(
    reference: Segments, channel: Segments, density: np.ndarray, inside: np.ndarray
) -> Estimate:
    """RMS of what the channel would do under a reference of this density, by |H1|, over the
    frequencies `inside`; its error by a jackknife over groups of segments."""
    freq_Hz, count = reference.freq_Hz, len(reference.spectra)
    groups = min(GROUPS, count)
    labels = np.arange(count) * groups // count

    def of(kept: np.ndarray) -> float:
        own, _, cross = _means(reference.spectra[kept], channel.spectra[kept])
        power = np.abs(cross[inside] / own[inside]) ** 2 * density[inside]
        return math.sqrt(float(np.sum(power)) * (freq_Hz[1] - freq_Hz[0]))

    logs = [math.log(of(labels != group)) for group in range(groups)]
    error = math.sqrt((groups - 1.0) ** 2 / groups * float(np.var(logs, ddof=1)))
    return Estimate(of(np.full(count, True)), error, groups - 1.0)
