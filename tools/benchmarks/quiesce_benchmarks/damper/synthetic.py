"""Motions that are known exactly, and dampers that are known, for measuring identification."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.library import RIG, Model

# Substeps of a sample with which a truth is made: steps this much finer than a fit's.
FINER = 8


@dataclass(frozen=True)
class Tones:
    """A sum of sines; arrays of one length."""

    freq_Hz: np.ndarray
    amplitude_m: np.ndarray
    phase_rad: np.ndarray

    def at(self, time_s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Displacement (m), velocity (m/s), acceleration (m/s2), exact; as long as time_s."""
        rate = 2.0 * np.pi * self.freq_Hz[:, None]
        angle = rate * np.atleast_1d(time_s) + self.phase_rad[:, None]
        size = self.amplitude_m[:, None]
        return (
            np.sum(size * np.sin(angle), axis=0),
            np.sum(size * rate * np.cos(angle), axis=0),
            np.sum(-size * rate**2 * np.sin(angle), axis=0),
        )


def random_tones(
    seed: int, band_Hz: tuple[float, float], amplitude_m: float, count: int = 24
) -> Tones:
    """Band-limited random motion: evenly spread frequencies, moved at random by up to half their
    distance; random phases; amplitudes as 1 / frequency, so that each has the same speed. The
    root mean square of the displacement is amplitude_m / 2."""
    rng = np.random.default_rng(seed)
    low, high = band_Hz
    width = (high - low) / count
    freq_Hz = low + width * (np.arange(count) + rng.uniform(0.0, 1.0, count))
    size = 1.0 / freq_Hz
    size *= 0.5 * amplitude_m / np.sqrt(0.5 * np.sum(size**2))
    return Tones(freq_Hz, size, rng.uniform(0.0, 2.0 * np.pi, count))


def record_of(
    tones: Tones, rate_Hz: float, samples: int, current_A: np.ndarray | float = 0.0
) -> Record:
    """A test without force."""
    time_s = np.arange(samples) / rate_Hz
    return motion_record(time_s, *tones.at(time_s), rate_Hz, current_A)


def motion_record(
    time_s: np.ndarray,
    disp_m: np.ndarray,
    velocity_m_s: np.ndarray,
    accel_m_s2: np.ndarray,
    rate_Hz: float,
    current_A: np.ndarray | float = 0.0,
) -> Record:
    command = np.broadcast_to(np.asarray(current_A, float), time_s.shape).copy()
    zero = np.zeros(len(time_s))
    return Record(
        "synthetic", rate_Hz, time_s, disp_m, velocity_m_s, accel_m_s2, zero, command, "A"
    )


def row_of(one: Model, values: Sequence[float]) -> np.ndarray:
    """The library's row of constant parameters without a rig."""
    assert len(values) == len(one.parameters)
    return np.concatenate([np.asarray(values, float), np.zeros(len(RIG))])


def finest_steps(one: Model, row: np.ndarray, record: Record, finer: int = FINER) -> int:
    """Substeps a sample that are `finer` times more than the row's rates ask for."""
    orders = [1] * len(one.parameters)
    rate = float(library.fastest_rates(one, orders, row, record)[0]) if one.states else 0.0
    return min(finer * library.substeps_for(rate, record.rate_Hz), library.MAX_SUBSTEPS)


def force_of(one: Model, row: np.ndarray, record: Record, steps: int) -> np.ndarray:
    """Forces in N of one row of constant parameters."""
    orders = [1] * len(one.parameters)
    return library.simulate(one, orders, row, library.motion(record), steps)[0]


def with_force(
    record: Record, force_N: np.ndarray, noise_part: float = 0.0, seed: int = 0
) -> Record:
    """The record with this force and white noise of deviation noise_part times its RMS."""
    deviation_N = noise_part * float(np.sqrt(np.mean(force_N**2)))
    noise_N = deviation_N * np.random.default_rng(seed).standard_normal(len(force_N))
    return replace(record, force_N=force_N + noise_N)
