"""One-third-octave bands of IEC 61260-1, base ten: exact mid-band frequencies, band levels."""

import math

import numpy as np

from quiesce.before_after.integrate import faded
from quiesce.before_after.levels import Estimate, rms

OCTAVE = 10.0**0.3
REFERENCE_Hz = 1000.0
# A band whose width times the record's length is less has too few independent values.
LEAST_BANDWIDTH_TIME = 20.0
POLES = 3
# Nominal names of the standard's series R10, one decade.
NOMINAL = (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)


def mid_Hz(index: int) -> float:
    """Exact mid-band frequency; index 0 is 1 kHz."""
    return REFERENCE_Hz * OCTAVE ** (index / 3.0)


def edges_Hz(index: int) -> tuple[float, float]:
    side = OCTAVE ** (1.0 / 6.0)
    return mid_Hz(index) / side, mid_Hz(index) * side


def nominal_Hz(index: int) -> float:
    decade, place = divmod(index + 30, 10)
    return round(NOMINAL[place] * 10.0**decade, 6)


def bands(low_Hz: float, high_Hz: float, duration_s: float) -> list[int]:
    """Those whose edges are inside low_Hz .. high_Hz, and that the record is long enough for."""
    first = math.ceil(10.0 * math.log10(low_Hz / REFERENCE_Hz)) - 1
    last = math.floor(10.0 * math.log10(high_Hz / REFERENCE_Hz)) + 1
    return [
        index
        for index in range(first, last + 1)
        if edges_Hz(index)[0] >= low_Hz
        and edges_Hz(index)[1] <= high_Hz
        and bandwidth_time(index, duration_s) >= LEAST_BANDWIDTH_TIME
    ]


def bandwidth_time(index: int, duration_s: float) -> float:
    low, high = edges_Hz(index)
    return (high - low) * duration_s


def power_gain(freq_Hz: np.ndarray, index: int) -> np.ndarray:
    """Of Butterworth's band-pass of six poles whose noise bandwidth is the band's width."""
    low, high = edges_Hz(index)
    # Of white noise 1 / (1 + (q (f/fm - fm/f))^2n) lets through fm (pi/2n) / (q sin(pi/2n)).
    angle = math.pi / (2 * POLES)
    q = mid_Hz(index) / (high - low) * angle / math.sin(angle)
    with np.errstate(divide="ignore", over="ignore"):
        offset = q * (freq_Hz / mid_Hz(index) - mid_Hz(index) / freq_Hz)
        return 1.0 / (1.0 + offset ** (2 * POLES))


def levels(
    values: np.ndarray, rate_Hz: float, low_Hz: float, high_Hz: float
) -> dict[int, Estimate]:
    """RMS in each band by its index, of the record without its ends."""
    record = faded(values, rate_Hz, low_Hz)
    duration_s = (record.kept.stop - record.kept.start) / rate_Hz
    return {
        index: rms(record.through(np.sqrt(power_gain(record.freq_Hz, index))))
        for index in bands(low_Hz, high_Hz, duration_s)
    }
