"""Which of two components is reported: the truth table of the dominant frequency.

{f and its third harmonic: f; unrelated tones: the one with most of the acceleration's energy, where
none has it the larger displacement; drift below the band and a tone: the tone}. Both components of
a case must be there to be seen: accelerations within a factor
of 10 of each other. Noise: 20 dB below the component that is to be reported.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce_benchmarks.seeds import generator
from quiesce_benchmarks.signal.records import (
    AMPLITUDE_m_s2,
    Rig,
    Tally,
    log_uniform,
    noise_rms,
    random_phase,
    tone,
    with_noise,
)

SNR_dB = 20
RECORD_s, READ_s = 3.0, 0.5
TOLERANCE = 0.02
HARMONIC_BASE_Hz = (1.5, 16.0)
HARMONIC_RATIO = (0.1, 3.0)  # acceleration of the third harmonic over the fundamental's
TONE_BAND_Hz = (2.0, 48.0)
ACCEL_RATIO = (0.1, 10.0)
MIN_SPACING_Hz = 3.0
MIN_DISPLACEMENT_RATIO = 1.2
# Of the acceleration's energy: from here on one tone is the strongest; up to here none is.
STRONGEST_SHARE, EQUAL_SHARE = 0.65, 0.55
HARMONIC_MARGIN = 0.03  # "unrelated" is farther than this from 1:3
DRIFT_BAND_Hz = (0.05, 0.6)
DRIFT_RATIO = (0.2, 5.0)
SHOWN_FAILURES = 20


@dataclass(frozen=True)
class Cases:
    """Two tones a case; the first is the one to be reported."""

    freq_Hz: np.ndarray  # cases x 2
    amplitude_m_s2: np.ndarray


@dataclass(frozen=True)
class Answers:
    kind: str
    cases: Cases
    correct_share: np.ndarray  # of the ticks that were read, one a case
    valid_share: np.ndarray
    told_Hz: np.ndarray  # at the last tick
    tally: Tally

    @property
    def is_correct(self) -> np.ndarray:
        """A case is correct where every tick that was read is."""
        return self.correct_share == 1.0

    def row(self) -> dict[str, Any]:
        wrong = np.flatnonzero(~self.is_correct)
        return {
            "kind": self.kind,
            "cases": len(self.is_correct),
            "correct_pct": 100.0 * float(self.is_correct.mean()),
            "correct_ticks_pct": 100.0 * float(self.correct_share.mean()),
            "valid_ticks_pct": 100.0 * float(self.valid_share.mean()),
            "valid_but_wrong_pct": self.tally.wrong_pct,
            "failed": [
                {
                    "freq_Hz": self.cases.freq_Hz[i].tolist(),
                    "amplitude_m_s2": self.cases.amplitude_m_s2[i].tolist(),
                    "told_Hz": float(self.told_Hz[i]),
                    "correct_ticks_pct": 100.0 * float(self.correct_share[i]),
                    "valid_ticks_pct": 100.0 * float(self.valid_share[i]),
                }
                for i in wrong[:SHOWN_FAILURES]
            ],
        }


def pair(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return np.stack([first, second], axis=1)


def harmonic_cases(rng: np.random.Generator, count: int) -> Cases:
    base_Hz = log_uniform(rng, *HARMONIC_BASE_Hz, count)
    ratio = log_uniform(rng, *HARMONIC_RATIO, count)
    amplitude = np.full(count, AMPLITUDE_m_s2)
    return Cases(pair(base_Hz, 3.0 * base_Hz), pair(amplitude, ratio * amplitude))


def is_clear(freq_Hz: np.ndarray, accel_ratio: np.ndarray) -> np.ndarray:
    """Whether the first tone is clearly the dominant one, and the tones are unrelated.

    accel_ratio: of the second tone over the first.
    """
    first, second = freq_Hz[:, 0], freq_Hz[:, 1]
    displacement_ratio = (second / first) ** 2 / accel_ratio
    share = 1.0 / (1.0 + accel_ratio**2)
    is_even = np.maximum(share, 1.0 - share) <= EQUAL_SHARE
    is_dominant = (share >= STRONGEST_SHARE) | (
        is_even & (displacement_ratio >= MIN_DISPLACEMENT_RATIO)
    )
    times = np.maximum(first, second) / np.minimum(first, second)
    return (
        (np.abs(first - second) >= MIN_SPACING_Hz)
        & is_dominant
        & (np.abs(times / 3.0 - 1.0) > HARMONIC_MARGIN)
    )


def unrelated_cases(rng: np.random.Generator, count: int) -> Cases:
    """Drawn until there are enough: either tone may be the higher or the stronger one."""
    kept_Hz, kept_ratio = np.empty((0, 2)), np.empty(0)
    while len(kept_ratio) < count:
        drawn = 4 * count
        freq_Hz = pair(
            log_uniform(rng, *TONE_BAND_Hz, drawn), log_uniform(rng, *TONE_BAND_Hz, drawn)
        )
        ratio = log_uniform(rng, *ACCEL_RATIO, drawn)
        clear = is_clear(freq_Hz, ratio)
        kept_Hz = np.concatenate([kept_Hz, freq_Hz[clear]])
        kept_ratio = np.concatenate([kept_ratio, ratio[clear]])
    amplitude = np.full(count, AMPLITUDE_m_s2)
    return Cases(kept_Hz[:count], pair(amplitude, kept_ratio[:count] * amplitude))


def drift_cases(rng: np.random.Generator, count: int) -> Cases:
    tone_Hz = log_uniform(rng, *TONE_BAND_Hz, count)
    drift_Hz = log_uniform(rng, *DRIFT_BAND_Hz, count)
    ratio = log_uniform(rng, *DRIFT_RATIO, count)
    amplitude = np.full(count, AMPLITUDE_m_s2)
    return Cases(pair(tone_Hz, drift_Hz), pair(amplitude, ratio * amplitude))


KINDS: dict[str, Callable[[np.random.Generator, int], Cases]] = {
    "f and 3f": harmonic_cases,
    "unrelated tones": unrelated_cases,
    "drift and a tone": drift_cases,
}


def measure_answers(rig: Rig, seed: int, count: int, kind: str) -> Answers:
    rng = generator(seed, "truth", kind)
    cases = KINDS[kind](rng, count)
    ticks = rig.ticks(RECORD_s)
    clean = sum(
        cases.amplitude_m_s2[:, i, None]
        * tone(cases.freq_Hz[:, i], random_phase(rng, count), 0, ticks, rig.rate_Hz)
        for i in range(2)
    )
    noise = noise_rms(cases.amplitude_m_s2[:, 0], SNR_dB, rig.rate_Hz)
    out = rig.run(with_noise(clean, noise, rng), ("freq_is_valid", "freq_uHz"))
    truth_Hz = cases.freq_Hz[:, :1]
    tally = Tally()
    tally.add(out["freq_uHz"], out["freq_is_valid"], truth_Hz)
    read = slice(ticks - rig.ticks(READ_s), None)
    told_Hz = out["freq_uHz"][:, read] * 1e-6
    is_valid = out["freq_is_valid"][:, read] > 0
    is_correct = is_valid & (np.abs(told_Hz / truth_Hz - 1.0) <= TOLERANCE)
    return Answers(
        kind=kind,
        cases=cases,
        correct_share=is_correct.mean(axis=1),
        valid_share=is_valid.mean(axis=1),
        told_Hz=told_Hz[:, -1],
        tally=tally,
    )
