"""CAN frames in MDF4 files (ASAM MDF 4.10, bus logging), all at once.

python-can's writer hands asammdf frame by frame, too slow for a busy bus, and keeps everything in
a temporary file until the end; we write a whole recording in one go. DBC and parameters go along
as attachments.
"""

import heapq
import itertools
from collections.abc import Iterable, Iterator, Sequence
from datetime import UTC, datetime
from hashlib import md5
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from quiesce.base.extras import extra
from quiesce.can.python_can import can
from quiesce.recording.formats.mdf_channels import FILES, FRAME, open_mdf, quiet, silent

MAX_BYTES = 64  # of CAN FD, which readers expect
CHUNK = 50_000  # frames at once: about 100 MB


def require_mdf() -> None:
    """UsageError where asammdf is not there: before a recording, not after it. Imports nothing: a
    recording begins at once."""
    with extra(*FILES):
        if find_spec("asammdf") is None:
            raise ModuleNotFoundError("no asammdf", name="asammdf")


def dtype_of(prefix: str) -> Any:
    import numpy as np

    fields = [("BusChannel", "<u1"), ("ID", "<u4"), ("IDE", "<u1"), ("DLC", "<u1")]
    fields += [("DataLength", "<u1"), ("DataBytes", f"({MAX_BYTES},)u1"), ("Dir", "<u1")]
    fields += [("EDL", "<u1"), ("BRS", "<u1"), ("ESI", "<u1")]
    return np.dtype([(f"{prefix}.{name}", kind) for name, kind in fields])


def write_mdf(
    file: Path,
    messages: Iterable[Any],
    attachments: Sequence[tuple[str, bytes, str]],
    comment: str,
) -> int:
    """attachments: file name, content, MIME type; the first is the database of the frames.

    Frames without data (remote, error) are left out: tools expect other groups for them, and the
    interface has none. Returns how many.
    """
    with extra(*FILES):
        from asammdf import MDF, Signal
        from asammdf.blocks.v4_blocks import SourceInformation
        from asammdf.blocks.v4_constants import BUS_TYPE_CAN, SOURCE_BUS

    quiet()
    left_out = 0

    def data_frames() -> Iterator[Any]:
        nonlocal left_out
        for one in messages:
            if one.is_remote_frame or one.is_error_frame:
                left_out += 1
            else:
                yield one

    chunks = chunks_of(data_frames())
    first = next(chunks, [])
    with MDF(version="4.10") as mdf:
        start_s = first[0].timestamp if first else datetime.now(UTC).timestamp()
        mdf.header.start_time = datetime.fromtimestamp(start_s, UTC)
        mdf.header.comment = comment
        # The header keeps microseconds: times are relative to what it kept.
        start_s = mdf.header.start_time.timestamp()
        name, content, _ = attachments[0]
        mdf.append(
            Signal(
                name=FRAME,
                samples=samples_of(first),
                timestamps=times_of(first, start_s),
                attachment=(content, name, md5(content, usedforsecurity=False).digest()),
                source=SourceInformation(source_type=SOURCE_BUS, bus_type=BUS_TYPE_CAN),
            )
        )
        for chunk in chunks:
            mdf.extend(0, [(times_of(chunk, start_s), None), (samples_of(chunk), None)])
        for name, content, mime in attachments[1:]:
            mdf.attach(content, file_name=name, mime=mime)
        mdf.save(file, compression=2, overwrite=True)
    return left_out


def chunks_of(messages: Iterable[Any]) -> Iterator[list[Any]]:
    messages = iter(messages)
    while chunk := list(itertools.islice(messages, CHUNK)):
        yield chunk


def times_of(frames: Sequence[Any], start_s: float) -> Any:
    import numpy as np

    return np.array([one.timestamp - start_s for one in frames], dtype="<f8")


def samples_of(frames: Sequence[Any]) -> Any:
    import numpy as np

    samples = np.zeros(len(frames), dtype_of(FRAME))
    for name, values in (
        ("ID", [one.arbitration_id for one in frames]),
        ("IDE", [one.is_extended_id for one in frames]),
        ("DLC", [can.util.len2dlc(one.dlc) for one in frames]),
        ("DataLength", [len(one.data) for one in frames]),
        ("Dir", [not one.is_rx for one in frames]),
        ("EDL", [one.is_fd for one in frames]),
        ("BRS", [one.bitrate_switch for one in frames]),
        ("ESI", [one.error_state_indicator for one in frames]),
    ):
        samples[f"{FRAME}.{name}"] = values
    rows = b"".join(bytes(one.data).ljust(MAX_BYTES, b"\0") for one in frames)
    samples[f"{FRAME}.DataBytes"] = np.frombuffer(rows, np.uint8).reshape(-1, MAX_BYTES)
    return samples


def read_mdf(file: Path) -> Iterator[Any]:
    """Frames of every CAN bus in the file, by time. Exceptions as asammdf has them."""
    with open_mdf(file) as mdf:
        groups = [
            group_frames(mdf, index, group.channel_group.cycles_nr)
            for index, group in enumerate(mdf.groups)
            if any(channel.name == FRAME for channel in group.channels)
        ]
        if not groups:
            raise ValueError("it has no group of CAN frames")
        yield from heapq.merge(*groups, key=lambda one: one.timestamp)


def group_frames(mdf: Any, group: int, count: int) -> Iterator[Any]:
    start_s = mdf.header.start_time.timestamp()
    for offset in range(0, count, CHUNK):
        with silent():
            part = mdf.get(FRAME, group=group, raw=True, record_offset=offset, record_count=CHUNK)
        yield from frames_of(part, start_s)


def frames_of(signal: Any, start_s: float) -> list[Any]:
    rows = signal.samples
    names = rows.dtype.names or ()

    def column(name: str, default: int) -> list[int]:
        key = f"{FRAME}.{name}"
        return rows[key].tolist() if key in names else [default] * len(rows)

    data = rows[f"{FRAME}.DataBytes"]
    lengths = column("DataLength", MAX_BYTES)
    return [
        can.Message(
            timestamp=start_s + float(time_s),
            arbitration_id=int(frame_id) & 0x1FFFFFFF,
            is_extended_id=bool(is_extended),
            is_rx=direction in (0, b"Rx"),
            is_fd=bool(is_fd),
            bitrate_switch=bool(is_fd and is_fast),
            error_state_indicator=bool(is_fd and is_passive),
            data=bytes(data[i][: lengths[i]]),
        )
        for i, (time_s, frame_id, is_extended, direction, is_fd, is_fast, is_passive) in enumerate(
            zip(
                signal.timestamps,
                column("ID", 0),
                column("IDE", 0),
                column("Dir", 0),
                column("EDL", 0),
                column("BRS", 0),
                column("ESI", 0),
                strict=True,
            )
        )
    ]
