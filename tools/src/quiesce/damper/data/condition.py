"""Raw tests to uniform records: what is filtered, differentiated, shifted, and in which words the
report says so. The force is never filtered."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.data.check import (
    MIN_ROWS,
    check_energy,
    check_ranges,
    check_rate,
    check_velocity,
    motion_agreement,
)
from quiesce.damper.data.motion import derivatives, integrated, low_passed
from quiesce.damper.data.read import RawTest
from quiesce.damper.data.record import Record
from quiesce.signal.recording import MAX_JITTER

LOW_PASS_Hz = 40.0
# The default is lowered to this part of the sampling rate where that is low.
_LOW_PASS_OF_RATE = 0.4
_LOW_PASS_MOST_OF_RATE = 0.48
DRIFT_Hz = 0.2
MAX_ROWS = 20_000
# No automatic decimation below this many samples a period of the low-pass.
_ROWS_A_PERIOD = 10.0


@dataclass(frozen=True)
class Settings:
    """None: chosen for each test, and said."""

    low_pass_Hz: float | None = None
    drift_Hz: float | None = None  # corner of the high-pass where velocity is integrated
    work_rate_Hz: float | None = None
    keep_offset: bool = False
    use_velocity: bool = False
    accept_values: bool = False
    flipped: bool = False


@dataclass(frozen=True)
class Motion:
    disp_m: np.ndarray
    velocity_m_s: np.ndarray
    accel_m_s2: np.ndarray


def condition(raw: RawTest, settings: Settings, notes: list[str]) -> Record:
    """One record; `notes` gets what was done in plain sentences. UsageError where units or sign
    are wrong or a setting does not fit the test."""
    check_rate(raw.where, 1.0 / raw.period_s, settings.accept_values)
    raw, rate_Hz = evened(raw, settings, notes)
    corner_Hz = low_pass_corner(raw, rate_Hz, settings, notes)
    motion = motion_of(raw, rate_Hz, corner_Hz, settings, notes)
    step = decimation(raw, rate_Hz, corner_Hz, settings, notes)
    picked = slice(None, None, step)
    command, command_unit = command_of(raw)
    temperature_C = raw.si.get("temperature")
    record = Record(
        name=raw.name,
        rate_Hz=rate_Hz / step,
        time_s=raw.time_s[0] + np.arange(len(raw.time_s))[picked] / rate_Hz,
        disp_m=motion.disp_m[picked].copy(),
        velocity_m_s=motion.velocity_m_s[picked].copy(),
        accel_m_s2=motion.accel_m_s2[picked].copy(),
        force_N=raw.si["force"][picked].copy(),
        command=command[picked].copy(),
        command_unit=command_unit,
        temperature_C=None if temperature_C is None else temperature_C[picked].copy(),
        average_samples=odd_samples(raw.average_s * rate_Hz / step, notes),
        file_rows=step / (rate_Hz * raw.period_s),
    )
    judge(raw.where, record, settings, notes)
    notes.append("force as in the file, not filtered")
    return record


def judge(where: str, record: Record, settings: Settings, notes: list[str]) -> None:
    if not settings.accept_values:
        check_ranges(where, record)
    note = check_energy(where, record, settings.flipped)
    notes += [note] if note else []


def command_of(raw: RawTest) -> tuple[np.ndarray, str]:
    if "command" in raw.si:
        return raw.si["command"], "V"
    return raw.si.get("current", np.zeros(len(raw.time_s))), "A"


# Rate


def evened(raw: RawTest, settings: Settings, notes: list[str]) -> tuple[RawTest, float]:
    """The test on an even grid, and its rate."""
    if raw.jitter <= MAX_JITTER:
        if raw.jitter > 1e-3:
            notes.append(
                f"time stamps up to {MAX_JITTER:g} periods off an even grid are taken as even"
            )
        return raw, 1.0 / raw.period_s
    rate_Hz = settings.work_rate_Hz
    if rate_Hz is None or rate_Hz * raw.period_s > 2.0:
        raise UsageError(
            f"{raw.where}: uneven sampling, {1.0 / raw.period_s:.4g} Hz on average; --work-rate-hz "
            "has to state a rate of at most twice that"
        )
    count = int((raw.time_s[-1] - raw.time_s[0]) * rate_Hz * (1.0 + 1e-12)) + 1
    check_count(raw, count, rate_Hz)
    even_s = raw.time_s[0] + np.arange(count) / rate_Hz
    si = {role: on_grid(role, raw.time_s, values, even_s) for role, values in raw.si.items()}
    notes.append(
        f"uneven time stamps: interpolated onto {rate_Hz:g} Hz, motion by cubic splines, the rest "
        "by straight lines, the command held"
    )
    even = RawTest(raw.name, raw.where, raw.period_s, 0.0, even_s, si, raw.average_s)
    return even, rate_Hz


def check_count(raw: RawTest, rows: int, rate_Hz: float) -> None:
    if rows < MIN_ROWS:
        raise UsageError(
            f"{raw.where}: {rows} rows only at --work-rate-hz {rate_Hz:g}; at least {MIN_ROWS} are "
            "needed: raise it"
        )


def on_grid(role: str, time_s: np.ndarray, values: np.ndarray, even_s: np.ndarray) -> np.ndarray:
    from scipy.interpolate import CubicSpline

    if role in ("displacement", "velocity", "acceleration"):
        return CubicSpline(time_s, values)(even_s)
    if role in ("current", "command"):
        return values[np.searchsorted(time_s, even_s, side="right") - 1]
    return np.interp(even_s, time_s, values)


def decimation(
    raw: RawTest, rate_Hz: float, corner_Hz: float, settings: Settings, notes: list[str]
) -> int:
    """Every how many-th row is kept."""
    rows = len(raw.time_s)
    if settings.work_rate_Hz is None:
        most = max(1, int(rate_Hz / (_ROWS_A_PERIOD * corner_Hz)))
        step = min(most, -(-rows // MAX_ROWS))
    else:
        step = max(1, round(rate_Hz / settings.work_rate_Hz))
        if settings.work_rate_Hz > 1.05 * rate_Hz:
            raise UsageError(
                f"{raw.where}: --work-rate-hz {settings.work_rate_Hz:g} is above the "
                f"{rate_Hz:.6g} Hz of the file; name a lower one"
            )
        if rate_Hz / step < 2.5 * corner_Hz:
            raise UsageError(
                f"{raw.where}: --work-rate-hz {settings.work_rate_Hz:g} is too low for a motion up "
                f"to {corner_Hz:g} Hz; at least {2.5 * corner_Hz:g}, or lower --low-pass-hz"
            )
    if step > 1:
        check_count(raw, rows // step, rate_Hz / step)
        notes.append(
            f"one row in {step} kept, {rate_Hz / step:.6g} Hz (the motion is smooth there, the "
            "force is picked, not averaged)"
        )
    return step


def odd_samples(length: float, notes: list[str]) -> int:
    """The odd number of samples nearest to a moving average's length."""
    if length <= 0.0:
        return 1
    samples = 2 * round((length - 1.0) / 2.0) + 1
    samples = max(samples, 1)
    if samples > 1:
        notes.append(
            "the model's force goes through the moving average that the file's went through, "
            "centred, to the nearest odd number of samples"
        )
    return samples


