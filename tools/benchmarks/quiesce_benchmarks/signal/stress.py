"""What sensors do to a steady tone: shocks, a tone that comes and goes, clipping. Reported only."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce_benchmarks.seeds import generator
from quiesce_benchmarks.signal.records import (
    WRONG_SHARE,
    AMPLITUDE_m_s2,
    OFFSET_m_s2,
    Rig,
    log_uniform,
    noise_rms,
    random_phase,
    tone,
    with_noise,
)
from quiesce_benchmarks.signal.response import ticks_until_first

SNR_dB = 20
BAND_Hz = (2.0, 48.0)
EVENT_s, RECORD_s = 2.0, 4.0
SHOCK_s, SHOCK_TIMES = 0.05, 10.0
PAUSE_s = 0.6
CLIP_SHARE = (0.5, 0.95)
OVERLOAD = (1.05, 1.5)
COLUMNS = ("freq_is_valid", "freq_uHz", "bad_sample_count")


@dataclass(frozen=True)
class Stress:
    """Records, and from which tick on of each a right frequency is waited for."""

    accel_m_s2: np.ndarray
    has_tone: np.ndarray  # where the tone is there, records x ticks
    wait_from: np.ndarray


def tones(rig: Rig, rng: np.random.Generator, freq_Hz: np.ndarray) -> np.ndarray:
    return tone(freq_Hz, random_phase(rng, freq_Hz.size), 0, rig.ticks(RECORD_s), rig.rate_Hz)


def shocks(rig: Rig, rng: np.random.Generator, freq_Hz: np.ndarray) -> Stress:
    """A burst of noise, ten times the tone, for 50 ms."""
    clean = AMPLITUDE_m_s2 * tones(rig, rng, freq_Hz)
    first, last = rig.ticks(EVENT_s), rig.ticks(EVENT_s + SHOCK_s)
    clean[:, first:last] += (
        SHOCK_TIMES * AMPLITUDE_m_s2 * rng.standard_normal((freq_Hz.size, last - first))
    )
    noise = noise_rms(AMPLITUDE_m_s2, SNR_dB, rig.rate_Hz)
    always = np.ones(clean.shape, dtype=bool)
    return Stress(with_noise(clean, noise, rng), always, np.full(freq_Hz.size, last))


def pauses(rig: Rig, rng: np.random.Generator, freq_Hz: np.ndarray) -> Stress:
    """The tone stops for 0.6 s and goes on."""
    clean = AMPLITUDE_m_s2 * tones(rig, rng, freq_Hz)
    first, last = rig.ticks(EVENT_s), rig.ticks(EVENT_s + PAUSE_s)
    has_tone = np.ones(clean.shape, dtype=bool)
    has_tone[:, first:last] = False
    noise = noise_rms(AMPLITUDE_m_s2, SNR_dB, rig.rate_Hz)
    return Stress(with_noise(clean * has_tone, noise, rng), has_tone, np.full(freq_Hz.size, last))


def clipped(rig: Rig, rng: np.random.Generator, freq_Hz: np.ndarray) -> Stress:
    """Flat tops at 50 .. 95 % of the amplitude, below the ADC's full scale: harmonics."""
    top = AMPLITUDE_m_s2 * rng.uniform(*CLIP_SHARE, (freq_Hz.size, 1))
    clean = AMPLITUDE_m_s2 * tones(rig, rng, freq_Hz)
    noise = noise_rms(AMPLITUDE_m_s2, SNR_dB, rig.rate_Hz)
    noisy = with_noise(clean, noise, rng) - OFFSET_m_s2
    # A live sensor shows noise on its flat tops as well.
    rest = with_noise(np.clip(noisy, -top, top), 0.01 * noise, rng)
    always = np.ones(clean.shape, dtype=bool)
    return Stress(rest, always, np.full(freq_Hz.size, rig.ticks(EVENT_s)))


def overloads(rig: Rig, rng: np.random.Generator, freq_Hz: np.ndarray) -> Stress:
    """Amplitudes of 1.05 .. 1.5 times the ADC's full scale: its samples count as saturated."""
    full_m_s2 = rig.params["accel_full_scale_counts"] * rig.params["accel_scale_nm_s2"] * 1e-9
    amplitude = full_m_s2 * rng.uniform(*OVERLOAD, freq_Hz.size)
    clean = amplitude[:, None] * tones(rig, rng, freq_Hz)
    noise = noise_rms(amplitude, SNR_dB, rig.rate_Hz)
    always = np.ones(clean.shape, dtype=bool)
    return Stress(with_noise(clean, noise, rng), always, np.full(freq_Hz.size, rig.ticks(EVENT_s)))


KINDS: dict[str, Callable[[Rig, np.random.Generator, np.ndarray], Stress]] = {
    "shock of 50 ms": shocks,
    "pause of 0.6 s": pauses,
    "flat tops": clipped,
    "beyond full scale": overloads,
}


def measure_stress(rig: Rig, seed: int, trials: int, kind: str) -> dict[str, Any]:
    rng = generator(seed, "stress", kind)
    freq_Hz = log_uniform(rng, *BAND_Hz, trials)
    stress = KINDS[kind](rig, rng, freq_Hz)
    out = rig.run(stress.accel_m_s2, COLUMNS)
    is_valid = out["freq_is_valid"] > 0
    is_right = np.abs(out["freq_uHz"] * 1e-6 / freq_Hz[:, None] - 1.0) <= WRONG_SHARE
    wait_s = ticks_until_first(is_valid & is_right, stress.wait_from) / rig.rate_Hz
    after = is_valid[:, rig.ticks(EVENT_s) :]
    return {
        "kind": kind,
        "trials": trials,
        "valid_after_pct": 100.0 * float(after.mean()),
        "valid_but_wrong_pct": 100.0 * float((is_valid & ~is_right).mean()),
        "valid_without_tone_pct": 100.0 * float((is_valid & ~stress.has_tone).mean()),
        "right_again_worst_s": float(wait_s.max()),
        "right_again_median_s": float(np.median(wait_s)),
        "bad_samples": int(out["bad_sample_count"][:, -1].sum()),
    }
