"""What goes over the websocket: docs/reference/live-protocol.md.

Samples are binary, little-endian; all else is a JSON object in a text message.
"""

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from quiesce.live import spectrum
from quiesce.live.record_plan import KEYS, RecordPlan, marker_of, record_plan_of
from quiesce.live.spectrum import SpectrumPlan, spectrum_plan_of
from quiesce.live.tables import KEYS as TABLE_KEYS
from quiesce.live.tables import TablePart, table_part_of

VERSION = 1
SAMPLES = 1
MOST_SERIES = 8
MAX_MESSAGE_BYTES = 4096  # of what a viewer sends
MOST_SETTINGS = 64
# What a viewer may ask for, and what he says with it.
KEYS_OF: dict[str, set[str]] = {
    **dict.fromkeys(("stop", "take", "release"), set()),
    "show": {"series"},
    "spectrum": spectrum.KEYS,
    "set": {"settings"},
    **dict.fromkeys(("save", "revert"), set()),
    "table": TABLE_KEYS,
    "law": set(),
    "rig": {"order"},
    "guide": {"order"},
    "record": KEYS,
    "end_record": set(),
    "mark": {"text"},
}
MOST_MALFORMED = 20  # then the viewer is sent away
# Kind, version, blocks; number of the message; time of sending; arrival of the newest frame.
HEAD = struct.Struct("<BBHIdd")
# CAN id, series; samples; number of the first; its time.
BLOCK = struct.Struct("<HHIId")


class Malformed(Exception):
    """A viewer's message that is none; the text says why."""


@dataclass(frozen=True)
class Block:
    """Samples of one message, and of it the series that are drawn."""

    frame_id: int
    first: int
    times_s: np.ndarray
    columns: Sequence[tuple[int, np.ndarray]]  # number of the series, float32


@dataclass(frozen=True)
class Command:
    """What a viewer asks for; `series` of show, `spectrum` of spectrum, `settings` of set, `order`
    of rig and guide, `plan` of record, `text` of mark, `table` of table."""

    do: str
    series: tuple[int, ...] = ()
    settings: tuple[str, ...] = ()  # NAME=VALUE
    order: dict[str, Any] = field(default_factory=dict)
    plan: RecordPlan | None = None
    text: str = ""
    spectrum: SpectrumPlan | None = None
    table: TablePart | None = None


def pack_samples(number: int, sent_s: float, newest_s: float, blocks: Sequence[Block]) -> bytes:
    """newest_s: NaN where no frame has come yet."""
    parts = [HEAD.pack(SAMPLES, VERSION, len(blocks), number % 2**32, sent_s, newest_s)]
    for block in blocks:
        start_s = float(block.times_s[0])
        offsets_us = np.rint((block.times_s - start_s) * 1e6).astype("<i4")
        head = (block.frame_id, len(block.columns), len(offsets_us), block.first % 2**32)
        parts.append(BLOCK.pack(*head, start_s))
        parts.append(np.array([one for one, _ in block.columns], "<u4").tobytes())
        parts.append(offsets_us.tobytes())
        parts += [values.astype("<f4").tobytes() for _, values in block.columns]
    return b"".join(parts)


def command_of(text: str | None, series_count: int) -> Command:
    """Malformed where it is none. text: None where the message was binary."""
    said = object_of(text)
    do = said.get("do")
    if not isinstance(do, str) or do not in KEYS_OF:
        raise Malformed(f"'do' is none of {', '.join(KEYS_OF)}")
    if set(said) != {"do"} | KEYS_OF[do]:
        raise Malformed(f"'{do}' has other keys than it may have")
    if do == "show":
        return Command(do, series=shown_of(said["series"], series_count))
    if do == "set":
        return Command(do, settings=settings_of(said["settings"]))
    if do in ("rig", "guide"):
        return Command(do, order=order_of(said["order"]))
    try:
        if do == "spectrum":
            return Command(do, spectrum=spectrum_plan_of(said, series_count))
        if do == "record":
            return Command(do, plan=record_plan_of(said, series_count))
        if do == "table":
            return Command(do, table=table_part_of(said))
        if do == "mark":
            return Command(do, text=marker_of(said["text"]))
    except ValueError as error:
        raise Malformed(str(error))
    return Command(do)


def object_of(text: str | None) -> dict[str, Any]:
    if text is None:
        raise Malformed("binary; commands are text")
    try:
        said = json.loads(text)
    except (ValueError, RecursionError):
        raise Malformed("not JSON")
    if not isinstance(said, dict):
        raise Malformed("not a JSON object")
    return said


def shown_of(value: Any, series_count: int) -> tuple[int, ...]:
    is_list = isinstance(value, list) and len(value) <= MOST_SERIES
    if not is_list or not all(type(one) is int and 0 <= one < series_count for one in value):
        raise Malformed(f"'series' is a list of at most {MOST_SERIES} numbers of series")
    return tuple(dict.fromkeys(value))


def settings_of(value: Any) -> tuple[str, ...]:
    is_small = isinstance(value, dict) and 0 < len(value) <= MOST_SETTINGS
    if not is_small or not all(isinstance(one, str) for one in value.values()):
        raise Malformed("'settings' is an object of values as text by name")
    return tuple(f"{name}={text}" for name, text in value.items())


def order_of(value: Any) -> dict[str, Any]:
    """What of it is allowed is for whoever is ordered to say."""
    if not isinstance(value, dict):
        raise Malformed("'order' is an object")
    return value
