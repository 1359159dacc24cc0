"""Inverses that tracker `network` of the controller works off: a table of one damper, read back.

firmware/track/track_network.c says what the tracker makes of it.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.damper.data.record import Record
from quiesce.damper.inverses.demand import TICK_RATE_HZ, in_ticks
from quiesce.damper.learned.inputs import Box, column
from quiesce.law.forms.network import (
    DEMAND,
    STROKE_VELOCITY,
    NetworkSection,
    NetworkTrackTable,
    Span,
    read_tracker,
)
from quiesce.law.signal import BY_NAME, Signal
from quiesce.network.layers import Layers
from quiesce.table.file import read_words, table_bytes

READ_BY = "tracker network reads it"
_SEEN = {
    "force_N": DEMAND,
    "displacement_m": BY_NAME["stroke"],
    "velocity_m_s": STROKE_VELOCITY,
    "temperature_C": BY_NAME["temperature"],
}
_KEYS = {quantity.name: key for key, quantity in _SEEN.items()}


@dataclass(frozen=True)
class NetworkInverse:
    table: NetworkTrackTable

    @property
    def max_current_A(self) -> float:
        return 1e-3 * self.table.sections[0].largest_mA

    def currents(self, demand: Record) -> np.ndarray:
        """Of the controller's integers, in float64; a delay counts in its own ticks. UsageError
        where the demand has no temperature and the network wants one."""
        section = self.table.sections[0]
        seen, at = demand, np.arange(len(demand))
        if section.rate_Hz:
            seen, at = in_ticks(demand, section.rate_Hz)
        values = [column(seen, _KEYS[one.signal.quantity.name]) for one in section.inputs]
        return self.table.currents_A(np.stack(values, axis=1))[at, 0]

    def parameters(self) -> dict[str, Any]:
        return {"words": self.table.words()}

    def to_bytes(self) -> bytes:
        return table_bytes(self.table.words())


def inverse_of(
    box: Box, layers: Layers, max_current_A: float, least_m_s: float, delay_ticks: int = 0
) -> NetworkInverse:
    """UsageError where the controller would refuse it."""
    inputs = tuple(
        Span.of(Signal(_SEEN[key], 0), float(low), float(high))
        for key, low, high in zip(box.keys, box.low, box.high, strict=True)
    )
    least_um_s = round(STROKE_VELOCITY.per_unit * least_m_s)
    rate_Hz = TICK_RATE_HZ if delay_ticks else 0
    largest_mA = round(1e3 * max_current_A)
    section = NetworkSection(inputs, delay_ticks, largest_mA, layers, least_um_s, rate_Hz)
    inverse = NetworkInverse(NetworkTrackTable((section,)))
    try:
        inverse.table.words()
    except ValueError as error:
        raise UsageError(f"no network for a controller: {error}") from None
    return inverse


def read_table(file: Path) -> NetworkInverse:
    """UsageError where they are no network of a tracker."""
    try:
        table = read_tracker(read_words(file))
    except ValueError as error:
        raise UsageError(f"{shown(file)}: {error}") from None
    if any(one.signal.quantity.name not in _KEYS for one in table.sections[0].inputs):
        raise UsageError(f"{shown(file)}: it sees more than force, motion and temperature")
    return NetworkInverse(table)
