"""Recordings for the tests of `quiesce report`."""

import json
from collections.abc import Mapping
from pathlib import Path

import can
import numpy as np
from quiesce.can.buses import Bus
from quiesce.can.database import load
from quiesce.can.e2e import protect
from quiesce.can.link import Link
from quiesce.can.parameters import hash_of, parameters
from quiesce.can.recorder import Plan, Recorder, open_first

DATABASE = load()
START_S = 1_700_000_000.25
RATE_Hz = 200.0


def noise(seed: int, size: float = 1.0, duration_s: float = 40.0) -> np.ndarray:
    return size * np.random.default_rng(seed).standard_normal(round(duration_s * RATE_Hz))


def write_csv(
    file: Path, columns: Mapping[str, np.ndarray], time: str = "t_s", rate_Hz: float = RATE_Hz
) -> Path:
    count = len(next(iter(columns.values())))
    rows = zip(np.arange(count) / rate_Hz, *columns.values(), strict=True)
    lines = [",".join([time, *columns]), *(",".join(f"{x:.9g}" for x in row) for row in rows)]
    file.write_text("\n".join(lines) + "\n")
    return file


def write_mdf(file: Path, channels: Mapping[str, tuple[str, np.ndarray]], rate_Hz: float) -> Path:
    """channels: unit and values; each in a group of its own, as devices with own clocks have."""
    from asammdf import MDF, Signal

    with MDF(version="4.10") as mdf:
        for name, (unit, values) in channels.items():
            time_s = np.arange(len(values)) / rate_Hz
            mdf.append(Signal(samples=values, timestamps=time_s, name=name, unit=unit))
        mdf.save(file, overwrite=True)
    return file


def protected(name: str, alive: int, **signals: int) -> bytes:
    layout = DATABASE.by_name[name].protection
    assert layout is not None
    return protect(layout, alive % 16, DATABASE.encode(name, **signals))


def frame(name: str, time_s: float, data: bytes) -> can.Message:
    return can.Message(
        timestamp=START_S + time_s,
        arbitration_id=DATABASE.by_name[name].frame_id,
        is_extended_id=False,
        data=data,
    )


def configuration_frames(settings: Mapping[str, int]) -> list[can.Message]:
    """Identification and an answer for every parameter, as a recording begins."""
    values = [settings.get(one["name"], one["default"]) for one in parameters()]
    identity = DATABASE.encode(
        "Identification", version_minor=2, interface_version=DATABASE.version,
        param_hash=hash_of(values),
    )  # fmt: skip
    read = DATABASE.number("ServiceReply", "operation", "READ")
    answers = [
        protected("ServiceReply", i, operation=read, param_index=i, param_value=value)
        for i, value in enumerate(values)
    ]
    return [
        frame("Identification", 0.0, identity),
        *(frame("ServiceReply", 0.0, data) for data in answers),
    ]


def sample_frames(counts: np.ndarray, rate_Hz: int = 1000) -> list[can.Message]:
    """What a controller streams of its samples; its ticks go round once."""
    first = 2**16 - len(counts) // 2
    return [
        frame(
            "RawSample",
            tick / rate_Hz,
            DATABASE.encode(
                "RawSample", tick_low=(first + tick) % 2**16, accel_counts=int(count),
                accel_is_fresh=1,
            ),
        )
        for tick, count in enumerate(counts)
    ]  # fmt: skip


def record(file: Path, frames: list[can.Message]) -> Path:
    """Through the recorder that `quiesce can record` runs."""
    link = Link(Bus("virtual", "nothing", None, ()))
    recorder = Recorder(link, DATABASE, Plan(file, None, None, asks=False), lambda _: None)
    open_first(recorder)
    for one in frames:
        recorder.take(one)
    recorder.close()
    assert recorder.file.result == file, recorder.file.failure
    return file


def figures(text: str, channel: str = "") -> dict[str, dict]:
    """Of a report's JSON, by quantity, of the channel or the only one."""
    channels = json.loads(text)["channels"]
    found = [one for one in channels if channel in ("", one["name"])]
    assert len(found) == 1
    return {one["quantity"]: one for one in found[0]["figures"]}
