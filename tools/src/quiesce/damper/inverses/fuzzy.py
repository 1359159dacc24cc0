"""ANFIS as an inverse: current over wanted force, displacement and velocity, a grid of Gaussians
with one conclusion each, trained as the forward ANFIS is."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.data.record import Record
from quiesce.damper.inverses.compiled import COMPILED
from quiesce.damper.inverses.demand import Source, checked_levels
from quiesce.damper.inverses.keys import MOST_UNITS, box_of, number, numbers
from quiesce.damper.inverses.taps import (
    INPUTS,
    LEAST_SPEED,
    held,
    largest_speed_m_s,
    taught_rows,
)
from quiesce.damper.learned import anfis
from quiesce.damper.learned.inputs import Box
from quiesce.damper.learned.model import Report, silent
from quiesce.damper.learned.sampled import sample_time_s, series_of

NAME = "anfis"
TITLE = "inverse ANFIS"
HELP = "Gaussians on a grid of force, displacement and velocity"
TRACKER = COMPILED
MEMBERSHIPS = 4
MOST_ROWS = 4_000


@dataclass(frozen=True)
class AnfisInverse:
    box: Box
    premises: anfis.Premises  # scaled
    conclusions: np.ndarray  # [rules], in parts of the largest current
    least_speed_m_s: float
    max_current_A: float

    def currents(self, demand: Record) -> np.ndarray:
        current_A = self._at(self.box.picked(demand))
        return held(current_A, demand.velocity_m_s, self.least_speed_m_s)

    def steady_A(self, force_N: np.ndarray, velocity_m_s: float) -> np.ndarray:
        """Current in mid-stroke, [forces]."""
        zero = np.zeros(len(force_N))
        return self._at(np.stack([force_N, zero, zero + velocity_m_s], axis=1))

    def _at(self, picked: np.ndarray) -> np.ndarray:
        parts = self.premises.weights(self.box.scaled(picked)) @ self.conclusions
        return self.max_current_A * np.clip(parts, 0.0, 1.0)

    def parameters(self) -> dict[str, Any]:
        return {
            "memberships": self.premises.centres.shape[1],
            "least_speed_m_s": self.least_speed_m_s,
            **self.box.tables(),
            "centres": self.premises.centres.ravel().tolist(),
            "widths": self.premises.widths.ravel().tolist(),
            "conclusions": self.conclusions.tolist(),
        }


def read(keys: Mapping[str, Any], max_current_A: float, where: str) -> AnfisInverse:
    count = keys.get("memberships")
    if type(count) is not int or not 2 <= count**3 <= MOST_UNITS:
        raise UsageError(f"{where}: memberships: expected an integer in 2 .. 10, found {count!r}")
    shape = (len(INPUTS), count)
    centres, widths = (
        numbers(keys.get(key), shape[0] * count, f"{where}: {key}").reshape(shape)
        for key in ("centres", "widths")
    )
    if not (widths > 0.0).all():
        raise UsageError(f"{where}: widths: expected numbers > 0")
    return AnfisInverse(
        box_of(keys, INPUTS, where),
        anfis.Premises(centres, widths),
        numbers(keys.get("conclusions"), count ** shape[0], f"{where}: conclusions"),
        number(keys, "least_speed_m_s", where),
        max_current_A,
    )


def make(
    source: Source,
    seed: int = 0,
    progress: Report = silent,
    settings: anfis.Settings | None = None,
) -> AnfisInverse:
    """The seed is not used: nothing is drawn. UsageError where the current is the same
    throughout."""
    settings = settings or anfis.Settings(memberships=MEMBERSHIPS, epochs=40)
    checked_levels(source)
    segments = source.segments
    time_s = sample_time_s(segments)
    least_m_s = LEAST_SPEED * largest_speed_m_s(segments)
    box = Box.of(segments, INPUTS)
    series = series_of(segments, box, (0,), time_s, source.part)
    u, parts = taught_rows(segments, series, time_s, least_m_s, MOST_ROWS)
    premises, conclusions, errors = anfis.hybrid(u, parts, settings, progress)
    progress(f"anfis: {errors[-1] * source.max_current_A:.3g} A root mean square on {len(u)} rows")
    return AnfisInverse(box, premises, conclusions, least_m_s, source.max_current_A)
