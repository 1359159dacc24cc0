"""The damper's force map as an inverse: what tracker `inverse` of the controller reads, read back.

firmware/track/force_map.h says what the words are and how they are interpolated.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.damper.data.record import Record
from quiesce.damper.force_map import Map, map_of_words, map_words, why_no_map
from quiesce.damper.inverse import default_velocities, interpolated, monotone_range
from quiesce.damper.inverses.demand import Source
from quiesce.damper.learned.model import Report, silent
from quiesce.damper.simulate import simulator

NAME = "map"
TITLE = "force map of the controller"
HELP = "the controller's table of forces, of a damper file"
TRACKER = "tracker inverse reads it"
SUFFIX = ".words"


@dataclass(frozen=True)
class MapInverse:
    words: list[int]

    @property
    def table(self) -> Map:
        return map_of_words(self.words)

    @property
    def max_current_A(self) -> float:
        return float(self.table.currents_A[-1])

    def currents(self, demand: Record) -> np.ndarray:
        table = self.table
        # Where the motion turns the direction is the demand's.
        way = np.where(
            demand.velocity_m_s == 0.0, np.sign(demand.force_N), np.sign(demand.velocity_m_s)
        )
        out = np.zeros(len(demand))
        for side in (-1.0, 1.0):
            rows = way == side
            at = table.velocities_m_s * side > 0.0
            # Beyond its first and last velocity those stand.
            velocities = np.abs(table.velocities_m_s[at])[:: int(side)]
            forces = np.abs(table.forces_N[at])[:: int(side)]
            speed = np.abs(demand.velocity_m_s[rows])
            columns = np.stack([np.interp(speed, velocities, one) for one in forces.T])
            wanted_N = np.abs(demand.force_N[rows])
            found_A = interpolated(table.currents_A, columns, wanted_N)
            out[rows] = np.where(wanted_N > columns[-1], self.max_current_A, found_A)
        return out

    def parameters(self) -> dict[str, Any]:
        return {"words": self.words}

    def to_text(self) -> str:
        return "".join(f"0x{word:08x}\n" for word in self.words)


def read_words(file: Path) -> MapInverse:
    """UsageError where they are no map."""
    try:
        text = file.read_text(encoding="utf-8")
        words = [int(word, 16) for word in text.split()]
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) else "expected words such as 0x31464d51"
        raise UsageError(f"{shown(file)}: {why}") from None
    try:
        map_of_words(words)
    except ValueError as error:
        raise UsageError(f"{shown(file)}: {error}") from None
    return MapInverse(words)


def make(source: Source, seed: int = 0, progress: Report = silent) -> MapInverse:
    """Up to the current where the force stops rising. The seed is not used. UsageError where there
    is no map."""
    damper = source.model_for(NAME)
    simulate = None if damper.is_kernel else simulator(damper)
    found = monotone_range(damper, source.max_current_A, default_velocities(damper), simulate)
    if why := why_no_map(found):
        raise UsageError(f"{damper.name}: no map: {why}")
    inverse = MapInverse(map_words(found))
    progress(f"map: {4 * len(inverse.words)} bytes, up to {inverse.max_current_A:g} A")
    return inverse
