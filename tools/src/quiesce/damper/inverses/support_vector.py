"""The current for a wanted force by support vectors, from force, displacement, velocity and, where
it is known, the fluid's temperature.

Source: review of MR damper models, 3.2.3 and Fig 7 (Shi: i = SVR(x, v, F, T)), which prints neither
equation nor number. Two things of it are ours. Near v = 0 every current gives the same force: rows
there are left out, and the answer is held. Beyond what the damper can give the answer saturates:
rows of the least current are learned again with less force, rows of the largest with more.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.data.split import Segment
from quiesce.damper.inverses.demand import Source, checked_levels, resists
from quiesce.damper.inverses.taps import INPUTS, LEAST_SPEED, is_told
from quiesce.damper.learned.inputs import Box, column
from quiesce.damper.learned.support_vector import fitted
from quiesce.damper.library import Scales

TEMPERATURE = "temperature_C"


@dataclass(frozen=True)
class Settings:
    rows: int = 1500  # most rows to train on
    # Of the largest: below it rows are left out and the answer is held.
    least_speed: float = LEAST_SPEED
    penalty: float = 30.0  # C of the current in parts of the largest
    gamma: float = 1.0  # of the scaled inputs
    epsilon: float = 0.03  # of the largest current
    less: float = 0.7  # least force that rows of the least current are learned with, of theirs
    more: float = 1.3  # most force of rows of the largest


@dataclass(frozen=True)
class InverseSupportVector:
    """Inputs are cut off at the ranges of the training and scaled to -1 .. 1."""

    box: Box  # INPUTS and, where it is known, TEMPERATURE
    max_current_A: float
    least_speed_m_s: float
    gamma: float
    intercept: float
    coefficients: np.ndarray  # [vectors]
    vectors: np.ndarray  # [vectors, 3 or 4]

    @property
    def knows_temperature(self) -> bool:
        return TEMPERATURE in self.box.keys

    def current_A(
        self,
        force_N: float,
        disp_m: float,
        velocity_m_s: float,
        temperature_C: float = float("nan"),
        held_A: float = 0.0,
    ) -> float:
        """Within 0 .. max_current_A: held_A below least_speed_m_s, 0 for a force that does not
        resist the motion. temperature_C counts where it was trained with one."""
        if abs(velocity_m_s) < self.least_speed_m_s:
            return held_A
        if not resists(force_N, velocity_m_s):
            return 0.0
        seen = np.array([force_N, disp_m, velocity_m_s, temperature_C])[: len(self.box)]
        return float(self._part(seen)) * self.max_current_A

    def _part(self, seen: np.ndarray) -> float:
        distance2 = np.sum((self.vectors - self.box.scaled(seen)) ** 2, axis=1)
        part = self.intercept + self.coefficients @ np.exp(-self.gamma * distance2)
        return min(max(part, 0.0), 1.0)


def train(
    segments: Sequence[Segment],
    scales: Scales,
    seed: int = 0,
    settings: Settings | None = None,
    with_temperature: bool = True,
) -> InverseSupportVector:
    """with_temperature False: from the same rows without that column. UsageError where the current
    is the same throughout, or where a test lacks its temperature."""
    settings = settings or Settings()
    rng = np.random.default_rng(seed)
    most_A = max(float(one.record.command[one.rows].max()) for one in segments)
    source = Source(segments, most_A)
    checked_levels(source)
    keys = (*INPUTS, TEMPERATURE) if with_temperature else INPUTS
    least_m_s = settings.least_speed * scales.speed_m_s
    seen, part = beyond(*told(source, keys, least_m_s), settings, rng)
    chosen = rng.permutation(len(seen))[: settings.rows]
    box = box_around(keys, seen)
    machine = fitted(
        box.scaled(seen[chosen]), part[chosen], settings.penalty, settings.gamma, settings.epsilon
    )
    return InverseSupportVector(
        box,
        most_A,
        least_m_s,
        settings.gamma,
        float(machine.intercept_[0]),
        machine.dual_coef_[0],
        machine.support_vectors_,
    )


def told(source: Source, keys: Sequence[str], least_m_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Inputs [rows, keys] and current in parts of the largest [rows], of the rows that tell it.
    UsageError where a test lacks its temperature."""
    seen, part = [], []
    for one in source.segments:
        if TEMPERATURE in keys and not has_temperature(one):
            raise UsageError("an inverse model with temperature needs one in every test")
        rows = np.arange(one.first, one.end)
        rows = rows[is_told(one.record, rows, least_m_s)]
        seen.append(np.stack([column(one.record, key)[rows] for key in keys], axis=1))
        part.append(source.part(one.record)[rows])
    return np.concatenate(seen), np.concatenate(part)


def has_temperature(segment: Segment) -> bool:
    measured = segment.record.temperature_C
    return measured is not None and bool(np.isfinite(measured[segment.rows]).all())


def box_around(keys: Sequence[str], seen: np.ndarray) -> Box:
    """Ranges of inputs [rows, keys], those that do not vary a little wider."""
    low, high = seen.min(axis=0), seen.max(axis=0)
    return Box(tuple(keys), low, np.maximum(high, low + 1e-9 * np.maximum(np.abs(low), 1.0)))


def beyond(
    seen: np.ndarray, part: np.ndarray, settings: Settings, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """The rows, and those of both ends again with a force that the damper cannot give."""
    least, most = part <= part.min() + 1e-6, part >= part.max() - 1e-6
    under, over = seen[least].copy(), seen[most].copy()
    under[:, 0] *= rng.uniform(settings.less, 1.0, len(under))
    over[:, 0] *= rng.uniform(1.0, settings.more, len(over))
    return np.concatenate([seen, under, over]), np.concatenate([part, part[least], part[most]])
