"""Runs the firmware's chain over recorded motion, through the bench."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.engine.bench import Bench, setting_options, target_options
from quiesce.engine.board import Board, Sensor
from quiesce.engine.params import effective_params
from quiesce.engine.trace import Trace, read_trace
from quiesce.recording.write import time_text, write_columns
from quiesce.signal import picture
from quiesce.signal.channels import Channel, read_channels, tick_counts
from quiesce.signal.recording import M_S2_PER_UNIT, Recording

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
class Source:
    """What a recording feeds: the sensors of a board, or without one the accelerometer of the
    parameters."""

    channels: dict[str, Channel]  # by the name of the sensor
    board: Board | None = None

    @property
    def columns(self) -> list[str]:
        """Of the recording."""
        return list(dict.fromkeys(channel.column for channel in self.channels.values()))

    @property
    def csv_columns(self) -> list[str]:
        return [*CSV_COLUMNS, *(picture.columns(self.board) if self.board else [])]


def one_column(column: str, unit: str) -> Source:
    return Source({"accel": Channel(column, M_S2_PER_UNIT[unit])})


def board_columns(board: Board, words: Sequence[str]) -> Source:
    """words: NAME=COLUMN:UNIT of each sensor. UsageError where they do not fit the board."""
    return Source(read_channels(words, board), board)


@dataclass(frozen=True)
class Replayed:
    """What the chain made of a recording: one row a tick, times on the recording's own axis."""

    tick_rate_Hz: int
    time_s: np.ndarray
    trace: Trace
    summary: dict[str, Any]  # the bench's own
    board: Board | None = None

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


def own_sensor(params: dict[str, int]) -> Sensor:
    """The accelerometer that the parameters describe, in m/s2."""
    return Sensor(
        name="accel",
        measures="acceleration",
        unit="m/s2",
        unit_per_count=params["accel_scale_nm_s2"] * 1e-9,
        polarity=params["accel_polarity"],
        offset_counts=params["accel_offset_counts"],
        full_scale_counts=params["accel_full_scale_counts"],
        period_us=0,
    )


def replay(
    bench: Bench, recording: Recording, source: Source, settings: Sequence[str], target: str
) -> Replayed:
    """UsageError for settings that the controller refuses or a target that cannot run."""
    params = effective_params(bench, settings)
    rate_Hz, board = params["tick_rate_Hz"], source.board
    sensors = board.sensors if board else [own_sensor(params)]
    counts = tick_counts(recording, sensors, source.channels, rate_Hz)
    options = [*setting_options(settings), *target_options(target, has_board=board is not None)]
    options += ["--board", str(board.file)] if board else []
    with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
        counts_file, trace_file = Path(folder) / "counts", Path(folder) / "trace"
        counts.tofile(counts_file)
        files = ["--counts", str(counts_file), "--trace", str(trace_file)]
        summary = bench.json("replay", *files, *options)
        trace = read_trace(trace_file, source.csv_columns)
    time_s = recording.start_s + np.arange(len(counts)) / rate_Hz
    return Replayed(rate_Hz, time_s, trace, summary, board)


def write_telemetry(file: Path, replayed: Replayed, every_ticks: int) -> None:
    """In the format that the suffix asks for, text without one that is known."""
    columns = {name: values.astype(int)[::every_ticks] for name, values in replayed.trace.items()}
    write_columns(file, {"t_s": replayed.time_s[::every_ticks], **columns}, {"t_s": time_text})


def summarize(replayed: Replayed) -> dict[str, Any]:
    """The figures of a replay, for people and for --json."""
    trace = replayed.trace
    valid = trace["freq_is_valid"] > 0
    freq_Hz = trace["freq_uHz"][valid] * 1e-6
    rig = {}
    if replayed.board:
        rig["bodies"] = picture.body_figures(trace, replayed.board)
        rig["dampers"] = picture.damper_figures(trace, replayed.board)
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
        **rig,
    }
