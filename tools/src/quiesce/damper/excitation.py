"""Motions and currents of a test rig that begin and end at rest in mid-stroke."""

from dataclasses import dataclass

import numpy as np

# Part of the speed limit that composed motions stay below.
_ROOM = 0.97
_SHARP = 0.995
_TONES = 60


@dataclass(frozen=True)
class Excitation:
    """What a rig plays; arrays [n] at an even rate."""

    time_s: np.ndarray
    disp_m: np.ndarray
    current_A: np.ndarray


def times(duration_s: float, rate_Hz: float) -> np.ndarray:
    return np.arange(round(duration_s * rate_Hz) + 1) / rate_Hz


def envelope(time_s: np.ndarray, ramp_s: float) -> np.ndarray:
    """Rises from 0 to 1 over ramp_s as a raised cosine, and falls at the end."""
    left = np.clip(np.minimum(time_s, time_s[-1] - time_s) / ramp_s, 0.0, 1.0)
    return 0.5 - 0.5 * np.cos(np.pi * left)


def sine(time_s: np.ndarray, amplitude_m: float, freq_Hz: float) -> np.ndarray:
    shape = np.sin(2.0 * np.pi * freq_Hz * time_s)
    return amplitude_m * envelope(time_s, 1.0 / freq_Hz) * shape


def ramp_freq_Hz(amplitude_m: float, speed_m_s: float) -> float:
    """Of a `ramps` motion that passes mid-stroke at this speed."""
    return speed_m_s * np.arcsin(_SHARP) / (2.0 * np.pi * _SHARP * amplitude_m)


def ramps(time_s: np.ndarray, amplitude_m: float, speed_m_s: float) -> np.ndarray:
    """To and fro at an almost constant speed, its turning points rounded."""
    freq_Hz = ramp_freq_Hz(amplitude_m, speed_m_s)
    shape = np.arcsin(_SHARP * np.sin(2.0 * np.pi * freq_Hz * time_s)) / np.arcsin(_SHARP)
    return amplitude_m * envelope(time_s, 0.5 / freq_Hz) * shape


def sweep(
    time_s: np.ndarray, amplitude_m: float, speed_m_s: float, low_Hz: float, high_Hz: float
) -> np.ndarray:
    """Logarithmic sweep: the full amplitude while slow, the full speed while fast."""
    duration_s = time_s[-1]
    rise = np.log(high_Hz / low_Hz)
    freq_Hz = low_Hz * np.exp(rise * time_s / duration_s)
    phase = 2.0 * np.pi * low_Hz * duration_s / rise * (np.exp(rise * time_s / duration_s) - 1.0)
    limit = _ROOM * speed_m_s / (2.0 * np.pi * freq_Hz)
    size = amplitude_m * limit / (amplitude_m**4 + limit**4) ** 0.25
    return size * envelope(time_s, 1.0 / low_Hz) * np.sin(phase)


def chirp(time_s: np.ndarray, amplitude_m: float, low_Hz: float, high_Hz: float) -> np.ndarray:
    """One amplitude, the frequency rising evenly."""
    rise_Hz_s = (high_Hz - low_Hz) / time_s[-1]
    phase = 2.0 * np.pi * (low_Hz + 0.5 * rise_Hz_s * time_s) * time_s
    return amplitude_m * envelope(time_s, 1.0 / low_Hz) * np.sin(phase)


def random_motion(
    time_s: np.ndarray, amplitude_m: float, speed_m_s: float, band_Hz: tuple[float, float],
    seed: int,
) -> np.ndarray:  # fmt: skip
    """Many sines of random phase in a band, slow ones larger; within both limits."""
    rng = np.random.default_rng(seed)
    freqs_Hz = np.geomspace(*band_Hz, _TONES) * rng.uniform(0.98, 1.02, _TONES)
    phases = rng.uniform(0.0, 2.0 * np.pi, _TONES)
    disp = np.zeros(len(time_s))
    for freq_Hz, phase in zip(freqs_Hz, phases, strict=True):
        disp += freq_Hz**-0.7 * np.sin(2.0 * np.pi * freq_Hz * time_s + phase)
    disp *= envelope(time_s, 1.0 / band_Hz[0])
    speed = np.abs(np.gradient(disp, time_s)).max()
    return disp * _ROOM * min(amplitude_m / np.abs(disp).max(), speed_m_s / speed)


def step_current(
    time_s: np.ndarray, amplitude_m: float, speed_m_s: float, level_A: float
) -> np.ndarray:
    """For a `ramps` motion: on at every way out through mid-stroke, off on the way back."""
    freq_Hz = ramp_freq_Hz(amplitude_m, speed_m_s)
    part = (time_s * freq_Hz + 1e-9) % 1.0
    is_on = (part < 0.5) & (time_s < time_s[-1] - 0.5 / freq_Hz)
    return np.where(is_on, level_A, 0.0)


def switched_current(time_s: np.ndarray, levels_A: list[float], seed: int) -> np.ndarray:
    """Levels at random, each held for 0.15 to 0.6 s; 0 at the ends."""
    rng = np.random.default_rng(seed)
    out = np.zeros(len(time_s))
    at_s = 0.5
    while at_s < time_s[-1] - 0.5:
        until_s = at_s + rng.uniform(0.15, 0.6)
        out[(time_s >= at_s) & (time_s < min(until_s, time_s[-1] - 0.5))] = rng.choice(levels_A)
        at_s = until_s
    return out
