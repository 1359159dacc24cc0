"""Tables of law `friction`: modulated homogeneous friction.

firmware/law/forms/law_friction.c describes the words.
"""

from collections.abc import Sequence
from dataclasses import astuple, dataclass

import numpy as np

from quiesce.law.sections import read_sections, sealed_sections
from quiesce.law.signal import Signal, signal
from quiesce.table.kinds import FRICTION
from quiesce.table.words import Reader

MAGIC = FRICTION.magic
LIMIT = 2**30 - 1
OUTWARD, BACK = 1, 2


@dataclass(frozen=True)
class FrictionSection:
    """Of one damper. ways: OUTWARD where the stroke grows, BACK where it comes back, or both."""

    gain_N_m: int
    least_peak_nm: int
    limit_mN: int
    band_um_s: int
    ways: int


@dataclass(frozen=True)
class FrictionTable:
    sections: tuple[FrictionSection, ...]

    law = "friction"
    demands = "force"

    def signals(self) -> list[Signal]:
        """Stroke and its velocity, damper by damper."""
        return [
            signal(name, i)
            for i in range(len(self.sections))
            for name in ("stroke", "stroke velocity")
        ]

    def dampers(self) -> set[int]:
        return set(range(len(self.sections)))

    def words(self) -> list[int]:
        return sealed_sections(MAGIC, [astuple(one) for one in self.sections], "table")

    def forces_N(self, values: np.ndarray) -> np.ndarray:
        """Of each damper [ticks 4] for signals [ticks, as signals() lists them] in SI units, in
        float64."""
        out = np.zeros((len(values), 4))
        for i, section in enumerate(self.sections):
            out[:, i] = _forces_N(section, values[:, 2 * i], values[:, 2 * i + 1])
        return out


def _forces_N(section: FrictionSection, stroke_m: np.ndarray, speed_m_s: np.ndarray) -> np.ndarray:
    out = np.zeros(len(stroke_m))
    way, extreme, peak = 0.0, 0.0, 0.0
    for tick, (stroke, speed) in enumerate(zip(stroke_m, speed_m_s, strict=True)):
        now = float(np.sign(speed)) if abs(speed) > 1e-6 * section.band_um_s else way
        if now != way:
            peak = abs(stroke if way == 0 else extreme)
            way, extreme = now, stroke
        elif way != 0:
            extreme = max(extreme, stroke) if way > 0 else min(extreme, stroke)
        acts = section.ways & (OUTWARD if stroke * way > 0 else BACK)
        if peak >= 1e-9 * section.least_peak_nm and acts:
            out[tick] = way * min(section.gain_N_m * peak, 1e-3 * section.limit_mN)
    return out


def read(words: Sequence[int]) -> FrictionTable:
    """ValueError, in one line, where the firmware refuses them."""
    return FrictionTable(read_sections(words, _read_section))


def _read_section(reader: Reader) -> FrictionSection:
    return FrictionSection(
        *(reader.one(0, LIMIT, what) for what in ("gain", "least peak", "limit", "band")),
        reader.one(OUTWARD, OUTWARD | BACK, "ways"),
    )
