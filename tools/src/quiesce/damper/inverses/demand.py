"""What every inverse is made from and asked: a Record whose force_N is the wanted force.

The semi-active condition is judged here, once: a damper only resists, so that a force that does not
have the sign of the velocity gets no current (as tracker `inverse` of the controller judges it).
Methods see it as a wanted force of 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Protocol

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment
from quiesce.damper.model_file import DamperModel

TICK_RATE_HZ = 1000  # of the controller that tables with memory are made for


@dataclass(frozen=True)
class Source:
    """What an inverse is made from: tests with measured force and command (A), and the model of the
    damper where there is one."""

    segments: Sequence[Segment]
    max_current_A: float
    damper: DamperModel | None = None

    def model_for(self, method: str) -> DamperModel:
        """UsageError where there is none."""
        if self.damper is None:
            raise UsageError(
                f"method {method} stands on a damper file; 'quiesce identify' makes one of a "
                "recording"
            )
        return self.damper

    def part(self, record: Record) -> np.ndarray:
        """A record's command in parts of the largest current, [samples]."""
        return record.command / self.max_current_A


class Inverse(Protocol):
    max_current_A: float

    def currents(self, demand: Record) -> np.ndarray:
        """Current in A at every sample for demand.force_N in N, [samples]; at a sample from what
        was before it only. demand.command is not read."""

    def parameters(self) -> dict[str, Any]:
        """What its file holds."""


def resists(force_N: Any, velocity_m_s: Any) -> Any:
    """Whether a force, or each of [samples], has the sign of its velocity."""
    return force_N * velocity_m_s > 0.0


def judged(demand: Record) -> Record:
    """The demand with 0 N where it does not resist the motion."""
    is_resisting = resists(demand.force_N, demand.velocity_m_s)
    return replace(demand, force_N=np.where(is_resisting, demand.force_N, 0.0))


def in_ticks(demand: Record, rate_Hz: int) -> tuple[Record, np.ndarray]:
    """The demand as a controller with so many ticks a second sees it, from its first sample on, and
    the last tick up to each sample, [samples]. Between samples its arrays are interpolated."""
    if demand.rate_Hz == rate_Hz:
        return demand, np.arange(len(demand))
    time_s = np.arange(len(demand)) / demand.rate_Hz
    at = np.floor(time_s * rate_Hz + 1e-6).astype(int)
    ticks_s = np.arange(at[-1] + 1) / rate_Hz
    seen = {
        one.name: np.interp(ticks_s, time_s, value)
        for one in fields(demand)
        if isinstance(value := getattr(demand, one.name), np.ndarray)
    }
    return replace(demand, rate_Hz=float(rate_Hz), **seen), at


def commanded(inverse: Inverse, demand: Record) -> np.ndarray:
    """Currents in A within 0 .. max_current_A, [samples]; 0 where the demand does not resist."""
    wanted = judged(demand)
    current_A = np.clip(inverse.currents(wanted), 0.0, inverse.max_current_A)
    return np.where(wanted.force_N == 0.0, 0.0, current_A)


def checked_levels(source: Source) -> None:
    """UsageError where the current is the same throughout."""
    currents = np.concatenate([one.record.command[one.rows] for one in source.segments])
    if not np.ptp(currents) > 1e-3 * max(source.max_current_A, 1e-9):
        raise UsageError("an inverse model needs tests at two currents or more")
