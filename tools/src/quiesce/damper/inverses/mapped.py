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
from quiesce.damper.force_map import Map, map_words, maps_of_words, why_no_map
from quiesce.damper.inverse import VELOCITY, interpolated, monotone_range
from quiesce.damper.inverses.demand import Source
from quiesce.damper.learned.model import Report, silent
from quiesce.damper.simulate import simulator
from quiesce.table.file import read_words, table_bytes

NAME = "map"
TITLE = "force map of the controller"
HELP = "the controller's table of forces, of a damper file"
TRACKER = "tracker inverse reads it"


@dataclass(frozen=True)
class MapInverse:
    words: list[int]

    @property
    def table(self) -> Map:
        return maps_of_words(self.words)[0]

    @property
    def max_current_A(self) -> float:
        return float(self.table.currents_A[-1])

    def currents(self, demand: Record) -> np.ndarray:
        table = self.table
        motion = demand.velocity_m_s if table.axis == VELOCITY else demand.disp_m
        # Where it is 0 the direction is the demand's.
        way = np.where(motion == 0.0, np.sign(demand.force_N), np.sign(motion))
        out = np.zeros(len(demand))
        for side in (-1.0, 1.0):
            rows = way == side
            at = table.places * side > 0.0
            # Beyond its first and last place those stand.
            places = np.abs(table.places[at])[:: int(side)]
            forces = np.abs(table.forces_N[at])[:: int(side)]
            size = np.abs(motion[rows])
            columns = np.stack([np.interp(size, places, one) for one in forces.T])
            wanted_N = np.abs(demand.force_N[rows])
            found_A = interpolated(table.currents_A, columns, wanted_N)
            out[rows] = np.where(wanted_N > columns[-1], self.max_current_A, found_A)
        return out

    def parameters(self) -> dict[str, Any]:
        return {"words": self.words}

    def to_bytes(self) -> bytes:
        return table_bytes(self.words)


def read_map(file: Path) -> list[int]:
    """Words of one damper or several. UsageError where they are no map."""
    words = read_words(file)
    try:
        maps_of_words(words)
    except ValueError as error:
        raise UsageError(f"{shown(file)}: {error}") from None
    return words


def read_table(file: Path) -> MapInverse:
    """UsageError where they are no map of one damper."""
    words = read_map(file)
    if (count := len(maps_of_words(words))) > 1:
        raise UsageError(f"{shown(file)}: a map of {count} dampers; an inverse is of one")
    return MapInverse(words)


def make(source: Source, seed: int = 0, progress: Report = silent) -> MapInverse:
    """Up to the current where the force stops rising. The seed is not used. UsageError where there
    is no map."""
    damper = source.model_for(NAME)
    simulate = None if damper.is_kernel else simulator(damper)
    found = monotone_range(damper, source.max_current_A, simulate=simulate)
    if why := why_no_map(found):
        raise UsageError(f"{damper.name}: no map: {why}")
    inverse = MapInverse(map_words(found))
    progress(f"map: {4 * len(inverse.words)} bytes, up to {inverse.max_current_A:g} A")
    return inverse
