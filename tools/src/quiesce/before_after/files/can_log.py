"""Logs of the controller's CAN bus: its samples, its configuration."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.base.progress import say
from quiesce.before_after.files.source import Origin, Source
from quiesce.before_after.motion import ACCELERATION, Scale
from quiesce.can.columns import raw_column
from quiesce.can.configuration import Configuration
from quiesce.can.database import Database, load
from quiesce.can.e2e import JUMPED, OK
from quiesce.can.readers import read_log
from quiesce.can.traffic import Traffic, summary_line

RAW = "RawSample"
NODE = "SensorSample"  # the kind of messages of sensor nodes
ACCEL = "accel"  # the channel of RawSample
# What signals that mean the same in RawSample and of a node are called here.
NAMES = {"accel_counts": "counts", "sample_counts": "counts", "accel_is_fresh": "is_fresh"}
TICKS = 1 << 16  # of tick_low
SCALE, RATE = "accel_scale_nm_s2", "tick_rate_Hz"


class NoSamples(UsageError):
    """A log, but not of a controller's samples."""


class CanLog(Source):
    """Channels: `accel`, the controller's own samples (RawSample), in m/s2 where the log has the
    parameter that scales them; the messages of sensor nodes by their names, in counts. UsageError,
    as readers have it, for a log that is malformed."""

    def __init__(self, file: Path) -> None:
        self.file = file
        database = load()
        frames, configuration, traffic = _read(file, database)
        self._rate_Hz = configuration.parameters.get(RATE)
        self._samples = {
            ACCEL if name == RAW else name: _columns(database, name, *found)
            for name, found in frames.items()
        }
        scale = configuration.parameters.get(SCALE)
        known = Scale(ACCELERATION, 1e-9 * scale, f"{scale} nm/s2 a count") if scale else None
        self.scales = {name: known if name == ACCEL else None for name in self._samples}
        if not self._samples:
            raise NoSamples(
                f"{shown(file)}: no samples in it, neither RawSample nor those of sensor nodes; "
                "record with 'quiesce can record --raw'"
            )
        facts = {"frames": summary_line(traffic.summary()), **configuration.facts()}
        self.origin = Origin(
            "log of the controller's bus",
            facts,
            configuration.parameters,
            self._doubts(known is not None),
        )

    def _doubts(self, is_scaled: bool) -> tuple[str, ...]:
        doubts = []
        if is_scaled:
            doubts.append(
                f"accel is scaled by parameter {SCALE}; of a controller with a board file that "
                "board's scale holds: --channel accel:FACTOR*m/s2"
            )
        saturated = {name: int(one["is_saturated"].sum()) for name, one in self._samples.items()}
        doubts += [
            f"clipped: {count} samples of {name} at the sensor's full scale"
            for name, count in saturated.items()
            if count
        ]
        return tuple(doubts)

    def samples(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        found = self._samples[name]
        if name != ACCEL:
            good = found["is_bad"] == 0
            return found["time_s"][good], found["counts"][good]
        fresh = found["is_fresh"] != 0
        ticks = _unwrapped(found["tick_low"], found["time_s"])
        return ticks[fresh] / self._tick_rate_Hz(ticks), found["counts"][fresh]

    def _tick_rate_Hz(self, ticks: np.ndarray) -> float:
        """As the log says it, else by the clock of who recorded it."""
        if self._rate_Hz:
            return float(self._rate_Hz)
        time_s = self._samples[ACCEL]["time_s"]
        return float((ticks[-1] - ticks[0]) / max(time_s[-1] - time_s[0], 1e-9))


Frames = dict[str, tuple[list[float], list[bytes]]]


def _read(file: Path, database: Database) -> tuple[Frames, Configuration, Traffic]:
    """Times and data of the frames with samples that can be trusted, and what else they say."""
    say(f"reading {shown(file)}")
    wanted = {one.frame_id: one.name for one in database.messages if one.kind in (RAW, NODE)}
    frames: Frames = {}
    configuration, traffic = Configuration(database), Traffic(database)
    for frame in _can_frames(read_log(file)):
        is_good = traffic.take(frame) in (OK, JUMPED)
        configuration.take(frame)
        name = wanted.get(frame.arbitration_id)
        if name is not None and is_good:
            times, data = frames.setdefault(name, ([], []))
            times.append(frame.timestamp)
            data.append(bytes(frame.data))
    return frames, configuration, traffic


def _can_frames(frames: Iterable[Any]) -> Iterable[Any]:
    return (one for one in frames if not (one.is_extended_id or one.is_error_frame))


def _columns(
    database: Database, name: str, times: list[float], data: list[bytes]
) -> dict[str, np.ndarray]:
    """Times and raw values of the message's signals, all frames at once."""
    words = np.frombuffer(b"".join(one.ljust(8, b"\0") for one in data), "<u8")
    columns = {"time_s": np.array(times), "is_saturated": np.zeros(len(times))}
    for signal in database.codec.get_message_by_name(name).signals:
        raw = raw_column(words, signal.start, signal.length, signal.is_signed)
        columns[NAMES.get(signal.name, signal.name)] = raw.astype(float)
    return columns


def _unwrapped(tick_low: np.ndarray, time_s: np.ndarray) -> np.ndarray:
    """Ticks since the first one: their low half goes round, and the clock of who recorded tells how
    often where frames are missing for long."""
    steps = np.diff(tick_low) % TICKS
    ticks = np.concatenate([[0.0], np.cumsum(steps)])
    if len(ticks) < 3 or ticks[-1] == 0.0:
        return ticks
    period_s = float(np.median(np.diff(time_s)) / max(np.median(steps), 1.0))
    if period_s > 0.0:
        turns = np.rint((np.diff(time_s) / period_s - steps) / TICKS)
        steps = steps + TICKS * np.maximum(turns, 0.0)
    return np.concatenate([[0.0], np.cumsum(steps)])
