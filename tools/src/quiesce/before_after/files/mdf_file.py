"""Measured channels of an MDF file, as data loggers write them."""

from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.before_after.files.source import Origin, Source
from quiesce.before_after.motion import scale_in_name, scale_of
from quiesce.recording.formats.mdf_channels import channels, has_frames, opened, samples_of

DECODED = "from CAN"  # how asammdf calls groups that it makes of frames


class MdfFile(Source):
    """Frames that a database in the file decodes are channels, too. UsageError where it is no MDF
    file or cut off."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self._places: dict[str, tuple[int, int]] = {}
        self.scales = {}
        with opened(file) as mdf:
            for name, place, unit in channels(mdf):
                self._places[name] = place
                self.scales[name] = scale_of(unit) if unit else scale_in_name(name)[1]
            self.origin = Origin(
                "MDF", {"recorded": f"{mdf.header.start_time:%Y-%m-%d %H:%M:%S %Z}"}
            )

    def samples(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        with opened(self.file) as mdf:
            found = samples_of(mdf, self._places[name])
        if found is None:
            raise UsageError(
                f"{shown(self.file)}: channel {name} has no plain numbers; leave it out"
            )
        return found


def is_bus_log(file: Path) -> bool:
    """Whether all that it has are frames of CAN buses, and what asammdf decodes of them by the
    databases that are attached."""
    with opened(file) as mdf:
        others = [group for group in mdf.groups if not has_frames(group)]
        return len(others) < len(mdf.groups) and all(map(_is_decoded, others))


def _is_decoded(group: Any) -> bool:
    return (group.channel_group.acq_name or "").startswith(DECODED)
