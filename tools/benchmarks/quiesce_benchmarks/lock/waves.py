"""Accelerations that the part `tones` plays to the sensor, real and made up, and what one component
of them is worth by float64 least squares: the strongest of the band, and how far above the rest.

Windows are rows of samples at LINE_RATE_Hz: `resample` cuts them off at the band's upper end.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from quiesce.signal.recording import read_recording
from quiesce.signal.resample import resample

from quiesce_benchmarks.seeds import generator
from quiesce_benchmarks.signal.offline import refine, strongest_Hz
from quiesce_benchmarks.signal.recorded import SOURCES
from quiesce_benchmarks.signal.records import log_uniform, random_phase
from quiesce_benchmarks.signal.truth import HARMONIC_MARGIN

LINE_RATE_Hz = 125  # flat up to 50 Hz
SPEEDS = (1.0, 2.0, 5.0)
QUAKE_PEAK_m_s2 = 2.0
# Made-up records.
FREQS_Hz = (2.0, 45.0)
LEVELS_m_s2 = (0.05, 10.0)
BELOW_dB = (10.0, 40.0)
OFFSET_m_s2 = 9.80665
BAND_Hz = (1.0, 50.0)
APART_Hz = 2.0
NOISE_LINES = 240
KINDS = ("white noise", "noise in the band", "a second line", "slow drift")


@dataclass(frozen=True)
class Wave:
    group: str
    name: str
    accel_m_s2: np.ndarray  # a sample a tick


def recorded(folder: Path, rate_Hz: int) -> Iterator[Wave]:
    """Every channel of the vibration records that are there."""
    for source in SOURCES:
        file = folder / source.file
        columns = [one for one in (source.column, source.reference_column) if one]
        recording = read_recording(file, columns, "t_s")
        for column in columns:
            accel_m_s2 = resample(recording.accel_m_s2(column, "g"), recording.rate_Hz, rate_Hz)
            yield Wave("recorded", f"{file.stem}, {column}", accel_m_s2)


def quakes(folder: Path, rate_Hz: int) -> Iterator[Wave]:
    """As if the sensor stood on the ground: every record at every speed, scaled to one peak."""
    for file in sorted(folder.glob("*.csv")):
        recording = read_recording(file, ["acc_m_s2"], "t_s")
        values = recording.columns["acc_m_s2"]
        values = values * (QUAKE_PEAK_m_s2 / np.abs(values).max())
        for speed in SPEEDS:
            accel_m_s2 = resample(values, recording.rate_Hz * speed, rate_Hz)
            yield Wave("recorded", f"{file.stem} x{speed:g}", accel_m_s2)


def is_another(freq_Hz: float, lines_Hz: np.ndarray) -> np.ndarray:
    """Apart by more than a second can hide, and neither a third harmonic of the other: of those
    the lower one is reported, a sticking damper's, though it be the weaker."""
    times = np.maximum(lines_Hz, freq_Hz) / np.minimum(lines_Hz, freq_Hz)
    return (np.abs(lines_Hz - freq_Hz) > APART_Hz) & (np.abs(times / 3.0 - 1.0) > HARMONIC_MARGIN)


def around(kind: str, freq_Hz: float, time_s: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """What surrounds a tone; in the band its RMS is 1, but for a drift, which is below it."""
    if kind == "white noise":
        share = (BAND_Hz[1] - BAND_Hz[0]) * 2.0 * (time_s[1] - time_s[0])
        return rng.standard_normal(len(time_s)) / np.sqrt(share)
    if kind == "noise in the band":
        lines_Hz = log_uniform(rng, *BAND_Hz, NOISE_LINES)
    elif kind == "slow drift":
        lines_Hz = rng.uniform(0.05, 0.4, 1)
    else:
        lines_Hz = log_uniform(rng, *FREQS_Hz, 200)
        lines_Hz = lines_Hz[is_another(freq_Hz, lines_Hz)][:1]
    angle = 2.0 * np.pi * lines_Hz[:, None] * time_s + random_phase(rng, lines_Hz.size)[:, None]
    return np.sqrt(2.0 / lines_Hz.size) * np.cos(angle).sum(axis=0)


def made_up(
    rate_Hz: int, duration_s: float, count: int, seed: int, below_dB: tuple[float, float]
) -> Iterator[Wave]:
    """A steady tone over gravity, so many decibels above what surrounds it, from its start on."""
    time_s = np.arange(round(duration_s * rate_Hz)) / rate_Hz
    for i in range(count):
        kind = KINDS[i % len(KINDS)]
        rng = generator(seed, "tones", i, below_dB)
        (freq_Hz,), (level,) = log_uniform(rng, *FREQS_Hz, 1), log_uniform(rng, *LEVELS_m_s2, 1)
        (phase_rad,) = random_phase(rng, 1)
        rest = level / np.sqrt(2.0) * 10.0 ** (-rng.uniform(*below_dB) / 20.0)
        accel_m_s2 = level * np.cos(2.0 * np.pi * freq_Hz * time_s + phase_rad)
        accel_m_s2 += rest * around(kind, freq_Hz, time_s, rng)
        name = f"{freq_Hz:.2f} Hz of {level:.2g} m/s2 and {kind}"
        yield Wave("made up", name, accel_m_s2 + OFFSET_m_s2 * rng.uniform(-1.0, 1.0))


def lines_of(wave: Wave, rate_Hz: int) -> np.ndarray:
    return resample(wave.accel_m_s2, rate_Hz, LINE_RATE_Hz)


def strongest(windows: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequency in Hz of the component that explains most of each row, its share of the row's
    energy about its mean, and its amplitude."""
    time_s = (np.arange(windows.shape[1]) - 0.5 * (windows.shape[1] - 1)) / LINE_RATE_Hz
    windows = windows - windows.mean(axis=1, keepdims=True)
    freqs_Hz = strongest_Hz(windows, LINE_RATE_Hz)[:, None]
    freqs_Hz, amplitudes, residual = refine(freqs_Hz, windows, time_s)
    energy = np.square(windows).sum(axis=1)
    left = np.square(residual).sum(axis=1)
    shares = 1.0 - left / np.where(energy > 0.0, energy, 1.0)
    return freqs_Hz[:, 0], shares, amplitudes[:, 0]
