"""Magnitude and phase of the conditioning, from the firmware's own coefficients, and measured."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from quiesce.engine.bench import Bench, setting_options
from quiesce.engine.params import effective_params
from quiesce.engine.trace import read_trace

# firmware/sense/condition.c: radians a second of one milli-hertz, Q32.
TWO_PI_PER_MILLI_Q32 = 26986075
# firmware/sense/decimate.c: one half-band stage, Q16; stages follow until 250 Hz are reached.
HALF_BAND_Q16 = (636, 0, -3808, 0, 19556, 32768, 19556, 0, -3808, 0, 636)
DECIMATED_RATE_Hz = 250
TICK_RATES_Hz = (500, 1000, 2000, 4000)

# The driving sine: half of the default sensor's full scale.
DRIVE_counts = 4_000_000
SETTLING_TIME_CONSTANTS = 12.0


def dc_removal(freq_Hz: np.ndarray, cutoff_mHz: int, tick_rate_Hz: int) -> np.ndarray:
    """Complex response of the DC removal: y = x - dc, then dc += gain y, a tick later in effect."""
    omega_q32 = cutoff_mHz * TWO_PI_PER_MILLI_Q32 // tick_rate_Hz
    gain = (omega_q32 - (omega_q32 * omega_q32 >> 32)) / 2**32
    back = np.exp(-2j * np.pi * np.asarray(freq_Hz) / tick_rate_Hz)
    return (1.0 - back) / (1.0 - (1.0 - gain) * back)


def decimation(freq_Hz: np.ndarray, tick_rate_Hz: int) -> tuple[np.ndarray, float]:
    """Real amplitude of the decimation to 250 Hz, and its delay in s: its phase is exactly linear.

    A frequency above 125 Hz appears at its distance from the nearest multiple of 250 Hz.
    """
    freq_Hz = np.asarray(freq_Hz, dtype=float)
    amplitude, delay_s, rate_Hz = np.ones_like(freq_Hz), 0.0, tick_rate_Hz
    middle = len(HALF_BAND_Q16) // 2
    while rate_Hz > DECIMATED_RATE_Hz:
        stage = np.zeros_like(freq_Hz)
        for tap, weight_q16 in enumerate(HALF_BAND_Q16):
            stage += weight_q16 / 2**16 * np.cos(2 * np.pi * freq_Hz / rate_Hz * (tap - middle))
        amplitude *= stage
        delay_s += middle / rate_Hz
        rate_Hz //= 2
    return amplitude, delay_s


def alias_rejection_dB(tick_rate_Hz: int, band_Hz: float) -> float:
    """Least attenuation of what folds into 0 .. band_Hz."""
    freq_Hz = np.arange(DECIMATED_RATE_Hz / 2, tick_rate_Hz / 2 + 0.125, 0.25)
    folded_Hz = np.abs(freq_Hz - DECIMATED_RATE_Hz * np.rint(freq_Hz / DECIMATED_RATE_Hz))
    amplitude, _ = decimation(freq_Hz[folded_Hz <= band_Hz], tick_rate_Hz)
    return float(-decibels(np.abs(amplitude).max()))


def decibels(amplitude: np.ndarray) -> np.ndarray:
    return 20.0 * np.log10(amplitude)


def degrees(response: np.ndarray) -> np.ndarray:
    return np.degrees(np.angle(response))


def measure_dc_removal(bench: Bench, freq_Hz: float, cutoff_mHz: int, tick_rate_Hz: int) -> complex:
    """Drives the firmware with a sine and compares accel_um_s2 with what went in."""
    settling_s = SETTLING_TIME_CONSTANTS * 1000.0 / (2.0 * np.pi * cutoff_mHz)
    first = int(np.ceil(settling_s * tick_rate_Hz))
    # Whole cycles; enough of them that the rounding averages out.
    cycles = max(2, int(np.ceil(freq_Hz)))
    ticks = first + round(cycles * tick_rate_Hz / freq_Hz)
    turns = np.arange(ticks) * freq_Hz / tick_rate_Hz
    counts = np.rint(DRIVE_counts * np.cos(2 * np.pi * turns)).astype("<i4")
    accel_m_s2 = conditioned(bench, counts, cutoff_mHz, tick_rate_Hz)
    sent_m_s2 = counts * (effective_params(bench, [])["accel_scale_nm_s2"] * 1e-9)
    return fitted(accel_m_s2[first:], turns[first:]) / fitted(sent_m_s2[first:], turns[first:])


def conditioned(bench: Bench, counts: np.ndarray, cutoff_mHz: int, tick_rate_Hz: int) -> np.ndarray:
    """accel_um_s2 of every tick in m/s2; every other parameter at its default."""
    settings = [f"tick_rate_Hz={tick_rate_Hz}", f"dc_cutoff_mHz={cutoff_mHz}"]
    with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
        counts_file, trace_file = Path(folder) / "counts", Path(folder) / "trace"
        counts.tofile(counts_file)
        files = ["--counts", str(counts_file), "--trace", str(trace_file)]
        bench.call("replay", *files, *setting_options(settings))
        return read_trace(trace_file, ["accel_um_s2"])["accel_um_s2"] * 1e-6


def fitted(values: np.ndarray, turns: np.ndarray) -> complex:
    """Complex amplitude of the sine at `turns` by least squares, a constant beside it."""
    angle = 2 * np.pi * turns
    basis = np.column_stack([np.cos(angle), -np.sin(angle), np.ones_like(angle)])
    real, imaginary, _ = np.linalg.lstsq(basis, values, rcond=None)[0]
    return complex(real, imaginary)


def largest_difference(
    bench: Bench, freqs_Hz: Sequence[float], cutoff_mHz: int
) -> tuple[float, float]:
    """Computed against measured DC removal, over the frequencies and all tick rates: dB, degree."""
    worst_dB = worst_deg = 0.0
    for rate_Hz in TICK_RATES_Hz:
        for freq_Hz in freqs_Hz:
            measured = measure_dc_removal(bench, freq_Hz, cutoff_mHz, rate_Hz)
            ratio = measured / complex(dc_removal(np.array(freq_Hz), cutoff_mHz, rate_Hz))
            worst_dB = max(worst_dB, abs(float(decibels(abs(ratio)))))
            worst_deg = max(worst_deg, abs(float(np.degrees(np.angle(ratio)))))
    return worst_dB, worst_deg
