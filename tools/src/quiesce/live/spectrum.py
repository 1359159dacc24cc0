"""Spectra of what comes, by Welch's method: Hann windows that overlap by half, their mean power."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce.live.record_plan import number_of
from quiesce.live.rings import Ring
from quiesce.live.series import Series

LEAST_S, LONGEST_S = 0.5, 16.0  # of a window
MOST_AVERAGES = 16
MOST_HZ = 500.0
MOST_BINS = 4000
GAP_S = 0.25  # without a sample: windows with one in them are left out
KEYS = {"series", "length_s", "averages", "most_Hz"}


@dataclass(frozen=True)
class SpectrumPlan:
    """What a viewer wants: windows of about length_s (the nearest power of two of samples: the
    server's loop computes them), the mean of so many, up to most_Hz."""

    series: int
    length_s: float
    averages: int
    most_Hz: float


@dataclass(frozen=True)
class Spectrum:
    """rms: at k * step_Hz, in integers of the wire: a sine stands as high as its RMS. used: windows
    that there were."""

    step_Hz: float
    rate_Hz: float
    used: int
    rms: list[float]


NONE = Spectrum(0.0, 0.0, 0, [])


def spectrum_plan_of(said: dict[str, Any], series_count: int) -> SpectrumPlan | None:
    """None: no spectrum is wanted. ValueError, with what would be allowed, where it is no plan."""
    series = said["series"]
    if series is not None and (type(series) is not int or not 0 <= series < series_count):
        raise ValueError("'series' is the number of a series, or null")
    length_s = number_of(said, "length_s", LEAST_S, LONGEST_S)
    averages = number_of(said, "averages", 1, MOST_AVERAGES)
    most_Hz = number_of(said, "most_Hz", 1.0, MOST_HZ)
    if averages != int(averages):
        raise ValueError(f"'averages' is an integer in 1 .. {MOST_AVERAGES}")
    if length_s * most_Hz > MOST_BINS:
        raise ValueError(f"'length_s' times 'most_Hz' is at most {MOST_BINS}")
    return None if series is None else SpectrumPlan(series, length_s, int(averages), most_Hz)


class Spectra:
    """The last one of each plan, for as many viewers as want it."""

    def __init__(self, series: tuple[Series, ...], rings: dict[int, Ring]) -> None:
        self._series = series
        self._rings = rings
        self._last: dict[SpectrumPlan, tuple[int, Spectrum]] = {}

    def of(self, plan: SpectrumPlan) -> dict[str, Any]:
        """As values of JSON, with the plan."""
        ring = self._rings[self._series[plan.series].frame_id]
        count, spectrum = self._last.get(plan, (-1, NONE))
        if count != ring.count:
            spectrum = self._computed(plan, ring)
            self._last = {one: had for one, had in self._last.items() if had[0] == ring.count}
            self._last[plan] = ring.count, spectrum
        return {**vars(plan), **vars(spectrum)}

    def _computed(self, plan: SpectrumPlan, ring: Ring) -> Spectrum:
        _, times_s, words = ring.read(0, ring.size)
        steps_s = np.diff(times_s)
        steps_s = steps_s[steps_s < GAP_S]
        if not steps_s.any():
            return NONE
        rate_Hz = 1.0 / float(steps_s.mean())
        length = 2 ** round(math.log2(max(plan.length_s * rate_Hz, 1.0)))
        wanted = length * (plan.averages + 1) // 2 + 1
        values = self._series[plan.series].values(words[-wanted:])
        power, used = mean_power(times_s[-wanted:], values.astype(float), length)
        step_Hz = rate_Hz / length
        rms = np.sqrt(power[: int(plan.most_Hz / step_Hz) + 1])
        return Spectrum(step_Hz, rate_Hz, used, [float(f"{one:.4g}") for one in rms])


def mean_power(times_s: np.ndarray, values: np.ndarray, length: int) -> tuple[np.ndarray, int]:
    """Squares of RMS by frequency, and of how many windows; the last one ends with the samples."""
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / max(length, 1))
    found = []
    for end in range(len(values), length - 1, -max(length // 2, 1)):
        part = values[end - length : end]
        steps_s = np.diff(times_s[end - length : end])
        if length < 2 or np.isnan(part).any() or steps_s.max() >= GAP_S:
            continue
        lines = np.fft.rfft((part - part.mean()) * window)
        found.append(2.0 * np.abs(lines / window.sum()) ** 2)
    return (np.mean(found, axis=0), len(found)) if found else (np.zeros(0), 0)
