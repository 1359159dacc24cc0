"""Recorded motions of the ground, as orders to play them."""

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import measurements, root

G_m_s2 = 9.80665
# By the end of the column's name.
UNITS = {"_mm_s2": 1e-3, "_m_s2": 1.0, "_g": G_m_s2}
HEAD_BYTES = 4096


@dataclass(frozen=True)
class Motion:
    """A CSV file: its column of times in s, and one of accelerations."""

    file: Path
    time_column: str
    accel_column: str
    scale_m_s2: float  # a unit of that column

    @property
    def name(self) -> str:
        return self.file.stem

    def order(self, gain: float, time_scale: float) -> dict[str, Any]:
        """For `excite`. gain, time_scale: times as strong and as fast as recorded."""
        return {
            "kind": "record",
            "file": str(self.file.resolve()),
            "time_column": self.time_column,
            "accel_column": self.accel_column,
            "scale_m_s2": self.scale_m_s2,
            "gain": gain,
            "time_scale": time_scale,
        }


def motion_of(file: Path) -> Motion:
    """By the names in its first line. UsageError where they do not tell."""
    try:
        with file.open(encoding="utf-8", newline="") as text:
            head = next(csv.reader([text.readline(HEAD_BYTES)]), [])
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise UsageError(f"{file}: cannot be read as CSV: {error}")
    names = [one.strip() for one in head]
    accels = [(name, end) for name in names for end in UNITS if name.endswith(end)][:1]
    times = [one for one in names if one.endswith("_s") and not one.endswith(tuple(UNITS))][:1]
    if not accels or not times:
        raise UsageError(
            f"{file}: its first line is to name a column of times, ...{'_s'}, and one of "
            f"accelerations, ...{', ...'.join(UNITS)}; found {', '.join(names)[:200] or 'nothing'}"
        )
    name, end = accels[0]
    return Motion(file, times[0], name, UNITS[end])


def motions(files: Iterable[Path]) -> list[Motion]:
    """Those files; without one all that lie beside the project, and what ships."""
    named = list(files)
    if named:
        return [motion_of(file) for file in named]
    beside = sorted(measurements("earthquake").glob("*.csv"))
    return [motion_of(one) for one in (*beside, root() / "sim_hil/data/recordings/base_pulse.csv")]
