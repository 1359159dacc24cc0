"""What shakes a structure, from words: force:5..40Hz,20N or base:2..8Hz,0.5m/s2."""

import re
from dataclasses import dataclass

from quiesce.base.errors import UsageError

FORCE, BASE = "force", "base"
G_m_s2 = 9.80665
LEAST_Hz, MOST_Hz = 0.1, 200.0
MOST_LEVEL = 1e6
FORM = (
    "expected force:LOW..HIGHHz,LEVELN or base:LOW..HIGHHz,LEVELm/s2 (or g); without .. it is one "
    "frequency"
)
_NUMBER = r"(\d+(?:\.\d+)?(?:[eE][+-]?\d+)?)"
_WORDS = re.compile(rf"(force|base):{_NUMBER}(?:\.\.{_NUMBER})?Hz,{_NUMBER}(N|m/s2|g)")


@dataclass(frozen=True)
class Drive:
    """A sine of the same amplitude at every frequency."""

    kind: str  # FORCE: at a place of the structure; BASE: of what it stands on
    low_Hz: float
    high_Hz: float
    level: float  # amplitude in N, or m/s2 of the base
    text: str  # as it was typed

    @property
    def unit(self) -> str:
        return "N" if self.kind == FORCE else "m/s2"

    @property
    def is_single(self) -> bool:
        return self.low_Hz == self.high_Hz


def read_drive(text: str) -> Drive:
    """UsageError where the words are no drive, or its numbers contradict each other."""
    found = _WORDS.fullmatch(text.replace(" ", ""))
    if found is None:
        raise UsageError(f"--drive {text}: {FORM}")
    kind, low, high, size, unit = found.groups()
    if (kind == FORCE) != (unit == "N"):
        raise UsageError(f"--drive {text}: a {kind}'s level is in {_units_of(kind)}, not {unit}")
    low_Hz, high_Hz = float(low), float(high or low)
    level = float(size) * (G_m_s2 if unit == "g" else 1.0)
    if not LEAST_Hz <= low_Hz <= high_Hz <= MOST_Hz:
        raise UsageError(
            f"--drive {text}: expected frequencies that rise, within {LEAST_Hz:g} .. {MOST_Hz:g} Hz"
        )
    if not 0.0 < level <= MOST_LEVEL:
        raise UsageError(f"--drive {text}: expected a level above 0, at most {MOST_LEVEL:g}")
    return Drive(kind, low_Hz, high_Hz, level, text)


def _units_of(kind: str) -> str:
    return "N" if kind == FORCE else "m/s2 or g"


def steps_Hz(drive: Drive, own_Hz: list[float], count: int = 4) -> list[float]:
    """Frequencies to try one after the other: both ends of the drive's range and evenly between
    them; those nearest to natural frequencies inside it are moved there. Three digits each."""
    if drive.is_single:
        return [drive.low_Hz]
    gap_Hz = (drive.high_Hz - drive.low_Hz) / (count - 1)
    out = [drive.low_Hz + i * gap_Hz for i in range(count)]
    for freq_Hz in own_Hz:
        if drive.low_Hz < freq_Hz < drive.high_Hz:
            at = min(range(1, count - 1), key=lambda i: abs(out[i] - freq_Hz))
            out[at] = freq_Hz
    return sorted({float(f"{freq_Hz:.3g}") for freq_Hz in out})
