"""Zones A to D of machine vibration after ISO 20816-3: boundaries are data, the user chooses."""

import tomllib
from bisect import bisect_right
from dataclasses import dataclass
from functools import cache
from pathlib import Path

NAMES = "ABCD"
# Of the broad-band velocity; of machines below 600 revolutions a minute from 2 Hz on.
BAND_Hz = (10.0, 1000.0)
SLOW_BAND_Hz = (2.0, 1000.0)
SOURCE = "ISO 20816-3:2022 as widely published; check against your copy of the standard"


@dataclass(frozen=True)
class Machine:
    """name: GROUP:SUPPORT. boundaries_mm_s: RMS velocity where zones B, C and D begin."""

    name: str
    boundaries_mm_s: tuple[float, float, float]
    band_Hz: tuple[float, float] = BAND_Hz

    def zone(self, velocity_mm_s: float) -> str:
        """At a boundary the worse one."""
        return NAMES[bisect_right(self.boundaries_mm_s, velocity_mm_s)]


@cache
def machines() -> dict[str, Machine]:
    """By name."""
    groups = tomllib.loads(Path(__file__).with_name("zones.toml").read_text(encoding="utf-8"))
    return {
        f"{group}:{support}": Machine(f"{group}:{support}", tuple(values["boundaries_mm_s"]))
        for group, supports in groups.items()
        for support, values in supports.items()
    }
