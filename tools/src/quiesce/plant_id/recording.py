"""A recording of `quiesce sweep`'s excitation, read, checked and cut into its parts.

The parts are found from the recorded drive and current alone, so that levels, order and lengths
may differ from what was planned. Poor data are told as warnings; what cannot be used is refused.
"""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.plant_id.sweep import COLUMNS
from quiesce.recording.table import at
from quiesce.signal.recording import check_time, check_uniform, read_columns

# Drive below this part of its largest value counts as none.
QUIET_PART = 0.02
# A pause of the drive at least this long separates two parts.
MIN_REST_s = 0.25
# A drive that differs from one sine by less than this (RMS, relative) is a dwell.
SINE_PART = 0.1
MIN_SWEEP_s = 5.0
MIN_PERIODS = 10


@dataclass(frozen=True)
class Part:
    """Samples first .. end - 1 have drive; it rests from `before` to first and from end to next."""

    before: int
    first: int
    end: int
    next: int


@dataclass(frozen=True)
class Dwell:
    """One frequency: drive = amplitude_V sin(2 pi (freq_Hz t + start_cycles)), t = 0 at first."""

    part: Part
    freq_Hz: float
    amplitude_V: float
    start_cycles: float


@dataclass
class SweepRecording:
    file: Path
    rate_Hz: int
    drive_V: np.ndarray
    current_A: np.ndarray
    accel_m_s2: np.ndarray  # offset removed
    noise_m_s2: float  # RMS of a sample at rest
    offset_m_s2: float
    sweeps: list[Part]
    dwells: list[Dwell]
    warnings: list[str] = field(default_factory=list)


def read_sweep_recording(file: Path) -> SweepRecording:
    """UsageError, with the line where there is one, for what cannot be identified from."""
    lines, table = read_columns(file, list(COLUMNS))
    time_s, drive_V, current_A, accel_m_s2 = table.T
    rate_Hz = whole_rate(file, lines, time_s)
    if (current_A < 0.0).any():
        row = int(np.argmax(current_A < 0.0))
        raise at(
            file, lines[row], f"column 'current_cmd_A': {current_A[row]:g} A; expected 0 or more"
        )
    parts = find_parts(file, drive_V, rate_Hz)
    rest = rest_samples(file, parts, rate_Hz)
    offset_m_s2, noise_m_s2 = float(accel_m_s2[rest].mean()), float(accel_m_s2[rest].std())
    accel_m_s2 = accel_m_s2 - offset_m_s2
    loudest = float(np.abs(accel_m_s2).max())
    if loudest == 0.0:
        raise UsageError(
            f"{shown(file)}: column 'accel_m_s2' never changes; is the sensor connected?"
        )
    recording = SweepRecording(
        file=file,
        rate_Hz=rate_Hz,
        drive_V=drive_V,
        current_A=current_A,
        accel_m_s2=accel_m_s2,
        # A noiseless recording still has rounding; its weight must stay finite.
        noise_m_s2=max(noise_m_s2, 1e-6 * loudest),
        offset_m_s2=offset_m_s2,
        sweeps=[],
        dwells=[],
    )
    sort_parts(recording, parts, lines)
    recording.warnings += quality_warnings(recording)
    return recording


def whole_rate(file: Path, lines: list[int], time_s: np.ndarray) -> int:
    """The sampling rate, which must be a whole number of Hz."""
    check_time(file, COLUMNS[0], lines, time_s)
    period_s = (time_s[-1] - time_s[0]) / (len(time_s) - 1)
    check_uniform(file, COLUMNS[0], lines, time_s, period_s)
    rate_Hz = round(1.0 / period_s)
    if rate_Hz < 1 or abs(rate_Hz * period_s - 1.0) > 1e-4:
        raise UsageError(
            f"{shown(file)}: sampled at {1.0 / period_s:.6g} Hz; expected a whole number of Hz, "
            "resample the recording"
        )
    return rate_Hz