# Motion


def low_pass_corner(raw: RawTest, rate_Hz: float, settings: Settings, notes: list[str]) -> float:
    corner_Hz = settings.low_pass_Hz
    if corner_Hz is None:
        corner_Hz = min(LOW_PASS_Hz, _LOW_PASS_OF_RATE * rate_Hz)
        if corner_Hz < LOW_PASS_Hz:
            notes.append(f"the low-pass is at {corner_Hz:.4g} Hz: sampled at {rate_Hz:.4g} Hz only")
    elif corner_Hz > _LOW_PASS_MOST_OF_RATE * rate_Hz:
        raise UsageError(
            f"{raw.where}: --low-pass-hz {corner_Hz:g} is too high for sampling at "
            f"{rate_Hz:.6g} Hz; at most {_LOW_PASS_MOST_OF_RATE * rate_Hz:.4g}"
        )
    elif corner_Hz < 2.0 * rate_Hz / len(raw.time_s):
        raise UsageError(
            f"{raw.where}: --low-pass-hz {corner_Hz:g} leaves no motion in a test of "
            f"{len(raw.time_s) / rate_Hz:.3g} s; raise it"
        )
    return corner_Hz


def motion_of(
    raw: RawTest, rate_Hz: float, corner_Hz: float, settings: Settings, notes: list[str]
) -> Motion:
    if "displacement" not in raw.si:
        return motion_from_velocity(raw, rate_Hz, corner_Hz, settings, notes)
    disp_m = raw.si["displacement"]
    if not settings.keep_offset:
        disp_m = disp_m - disp_m.mean()
        notes.append("the mean displacement of each test is removed")
    disp_m = low_passed(disp_m, rate_Hz, corner_Hz)
    velocity_m_s, accel_m_s2 = derivatives(disp_m, rate_Hz)
    notes.append(
        f"displacement low-passed at {corner_Hz:.4g} Hz, 4th order Butterworth run both ways, ends "
        "free; velocity and acceleration by a spline of 5th order through it"
    )
    motion = Motion(disp_m, velocity_m_s, accel_m_s2)
    return with_measured_velocity(raw, motion, rate_Hz, corner_Hz, settings, notes)


