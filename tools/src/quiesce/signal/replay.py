"""Runs the firmware's chain over a recorded acceleration, through the bench."""

import csv
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.engine.bench import Bench, setting_options, target_options
from quiesce.engine.params import effective_params
from quiesce.engine.trace import Trace, read_trace
from quiesce.signal.recording import Recording
from quiesce.signal.resample import resample

# The decimator before the spectrum (firmware/sense/decimate.h).
SPECTRUM_RATE_Hz = 250
STAGE_DELAY_SAMPLES = 5

# Telemetry that goes into replay.csv, under its C names.
CSV_COLUMNS = (
    "accel_um_s2",
    "freq_is_valid",
    "freq_uHz",
    "freq_amp_um_s2",
    "freq_window_ms",
    "rms_um_s2",
    "state",
    "fault",
    "current_cmd_mA",
)


@dataclass(frozen=True)
class Replayed:
    """What the chain made of a recording: one row a tick, times on the recording's own axis."""

    tick_rate_Hz: int
    time_s: np.ndarray
    trace: Trace
    summary: dict[str, Any]  # the bench's own

    @property
    def latency_s(self) -> np.ndarray:
        """Of the frequency, at each tick."""
        return frequency_latency_s(self.trace["freq_window_ms"], self.tick_rate_Hz)

    @property
    def updates(self) -> slice:
        """One tick for each new frequency."""
        return slice(None, None, self.tick_rate_Hz // SPECTRUM_RATE_Hz)


def frequency_latency_s(window_ms: np.ndarray, tick_rate_Hz: int) -> np.ndarray:
    """By how much the frequency lags: half its window, and the half-band stages before it."""
    rate_Hz, delay_s = tick_rate_Hz, 0.0
    while rate_Hz > SPECTRUM_RATE_Hz:
        delay_s += STAGE_DELAY_SAMPLES / rate_Hz
        rate_Hz //= 2
    return 0.5e-3 * window_ms + delay_s


def sensor_counts(accel_m_s2: np.ndarray, params: dict[str, int]) -> np.ndarray:
    """Counts of the sensor that the parameters describe, clipped at its full scale."""
    counts = accel_m_s2 * params["accel_polarity"] / (params["accel_scale_nm_s2"] * 1e-9)
    full_scale = params["accel_full_scale_counts"]
    counts = np.rint(counts + params["accel_offset_counts"])
    return np.clip(counts, -full_scale, full_scale).astype("<i4")


def replay(
    bench: Bench, recording: Recording, column: str, settings: Sequence[str], target: str
) -> Replayed:
    """UsageError for settings that the controller refuses or a target that cannot run."""
    params = effective_params(bench, settings)
    rate_Hz = params["tick_rate_Hz"]
    accel_m_s2 = resample(recording.accel_m_s2[column], recording.rate_Hz, rate_Hz)
    options = [*setting_options(settings), *target_options(target)]
    with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
        counts_file, trace_file = Path(folder) / "counts", Path(folder) / "trace"
        sensor_counts(accel_m_s2, params).tofile(counts_file)
        summary = bench.json(
            "replay", "--counts", str(counts_file), "--trace", str(trace_file), *options
        )
        trace = read_trace(trace_file, list(CSV_COLUMNS))
    time_s = recording.start_s + np.arange(len(accel_m_s2)) / rate_Hz
    return Replayed(rate_Hz, time_s, trace, summary)


def write_csv(file: Path, replayed: Replayed, every_ticks: int) -> None:
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["t_s", *CSV_COLUMNS])
        columns = [replayed.trace[name].astype(int)[::every_ticks] for name in CSV_COLUMNS]
        for time_s, *values in zip(replayed.time_s[::every_ticks], *columns, strict=True):
            writer.writerow([f"{time_s:.6f}".rstrip("0").rstrip("."), *values])


def summarize(replayed: Replayed) -> dict[str, Any]:
    """The figures of a replay, for people and for --json."""
    trace = replayed.trace
    valid = trace["freq_is_valid"] > 0
    freq_Hz = trace["freq_uHz"][valid] * 1e-6
    return {
        "target": replayed.summary["target"],
        "tick_rate_Hz": replayed.tick_rate_Hz,
        "ticks": len(valid),
        "valid_pct": round(100.0 * float(valid.mean()), 3),
        "first_valid_s": round(float(replayed.time_s[valid][0]), 3) if valid.any() else None,
        "median_freq_Hz": round(float(np.median(freq_Hz)), 4) if valid.any() else None,
        "latency_s": round(float(np.median(replayed.latency_s[valid])), 4) if valid.any() else None,
        "max_rms_m_s2": round(float(trace["rms_um_s2"].max()) * 1e-6, 6),
        "mean_current_A": round(float(trace["current_cmd_mA"].mean()) * 1e-3, 4),
        "faults_seen": replayed.summary["faults_seen"],
    }
