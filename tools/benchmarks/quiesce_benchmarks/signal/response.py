"""How the chain follows a change, how far its validity can be trusted, and the RMS.

Steps are phase-continuous at constant acceleration amplitude, at 20 dB.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce_benchmarks.seeds import generator
from quiesce_benchmarks.signal.records import (
    WRONG_SHARE,
    AMPLITUDE_m_s2,
    Rig,
    Tally,
    log_uniform,
    noise_rms,
    random_phase,
    switched,
    tally_switched,
    tone,
    with_noise,
)
from quiesce_benchmarks.signal.rms import rms_error

STEPS_Hz = ((10.0, 20.0), (5.0, 10.0), (20.0, 5.0))
STEP_SNR_dB = 20
BEFORE_s, AFTER_s = 2.0, 1.5
SPREAD_TICKS = 256
SETTLED_SHARE = 0.05

STEADY_SNRS_dB = (10, 20, 30, 40, 60)
STEADY_s, STEADY_FROM_s = 4.0, 1.5
STEADY_AMPLITUDES_m_s2 = (0.1, 10.0)

DROPOUT_BAND_Hz = (2.0, 48.0)
DROPOUT_s = (0.020, 0.100)
RECOVERY_MARGIN_s = 0.1
COLUMNS = ("freq_is_valid", "freq_uHz", "freq_window_ms", "rms_um_s2")


@dataclass(frozen=True)
class Step:
    """Many steps from one frequency to another. Times count from the first new sample."""

    from_Hz: float
    to_Hz: float
    settle_s: np.ndarray  # to stay within 5 %; not settled: the record's end
    never_settled: int
    invalid_after_s: np.ndarray  # until first invalid; never: the record's end
    never_invalid: int
    not_valid_before: int  # records whose frequency was not valid when the step came
    valid_again_s: np.ndarray  # until valid and within 5 %; never: the record's end
    traces: dict[str, np.ndarray]  # "freq_Hz", "is_valid" around the step, records x ticks
    rate_Hz: int
    rms_error: float
    tally: Tally

    @property
    def name(self) -> str:
        return f"{self.from_Hz:g}_{self.to_Hz:g}"

    def row(self) -> dict[str, Any]:
        return {
            "step": f"{self.from_Hz:g} -> {self.to_Hz:g} Hz",
            "trials": len(self.settle_s),
            "settle_worst_s": float(self.settle_s.max()),
            "settle_p90_s": float(np.quantile(self.settle_s, 0.9)),
            "settle_median_s": float(np.median(self.settle_s)),
            "never_settled": self.never_settled,
            "invalid_after_worst_ms": 1e3 * float(self.invalid_after_s.max()),
            "invalid_after_median_ms": 1e3 * float(np.median(self.invalid_after_s)),
            "never_invalid": self.never_invalid,
            "not_valid_before": self.not_valid_before,
            "valid_again_worst_s": float(self.valid_again_s.max()),
            "valid_again_median_s": float(np.median(self.valid_again_s)),
        }


@dataclass(frozen=True)
class Steady:
    """Steady tones at one SNR."""

    snr_dB: int
    freq_Hz: np.ndarray
    valid_share: np.ndarray  # of the ticks after the start, one a record
    rms_error: float  # largest relative error against float64
    tally: Tally

    def row(self) -> dict[str, Any]:
        worst = int(np.argmin(self.valid_share))
        return {
            "snr_dB": self.snr_dB,
            "trials": len(self.freq_Hz),
            "valid_pct": 100.0 * float(self.valid_share.mean()),
            "least_valid_pct": 100.0 * float(self.valid_share[worst]),
            "least_valid_at_Hz": float(self.freq_Hz[worst]),
            "valid_but_wrong_pct": self.tally.wrong_pct,
            "rms_error_pct": 100.0 * self.rms_error,
        }


@dataclass(frozen=True)
class Dropouts:
    """Gaps of missing samples in a steady tone."""

    gap_s: np.ndarray
    freq_Hz: np.ndarray
    recovery_s: np.ndarray  # from the gap's end until valid and right; never: the record's end
    invalid_share: np.ndarray  # of the ticks inside the gap
    tally: Tally

    def row(self) -> dict[str, Any]:
        worst = int(np.argmax(self.recovery_s))
        return {
            "trials": len(self.gap_s),
            "recovery_worst_s": float(self.recovery_s[worst]),
            "worst_at": {
                "freq_Hz": float(self.freq_Hz[worst]),
                "gap_ms": 1e3 * float(self.gap_s[worst]),
            },
            "recovery_median_s": float(np.median(self.recovery_s)),
            "valid_in_gap_pct": 100.0 * float(1.0 - self.invalid_share.mean()),
            "valid_but_wrong_pct": self.tally.wrong_pct,
        }


def ticks_until_lasting(is_good: np.ndarray, from_tick: np.ndarray) -> np.ndarray:
    """Ticks from from_tick of each record to the first one from which all are good.

    Records that end badly: all ticks to the end.
    """
    ticks = is_good.shape[1]
    last_bad = ticks - 1 - np.argmax(~is_good[:, ::-1], axis=1)
    last_bad = np.where(is_good.all(axis=1), -1, last_bad)
    return np.maximum(last_bad + 1 - from_tick, 0)


def ticks_until_first(is_good: np.ndarray, from_tick: np.ndarray) -> np.ndarray:
    """Ticks from from_tick of each record to the first good one there; none: all to the end."""
    ticks = is_good.shape[1]
    found = is_good & (np.arange(ticks)[None, :] >= from_tick[:, None])
    first = np.where(found.any(axis=1), np.argmax(found, axis=1), ticks)
    return first - from_tick


def measure_step(rig: Rig, seed: int, trials: int, from_Hz: float, to_Hz: float) -> Step:
    rng = generator(seed, "step", from_Hz, to_Hz)
    rate_Hz = rig.rate_Hz
    ticks = rig.ticks(BEFORE_s + AFTER_s) + SPREAD_TICKS
    step = rig.ticks(BEFORE_s) + rng.integers(0, SPREAD_TICKS, trials)
    phase = random_phase(rng, trials)
    before_Hz, after_Hz = np.full(trials, from_Hz), np.full(trials, to_Hz)
    clean = switched(
        tone(before_Hz, phase, step, ticks, rate_Hz),
        tone(after_Hz, phase, step, ticks, rate_Hz),
        step,
    )
    noise = noise_rms(AMPLITUDE_m_s2, STEP_SNR_dB, rate_Hz)
    accel_m_s2 = with_noise(AMPLITUDE_m_s2 * clean, noise, rng)
    out = rig.run(accel_m_s2, COLUMNS)
    freq_Hz, is_valid = out["freq_uHz"] * 1e-6, out["freq_is_valid"] > 0
    is_near = np.abs(freq_Hz - to_Hz) <= SETTLED_SHARE * to_Hz
    is_old = np.arange(ticks)[None, :] < step[:, None]
    shown = step[:, None] + np.arange(-rig.ticks(0.1), rig.ticks(1.2))[None, :]
    rows = np.arange(trials)
    return Step(
        from_Hz=from_Hz,
        to_Hz=to_Hz,
        settle_s=ticks_until_lasting(is_near, step) / rate_Hz,
        never_settled=int((~is_near[:, -1]).sum()),
        invalid_after_s=ticks_until_first(~is_valid, step) / rate_Hz,
        never_invalid=int((is_valid | is_old).all(axis=1).sum()),
        not_valid_before=int((~is_valid[rows, step - 1]).sum()),
        valid_again_s=ticks_until_first(is_valid & is_near, step) / rate_Hz,
        traces={
            "freq_Hz": freq_Hz[rows[:, None], shown],
            "is_valid": is_valid[rows[:, None], shown],
        },
        rate_Hz=rate_Hz,
        rms_error=rms_error(rig, accel_m_s2, out["rms_um_s2"]),
        tally=tally_switched(rig, out, before_Hz, after_Hz, step),
    )


def measure_steady(rig: Rig, seed: int, trials: int, snr_dB: int) -> Steady:
    rng = generator(seed, "steady", snr_dB)
    freq_Hz = log_uniform(rng, *rig.band_Hz, trials)
    amplitude = log_uniform(rng, *STEADY_AMPLITUDES_m_s2, trials)
    clean = tone(freq_Hz, random_phase(rng, trials), 0, rig.ticks(STEADY_s), rig.rate_Hz)
    noise = noise_rms(amplitude, snr_dB, rig.rate_Hz)
    accel_m_s2 = with_noise(amplitude[:, None] * clean, noise, rng)
    out = rig.run(accel_m_s2, COLUMNS)
    tally = Tally()
    tally.add(out["freq_uHz"], out["freq_is_valid"], freq_Hz[:, None])
    return Steady(
        snr_dB=snr_dB,
        freq_Hz=freq_Hz,
        valid_share=(out["freq_is_valid"][:, rig.ticks(STEADY_FROM_s) :] > 0).mean(axis=1),
        rms_error=rms_error(rig, accel_m_s2, out["rms_um_s2"]),
        tally=tally,
    )


def measure_dropouts(rig: Rig, seed: int, trials: int) -> Dropouts:
    rng = generator(seed, "dropouts")
    rate_Hz = rig.rate_Hz
    ticks = rig.ticks(BEFORE_s + AFTER_s) + SPREAD_TICKS
    freq_Hz = log_uniform(rng, *DROPOUT_BAND_Hz, trials)
    gap = np.rint(rng.uniform(*DROPOUT_s, trials) * rate_Hz).astype(int)
    start = rig.ticks(BEFORE_s) + rng.integers(0, SPREAD_TICKS, trials)
    at = np.arange(ticks)[None, :]
    missing = (at >= start[:, None]) & (at < (start + gap)[:, None])
    clean = tone(freq_Hz, random_phase(rng, trials), 0, ticks, rate_Hz)
    noise = noise_rms(AMPLITUDE_m_s2, STEP_SNR_dB, rate_Hz)
    accel_m_s2 = with_noise(AMPLITUDE_m_s2 * clean, noise, rng)
    out = rig.run(accel_m_s2, COLUMNS, missing)
    is_valid = out["freq_is_valid"] > 0
    is_right = np.abs(out["freq_uHz"] * 1e-6 / freq_Hz[:, None] - 1.0) <= WRONG_SHARE
    tally = Tally()
    tally.add(out["freq_uHz"], is_valid, freq_Hz[:, None])
    return Dropouts(
        gap_s=gap / rate_Hz,
        freq_Hz=freq_Hz,
        recovery_s=ticks_until_first(is_valid & is_right, start + gap) / rate_Hz,
        invalid_share=(missing & ~is_valid).sum(axis=1) / gap,
        tally=tally,
    )
