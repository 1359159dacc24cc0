"""asammdf, wrapped: its files opened without its noise, and the measured channels in them."""

import contextlib
import io
import logging
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.extras import extra
from quiesce.base.paths import shown

FILES = ("mdf", "an MDF4 file")
FRAME = "CAN_DataFrame"  # the channel of groups with frames of CAN buses


def open_mdf(file: Path) -> Any:
    """An asammdf.MDF, to be closed. Exceptions as asammdf has them."""
    with extra(*FILES):
        from asammdf import MDF

    quiet()
    with silent():
        return MDF(file)


@contextmanager
def opened(file: Path) -> Iterator[Any]:
    """UsageError for whatever asammdf, which has no class of its own for it, stumbles over."""
    try:
        with open_mdf(file) as mdf:
            yield mdf
    except (UsageError, OSError):
        raise
    except Exception as error:
        reason = one_line(error)[:120] or type(error).__name__
        raise UsageError(f"{shown(file)}: not an MDF file, or cut off ({reason}); export it again")


def has_frames(group: Any) -> bool:
    return any(channel.name == FRAME for channel in group.channels)


def channels(mdf: Any) -> Iterator[tuple[str, tuple[int, int], str]]:
    """Name, group and index, unit; channels of time and frames are none. A name that comes again
    has its group's number."""
    seen: set[str] = set()
    for number, group in enumerate(mdf.groups):
        if has_frames(group):
            continue
        for index, channel in enumerate(group.channels):
            if index == mdf.masters_db.get(number):
                continue
            name = channel.name if channel.name not in seen else f"{channel.name} ({number})"
            seen.add(name)
            unit = getattr(channel.conversion, "unit", "") or channel.unit or ""
            yield name, (number, index), unit


def samples_of(mdf: Any, place: tuple[int, int]) -> tuple[Any, Any] | None:
    """Arrays of seconds and values of a channel; None where they are no plain numbers."""
    with silent():
        signal = mdf.get(group=place[0], index=place[1]).validate()
    values = signal.samples
    if values.ndim != 1 or values.dtype.kind not in "fiu":
        return None
    return signal.timestamps.astype(float), values.astype(float)


def silent() -> AbstractContextManager[Any]:
    """asammdf prints traces of what it stumbles over and goes on."""
    return contextlib.redirect_stdout(io.StringIO())


@cache
def quiet() -> None:
    """asammdf logs what it stumbles over, and where its constructor fails its destructor prints a
    stack trace; the one line that we print says it."""
    with extra(*FILES):
        from asammdf.blocks.mdf_v4 import MDF4

    logging.getLogger("asammdf").setLevel(logging.CRITICAL + 1)
    end = MDF4.__del__

    def end_quietly(self: Any) -> None:
        with contextlib.suppress(Exception):  # of whatever is half there
            end(self)

    MDF4.__del__ = end_quietly