def with_measured_velocity(
    raw: RawTest, motion: Motion, rate_Hz: float, corner_Hz: float, settings: Settings,
    notes: list[str],
) -> Motion:  # fmt: skip
    if "velocity" not in raw.si:
        if settings.use_velocity:
            raise UsageError(
                f"{raw.where}: --use-velocity needs a velocity; name its column with --velocity"
            )
        return motion
    velocity_m_s = raw.si["velocity"]
    gain, correlation = motion_agreement(velocity_m_s, motion.velocity_m_s)
    if not settings.accept_values:
        check_velocity(raw.where, gain, correlation, settings.use_velocity)
    notes.append(
        f"measured velocity against dx/dt: gain {gain:.2f}, correlation {correlation:.2f}; "
        f"{'used' if settings.use_velocity else 'not used (--use-velocity)'}"
    )
    if not settings.use_velocity:
        return motion
    smooth_m_s = low_passed(velocity_m_s, rate_Hz, corner_Hz)
    notes.append(f"velocity as measured; acceleration from it, low-passed at {corner_Hz:.4g} Hz")
    return Motion(motion.disp_m, velocity_m_s, derivatives(smooth_m_s, rate_Hz)[0])


def motion_from_velocity(
    raw: RawTest, rate_Hz: float, corner_Hz: float, settings: Settings, notes: list[str]
) -> Motion:
    """Velocity as measured, its mean taken out; displacement by integration."""
    velocity_m_s = raw.si["velocity"]
    if not settings.keep_offset:
        velocity_m_s = velocity_m_s - velocity_m_s.mean()
        notes.append("the mean velocity of each test is removed")
    duration_s = len(velocity_m_s) / rate_Hz
    drift_Hz = settings.drift_Hz or max(DRIFT_Hz, 1.0 / duration_s)
    if not 0.99 / duration_s <= drift_Hz < 0.1 * rate_Hz:
        raise UsageError(
            f"{raw.where}: --drift-hz {drift_Hz:g} has to lie above one over the test's duration, "
            f"{1.0 / duration_s:.3g} Hz, and well below the motion ({DRIFT_Hz:g} unless stated)"
        )
    notes.append(
        "velocity as measured; displacement by integrating it, drift taken out by a high-pass at "
        f"{drift_Hz:.4g} Hz (2nd order, both ways); acceleration by a spline of 5th order through "
        f"the velocity, low-passed at {corner_Hz:.4g} Hz"
    )
    accel_m_s2 = derivatives(low_passed(velocity_m_s, rate_Hz, corner_Hz), rate_Hz)[0]
    return Motion(integrated(velocity_m_s, rate_Hz, drift_Hz), velocity_m_s, accel_m_s2)


# Many tests


def condition_all(tests: Iterable[RawTest], settings: Settings) -> tuple[list[Record], list[str]]:
    """Records in the order given; sentences that do not hold for all say for how many."""
    records: list[Record] = []
    counts: dict[str, int] = {}
    for raw in tests:
        notes: list[str] = []
        records.append(condition(raw, settings, notes))
        for note in dict.fromkeys(notes):
            counts[note] = counts.get(note, 0) + 1
    check_units(records)
    total = len(records)
    return records, [
        note if count == total else f"{note} ({count} of {total} tests)"
        for note, count in counts.items()
    ]


def check_units(records: list[Record]) -> None:
    """Currents and voltages do not mix in one fit."""
    if len({record.command_unit for record in records}) > 1:
        raise UsageError(
            "some files have a current, others a voltage as command; fit them one at a time, or "
            "name the columns with --current or --command"
        )