def find_parts(file: Path, drive_V: np.ndarray, rate_Hz: int) -> list[Part]:
    """Where the drive is on, between rests."""
    driven = np.flatnonzero(np.abs(drive_V) > QUIET_PART * np.abs(drive_V).max())
    if driven.size == 0:
        raise UsageError(f"{shown(file)}: column 'drive_V' is 0 throughout; record the drive, too")
    breaks = np.flatnonzero(np.diff(driven) > MIN_REST_s * rate_Hz)
    first = np.concatenate([driven[:1], driven[breaks + 1]])
    end = np.concatenate([driven[breaks] + 1, driven[-1:] + 1])
    following = np.append(first[1:], len(drive_V))
    before = np.append(0, (end[:-1] + first[1:]) // 2)
    return [Part(*map(int, edges)) for edges in zip(before, first, end, following, strict=True)]


def rest_samples(file: Path, parts: list[Part], rate_Hz: int) -> np.ndarray:
    """Indices at rest: all before the first part, or the last quarters of the later rests."""
    count = parts[0].first
    if count >= MIN_REST_s * rate_Hz:
        return np.arange(count)
    later = [np.arange(p.next - (p.next - p.end) // 4, p.next) for p in parts]
    rest = np.concatenate(later)
    if rest.size < MIN_REST_s * rate_Hz:
        raise UsageError(
            f"{shown(file)}: no rest before or after the drive; record at least {MIN_REST_s:g} s "
            "before it begins: noise and offset are taken from there"
        )
    return rest


def sort_parts(recording: SweepRecording, parts: list[Part], lines: list[int]) -> None:
    """Fills sweeps and dwells. Without a sweep nothing can be found."""
    for part in parts:
        dwell = as_dwell(recording, part)
        if dwell is None:
            require_no_current(recording, part, lines)
            recording.sweeps.append(part)
        elif (part.end - part.first) * dwell.freq_Hz < MIN_PERIODS * recording.rate_Hz:
            recording.warnings.append(
                f"line {lines[part.first]}: a dwell of less than {MIN_PERIODS} periods is left out"
            )
        else:
            recording.dwells.append(dwell)
    swept = sum(part.end - part.first for part in recording.sweeps)
    if swept < MIN_SWEEP_s * recording.rate_Hz:
        raise UsageError(
            f"{shown(recording.file)}: no drive sweep of at least {MIN_SWEEP_s:g} s was found; "
            "'quiesce sweep' writes what to record"
        )


def require_no_current(recording: SweepRecording, part: Part, lines: list[int]) -> None:
    on = np.flatnonzero(recording.current_A[part.first : part.end] > 0.0)
    if on.size:
        raise at(
            recording.file, lines[part.first + int(on[0])],
            "current in a drive sweep; a sweep is recorded at 0 A, current steps at one drive "
            "frequency",
        )  # fmt: skip


def as_dwell(recording: SweepRecording, part: Part) -> Dwell | None:
    """The sine that the drive is, if it is one."""
    drive_V = recording.drive_V[part.first : part.end]
    time_s = np.arange(len(drive_V)) / recording.rate_Hz
    freq_Hz, sine, cosine, misfit = fit_sine(time_s, drive_V, recording.rate_Hz)
    if misfit > SINE_PART:
        return None
    return Dwell(
        part,
        freq_Hz,
        float(np.hypot(sine, cosine)),
        float(np.arctan2(cosine, sine) / (2.0 * np.pi)),
    )


def fit_sine(
    time_s: np.ndarray, values: np.ndarray, rate_Hz: int
) -> tuple[float, float, float, float]:
    """Frequency, coefficients of sine and cosine, and the RMS misfit relative to the values."""
    spectrum = np.abs(np.fft.rfft(values * np.hanning(len(values)), 4 * len(values)))
    freq_Hz = float(np.argmax(spectrum)) * rate_Hz / (4 * len(values))
    middle_s = time_s - time_s.mean()
    for _ in range(4):
        turn = 2.0 * np.pi * freq_Hz * middle_s
        sine, cosine = np.sin(turn), np.cos(turn)
        basis = np.column_stack([sine, cosine])
        (a, b), *_ = np.linalg.lstsq(basis, values, rcond=None)
        slope = 2.0 * np.pi * middle_s * (a * cosine - b * sine)
        rest = values - basis @ (a, b)
        freq_Hz += float(slope @ rest / (slope @ slope))
    turn = 2.0 * np.pi * freq_Hz * time_s
    basis = np.column_stack([np.sin(turn), np.cos(turn)])
    (a, b), *_ = np.linalg.lstsq(basis, values, rcond=None)
    misfit = np.linalg.norm(values - basis @ (a, b)) / np.linalg.norm(values)
    return freq_Hz, float(a), float(b), float(misfit)


def longest_run_at_extreme(values: np.ndarray) -> int:
    """Longest run of samples at the largest magnitude."""
    extreme = np.abs(values) >= (1.0 - 1e-9) * np.abs(values).max()
    edges = np.flatnonzero(np.diff(np.concatenate([[0], extreme.astype(int), [0]])))
    return int((edges[1::2] - edges[::2]).max())


def quality_warnings(recording: SweepRecording) -> list[str]:
    """What makes the data poor although they can be used."""
    found = []
    raw = recording.accel_m_s2 + recording.offset_m_s2
    if longest_run_at_extreme(raw) >= 4:
        found.append(
            f"the acceleration stays at {np.abs(raw).max():.4g} m/s2 for several samples: clipped; "
            "reduce the drive or choose a larger range"
        )
    if not recording.dwells:
        found.append("no dwells at a fixed frequency: damper force and lag cannot be found")
    elif not any(has_steps(recording, dwell) for dwell in recording.dwells):
        found.append("no current steps in any dwell: damper force and lag cannot be found")
    for dwell in recording.dwells:
        heard = recording.accel_m_s2[dwell.part.first : dwell.part.end].std()
        if heard < 5.0 * recording.noise_m_s2:
            found.append(
                f"{dwell.freq_Hz:.4g} Hz: RMS {heard:.3g} m/s2 is less than 5 times the noise of "
                f"{recording.noise_m_s2:.3g} m/s2; drive harder there"
            )
        if recording.rate_Hz < 20.0 * dwell.freq_Hz:
            found.append(
                f"{dwell.freq_Hz:.4g} Hz: fewer than 20 samples a period; harmonics and lag suffer"
            )
    found += short_rests(recording)
    return found


def has_steps(recording: SweepRecording, dwell: Dwell) -> bool:
    return bool(np.ptp(recording.current_A[dwell.part.first : dwell.part.end]) > 0.0)


def short_rests(recording: SweepRecording) -> list[str]:
    """Rests in which the structure has not come to rest."""
    found = []
    for part in [*recording.sweeps, *(dwell.part for dwell in recording.dwells)]:
        tail = recording.accel_m_s2[part.next - (part.next - part.end) // 4 : part.next]
        if tail.size > 10 and tail.std() > 1.5 * recording.noise_m_s2:
            found.append(
                f"at {part.next / recording.rate_Hz:.1f} s the structure was not at rest "
                f"(RMS {tail.std():.3g} m/s2); rest longer between the parts"
            )
    return found
