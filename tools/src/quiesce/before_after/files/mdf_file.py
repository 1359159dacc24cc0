"""Measured channels of an MDF file, as data loggers write them."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown
from quiesce.before_after.files.source import Origin, Source
from quiesce.before_after.motion import scale_in_name, scale_of
from quiesce.can.mdf import FRAME, open_mdf, silent

DECODED = "from CAN"  # how asammdf calls groups that it makes of frames


class MdfFile(Source):
    """Frames that a database in the file decodes are channels, too. UsageError where it is no MDF
    file or cut off."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self._places: dict[str, tuple[int, int]] = {}
        self.scales = {}
        with _opened(file) as mdf:
            for name, place, unit in _channels(mdf):
                self._places[name] = place
                self.scales[name] = scale_of(unit) if unit else scale_in_name(name)[1]
            self.origin = Origin(
                "MDF", {"recorded": f"{mdf.header.start_time:%Y-%m-%d %H:%M:%S %Z}"}
            )

    def samples(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        group, index = self._places[name]
        with _opened(self.file) as mdf, silent():
            signal = mdf.get(group=group, index=index).validate()
        values = signal.samples
        if values.ndim != 1 or values.dtype.kind not in "fiu":
            raise UsageError(
                f"{shown(self.file)}: channel {name} has no plain numbers; leave it out"
            )
        return np.asarray(signal.timestamps, dtype=float), values.astype(float)


@contextmanager
def _opened(file: Path) -> Iterator[Any]:
    """UsageError for whatever asammdf, which has no class of its own for it, stumbles over."""
    try:
        with open_mdf(file) as mdf:
            yield mdf
    except (UsageError, OSError):
        raise
    except Exception as error:
        reason = one_line(error)[:120] or type(error).__name__
        raise UsageError(f"{shown(file)}: not an MDF file, or cut off ({reason}); export it again")


def is_bus_log(file: Path) -> bool:
    """Whether all that it has are frames of CAN buses, and what asammdf decodes of them by the
    databases that are attached."""
    with _opened(file) as mdf:
        others = [group for group in mdf.groups if not _has_frames(group)]
        return len(others) < len(mdf.groups) and all(map(_is_decoded, others))


def _has_frames(group: Any) -> bool:
    return any(channel.name == FRAME for channel in group.channels)


def _is_decoded(group: Any) -> bool:
    return (group.channel_group.acq_name or "").startswith(DECODED)


def _channels(mdf: Any) -> Iterator[tuple[str, tuple[int, int], str]]:
    """Name, group and index, unit; channels of time and frames are none. A name that comes again
    has its group's number."""
    seen: set[str] = set()
    for number, group in enumerate(mdf.groups):
        if _has_frames(group):
            continue
        for index, channel in enumerate(group.channels):
            if index == mdf.masters_db.get(number):
                continue
            name = channel.name if channel.name not in seen else f"{channel.name} ({number})"
            seen.add(name)
            unit = getattr(channel.conversion, "unit", "") or channel.unit or ""
            yield name, (number, index), unit
