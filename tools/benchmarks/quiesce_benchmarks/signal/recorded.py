"""Measured vibration through the chain, against a reference sensor or an offline estimate."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from quiesce.base.errors import UsageError
from quiesce.base.paths import measurements
from quiesce.signal.recording import Recording, read_recording
from quiesce.signal.reference_peak import compare, reference_freq_Hz
from quiesce.signal.replay import SPECTRUM_RATE_Hz, frequency_latency_s
from quiesce.signal.resample import resample

from quiesce_benchmarks.signal.offline import trailing_Hz
from quiesce_benchmarks.signal.records import Rig

SWEEP_FROM_s = 23.0
SWEEP_TOLERANCE_Hz = 0.12
OFFLINE_LEAST_s = 0.01
OFFLINE_TOLERANCE = 0.02
COLUMNS = ("freq_is_valid", "freq_uHz", "freq_window_ms")


@dataclass(frozen=True)
class Source:
    file: str
    column: str
    reference_column: str | None = None


SWEEP = Source("shaker_sweep_0_11hz_100sps.csv", "mems_pkg_g", "ref_piezo_g")
SOURCES = (
    SWEEP,
    Source("shaker_sweep_15_16hz_400sps.csv", "mems_pkg_g", "ref_piezo_g"),
    Source("footbridge_b_shaker_5.5hz_639sps.csv", "acc0_g"),
    Source("footbridge_b_shaker_10.2hz_639sps.csv", "acc0_g"),
    Source("footbridge_b_shaker_15.0hz_639sps.csv", "acc0_g"),
)


@dataclass(frozen=True)
class Replay:
    """A recording through the chain; one entry a tick."""

    recording: Recording
    accel_m_s2: np.ndarray
    time_s: np.ndarray
    freq_Hz: np.ndarray
    is_valid: np.ndarray
    window_ms: np.ndarray


def default_folder() -> Path:
    """Beside the project; the recordings do not ship with it."""
    return measurements("vibration")


def find_folder(given: Path | None) -> Path:
    """UsageError where a folder is named and is not there."""
    if given is not None and not given.is_dir():
        raise UsageError(f"--data {given}: no such folder; name the one with {SWEEP.file}")
    return given or default_folder()


def replay_source(rig: Rig, folder: Path, source: Source) -> Replay:
    columns = [name for name in (source.column, source.reference_column) if name]
    recording = read_recording(folder / source.file, columns, "t_s")
    accel_m_s2 = resample(recording.accel_m_s2(source.column, "g"), recording.rate_Hz, rig.rate_Hz)
    out = rig.run(accel_m_s2[None, :], COLUMNS)
    return Replay(
        recording=recording,
        accel_m_s2=accel_m_s2,
        time_s=recording.start_s + np.arange(len(accel_m_s2)) / rig.rate_Hz,
        freq_Hz=out["freq_uHz"][0] * 1e-6,
        is_valid=out["freq_is_valid"][0] > 0,
        window_ms=out["freq_window_ms"][0],
    )


def against_reference(rig: Rig, replay: Replay, source: Source, from_s: float) -> dict[str, Any]:
    """The firmware's frequency at each update against the reference's own peak.

    Either describes the middle of its window; the latencies are taken out.
    """
    recording = replay.recording
    middle_s, reference_Hz = reference_freq_Hz(
        recording.accel_m_s2(source.reference_column, "g"), recording.rate_Hz
    )
    latency_s = frequency_latency_s(replay.window_ms, rig.rate_Hz)
    updates = np.flatnonzero(replay.time_s >= from_s)[:: rig.rate_Hz // SPECTRUM_RATE_Hz]
    agreement = compare(
        (replay.time_s - latency_s)[updates],
        replay.freq_Hz[updates],
        replay.is_valid[updates],
        recording.start_s + middle_s,
        reference_Hz,
        tolerance_Hz=SWEEP_TOLERANCE_Hz,
        from_s=from_s,
        to_s=float(replay.time_s[-1]),
    )
    return {
        "against": f"{source.reference_column}, strongest peak of a 2 s Hann window",
        "updates": agreement.updates,
        "valid_pct": agreement.valid_pct,
        "within_0p12Hz_pct": agreement.within_pct,
        "worst_Hz": agreement.worst_Hz,
    }


def against_offline(rig: Rig, replay: Replay, instants: int) -> dict[str, Any]:
    """The firmware's frequency against least squares over a trailing window of equal length.

    At about so many instants, evenly spread over the recording.
    """
    every = max(rig.ticks(OFFLINE_LEAST_s), len(replay.time_s) // instants)
    ends = np.arange(every - 1, len(replay.time_s), every)
    lengths = np.rint(replay.window_ms[ends] * 1e-3 * rig.rate_Hz).astype(int)
    offline_Hz = trailing_Hz(replay.accel_m_s2, ends, lengths, rig.rate_Hz)
    there = np.isfinite(offline_Hz)
    judged = replay.is_valid[ends] & there
    error_Hz = np.abs(replay.freq_Hz[ends] - offline_Hz)
    is_within = error_Hz <= OFFLINE_TOLERANCE * offline_Hz
    return {
        "against": "float64 least squares, trailing window of equal length",
        "compared": int(judged.sum()),
        "within_2pct_pct": share_pct(is_within[judged]),
        "median_error_Hz": float(np.median(error_Hz[judged])) if judged.any() else None,
        "offline_median_Hz": float(np.median(offline_Hz[judged])) if judged.any() else None,
        "within_2pct_valid_or_not_pct": share_pct(is_within[there]),
    }


def share_pct(is_it: np.ndarray) -> float | None:
    return 100.0 * float(is_it.mean()) if is_it.size else None


def row(rig: Rig, replay: Replay, source: Source, instants: int) -> dict[str, Any]:
    valid = replay.is_valid
    from_s = SWEEP_FROM_s if source is SWEEP else -np.inf
    return {
        "file": source.file,
        "valid_pct": 100.0 * float(valid.mean()),
        "first_valid_s": float(replay.time_s[valid][0]) if valid.any() else None,
        "median_freq_Hz": float(np.median(replay.freq_Hz[valid])) if valid.any() else None,
        "reference": against_reference(rig, replay, source, from_s)
        if source.reference_column
        else None,
        "offline": against_offline(rig, replay, instants),
    }


def measure_source(rig: Rig, folder: Path, source: Source, instants: int) -> dict[str, Any] | None:
    """instants: of the comparison with the offline estimate. None: the recording is not there."""
    if not (folder / source.file).is_file():
        return None
    return row(rig, replay_source(rig, folder, source), source, instants)


def sweep_within_pct(rows: list[dict[str, Any] | None]) -> float | None:
    """Share of the sweep's valid updates that agree; None where the recording is not there."""
    sweep = rows[SOURCES.index(SWEEP)]
    return sweep["reference"]["within_0p12Hz_pct"] if sweep else None
