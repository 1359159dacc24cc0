"""Frequency and phase of a tone in noise against what theory allows.

Each record: a sine 30 % away, then the sine that counts, with a phase of its own, so that memory
of what was before cannot help. Read once a record, at its end.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce_benchmarks.seeds import generator
from quiesce_benchmarks.signal.bounds import sine_bound
from quiesce_benchmarks.signal.records import (
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

SNRS_dB = (-5, 0, 10, 20, 30, 40, 60)
# Where the goals bind.
GATED_SNRS_dB = (0, 10, 20, 30, 40)
HIGH_SNR_dB = 60
REPORTED_SNR_dB = -5
BAND_Hz = (2.1, 48.0)
# Groups of trials: random frequencies, and fixed ones.
GROUPS = {"band": None, "5 Hz": 5.0, "10 Hz": 10.0, "20 Hz": 20.0}
DISTANCE = 1.3
MIN_CYCLES = 2.0
OLD_s, NEW_s = 1.5, 1.6
# The end of the record, spread over so many ticks against the firmware's own rhythms.
SPREAD_TICKS = 64
# The full window is looked for in the record's last part.
READ_s = 0.3
OUTLIER_SHARE = 0.10
EXCESS_FACTOR = 1.5
OCTAVES_Hz = (2.1, 4.0, 8.0, 16.0, 32.0, 48.0)
COLUMNS = ("freq_is_valid", "freq_uHz", "freq_phase_mdeg", "freq_window_ms", "freq_amp_um_s2")


@dataclass(frozen=True)
class Readings:
    """One reading a record."""

    freq_Hz: np.ndarray  # truth
    error_Hz: np.ndarray
    bound_Hz: np.ndarray
    phase_error_deg: np.ndarray
    phase_bound_deg: np.ndarray
    amplitude_error: np.ndarray  # relative
    window_ms: np.ndarray  # as reported; 0: there was no estimate
    is_valid: np.ndarray

    def where(self, chosen: np.ndarray) -> "Readings":
        return Readings(**{name: values[chosen] for name, values in vars(self).items()})

    @property
    def is_counted(self) -> np.ndarray:
        """At least two cycles in the window; a reading without a window counts."""
        has_cycles = self.freq_Hz * self.window_ms * 1e-3 >= MIN_CYCLES
        return has_cycles | (self.window_ms == 0)

    @property
    def ratio(self) -> float:
        """RMS of the frequency error over its bound."""
        return rms(self.error_Hz / self.bound_Hz)

    @property
    def phase_excess_deg(self) -> float:
        return rms(self.phase_error_deg) - EXCESS_FACTOR * rms(self.phase_bound_deg)

    @property
    def outlier_pct(self) -> float:
        return 100.0 * float(np.mean(np.abs(self.error_Hz) > OUTLIER_SHARE * self.freq_Hz))


@dataclass(frozen=True)
class Group:
    """Readings at one SNR, of random frequencies ("band") or of one ("10 Hz")."""

    snr_dB: int
    name: str
    trials: int  # fewer are counted where the window is too short for two cycles
    readings: Readings
    tally: Tally


def worst_ratio(groups: Sequence[Group], snrs_dB: Sequence[int]) -> float:
    return max(group.readings.ratio for group in groups if group.snr_dB in snrs_dB)


def phase_excess_deg(groups: Sequence[Group]) -> float:
    return max(g.readings.phase_excess_deg for g in groups if g.snr_dB != REPORTED_SNR_dB)


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else float("nan")


def octave_ratios(r: Readings) -> dict[str, float]:
    octaves = zip(OCTAVES_Hz[:-1], OCTAVES_Hz[1:], strict=True)
    return {
        f"{low:g}-{high:g} Hz": r.where((r.freq_Hz >= low) & (r.freq_Hz < high)).ratio
        for low, high in octaves
    }


def row(group: Group) -> dict[str, Any]:
    """Of the context: one SNR and group."""
    r = group.readings
    return {
        "snr_dB": group.snr_dB,
        "group": group.name,
        "trials": group.trials,
        "counted": len(r.freq_Hz),
        "rmse_over_bound": r.ratio,
        "rmse_Hz": rms(r.error_Hz),
        "bound_Hz": rms(r.bound_Hz),
        "median_abs_error_over_bound": float(np.median(np.abs(r.error_Hz / r.bound_Hz))),
        "phase_rms_deg": rms(r.phase_error_deg),
        "phase_bound_deg": rms(r.phase_bound_deg),
        "phase_excess_deg": r.phase_excess_deg,
        "amplitude_rms_error_pct": 100.0 * rms(r.amplitude_error),
        "outlier_pct": r.outlier_pct,
        "invalid_pct": 100.0 * float(np.mean(~r.is_valid)),
        "no_window_pct": 100.0 * float(np.mean(r.window_ms == 0)),
        "window_ms": float(np.median(r.window_ms)),
        "rmse_over_bound_by_octave": octave_ratios(r) if group.name == "band" else None,
    }


def neighbour_Hz(
    freq_Hz: np.ndarray, band_Hz: tuple[float, float], rng: np.random.Generator
) -> np.ndarray:
    """30 % away, up or down, inside the band."""
    up = rng.integers(0, 2, freq_Hz.size).astype(bool)
    up = np.where(freq_Hz * DISTANCE > band_Hz[1], False, up)
    up = np.where(freq_Hz / DISTANCE < band_Hz[0], True, up)
    return np.where(up, freq_Hz * DISTANCE, freq_Hz / DISTANCE)


def reading_tick(window_ms: np.ndarray, full_ms: int, last_ticks: int) -> np.ndarray:
    """Of each record: the last tick among its last ones with the full window, else the last."""
    ticks = window_ms.shape[1]
    is_full = window_ms[:, ticks - last_ticks :] >= full_ms
    back = np.argmax(is_full[:, ::-1], axis=1)
    return ticks - 1 - np.where(is_full.any(axis=1), back, 0)


def wrapped_deg(angle_deg: np.ndarray) -> np.ndarray:
    """In -180 .. 180."""
    return (angle_deg + 180.0) % 360.0 - 180.0


def measure_group(
    rig: Rig, snr_dB: int, freq_Hz: np.ndarray, rng: np.random.Generator
) -> tuple[Readings, Tally]:
    count, rate_Hz = freq_Hz.size, rig.rate_Hz
    ticks = rig.ticks(OLD_s + NEW_s) + SPREAD_TICKS
    step = rig.ticks(OLD_s) + rng.integers(0, SPREAD_TICKS, count)
    before_Hz = neighbour_Hz(freq_Hz, rig.band_Hz, rng)
    phase = random_phase(rng, count)
    clean = switched(
        tone(before_Hz, random_phase(rng, count), step, ticks, rate_Hz),
        tone(freq_Hz, phase, step, ticks, rate_Hz),
        step,
    )
    noise = noise_rms(AMPLITUDE_m_s2, snr_dB, rate_Hz)
    out = rig.run(with_noise(AMPLITUDE_m_s2 * clean, noise, rng), COLUMNS)
    tally = tally_switched(rig, out, before_Hz, freq_Hz, step)

    at = reading_tick(out["freq_window_ms"], rig.longest_window_ms, rig.ticks(READ_s))
    read = {name: values[np.arange(count), at].astype(float) for name, values in out.items()}
    phase_there = phase + 2.0 * np.pi * freq_Hz * (at - step) / rate_Hz
    # A reading without a window is charged with the bound of the longest one.
    window_ms = read["freq_window_ms"]
    used_ms = np.where(window_ms > 0, window_ms, rig.longest_window_ms)
    window_ticks = np.rint(used_ms * 1e-3 * rate_Hz).astype(int)
    bound = sine_bound(freq_Hz, phase_there, AMPLITUDE_m_s2, noise, window_ticks, rate_Hz)
    # And without a window nothing was estimated: the whole frequency is the error.
    told_Hz = np.where(window_ms > 0, read["freq_uHz"] * 1e-6, 0.0)
    readings = Readings(
        freq_Hz=freq_Hz,
        error_Hz=told_Hz - freq_Hz,
        bound_Hz=bound.freq_Hz,
        phase_error_deg=wrapped_deg(read["freq_phase_mdeg"] * 1e-3 - np.degrees(phase_there)),
        phase_bound_deg=np.degrees(bound.phase_rad),
        amplitude_error=read["freq_amp_um_s2"] * 1e-6 / AMPLITUDE_m_s2 - 1.0,
        window_ms=window_ms,
        is_valid=read["freq_is_valid"] > 0,
    )
    return readings.where(readings.is_counted), tally


def measure_accuracy(rig: Rig, seed: int, trials: int, snr_dB: int, name: str) -> Group:
    """One group of GROUPS at one SNR."""
    rng = generator(seed, "accuracy", snr_dB, name)
    fixed_Hz = GROUPS[name]
    if fixed_Hz is None:
        freq_Hz = log_uniform(rng, *BAND_Hz, trials)
    else:
        freq_Hz = np.full(trials, fixed_Hz)
    readings, tally = measure_group(rig, snr_dB, freq_Hz, rng)
    return Group(snr_dB, name, trials, readings, tally)
