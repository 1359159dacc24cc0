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
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment
from quiesce.damper.learned.support_vector import fitted
from quiesce.damper.library import Scales

# Force, displacement, velocity, temperature: what the machine sees, in this order.
_LEAST_KINDS, _ALL_KINDS = 3, 4


@dataclass(frozen=True)
class Settings:
    rows: int = 1500  # most rows to train on
    least_speed: float = 0.1  # of the largest: below it rows are left out and the answer is held
    penalty: float = 30.0  # C of the current in parts of the largest
    gamma: float = 1.0  # of the scaled inputs
    epsilon: float = 0.03  # of the largest current
    less: float = 0.7  # least force that rows of the least current are learned with, of theirs
    more: float = 1.3  # most force of rows of the largest


@dataclass(frozen=True)
class InverseSupportVector:
    """Inputs are cut off at the ranges of the training and scaled to -1 .. 1."""

    low: np.ndarray  # [3 or 4], SI and degrees C
    high: np.ndarray
    max_current_A: float
    least_speed_m_s: float
    gamma: float
    intercept: float
    coefficients: np.ndarray  # [vectors]
    vectors: np.ndarray  # [vectors, 3 or 4]

    @property
    def knows_temperature(self) -> bool:
        return len(self.low) == _ALL_KINDS

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
        if force_N * velocity_m_s < 0.0:
            return 0.0
        seen = np.array([force_N, disp_m, velocity_m_s, temperature_C])[: len(self.low)]
        return float(self._part(seen)) * self.max_current_A

    def _part(self, seen: np.ndarray) -> float:
        u = scaled(seen, self.low, self.high)
        distance2 = np.sum((self.vectors - u) ** 2, axis=1)
        part = self.intercept + self.coefficients @ np.exp(-self.gamma * distance2)
        return min(max(part, 0.0), 1.0)


def scaled(seen: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    return 2.0 * (np.clip(seen, low, high) - low) / (high - low) - 1.0


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
    seen = np.concatenate([columns(one.record)[one.rows] for one in segments])
    current_A = np.concatenate([one.record.command[one.rows] for one in segments])
    most_A = float(current_A.max())
    if not np.ptp(current_A) > 1e-3 * max(most_A, 1e-9):
        raise UsageError("an inverse model needs tests at two currents or more")
    kinds = _ALL_KINDS if with_temperature else _LEAST_KINDS
    seen = seen[:, :kinds]
    if not np.all(np.isfinite(seen)):
        raise UsageError("an inverse model with temperature needs one in every test")
    least_m_s = settings.least_speed * scales.speed_m_s
    is_usable = (np.abs(seen[:, 2]) >= least_m_s) & (seen[:, 0] * seen[:, 2] > 0.0)
    seen, part = beyond(seen[is_usable], current_A[is_usable] / most_A, settings, rng)
    chosen = rng.permutation(len(seen))[: settings.rows]
    low, high = seen.min(axis=0), seen.max(axis=0)
    high = np.maximum(high, low + 1e-9 * np.maximum(np.abs(low), 1.0))
    machine = fitted(
        scaled(seen[chosen], low, high),
        part[chosen],
        settings.penalty,
        settings.gamma,
        settings.epsilon,
    )
    return InverseSupportVector(
        low,
        high,
        most_A,
        least_m_s,
        settings.gamma,
        float(machine.intercept_[0]),
        machine.dual_coef_[0],
        machine.support_vectors_,
    )


def columns(record: Record) -> np.ndarray:
    """[samples, 4]; NaN where no temperature was measured."""
    unknown = np.full(len(record), np.nan)
    warm = unknown if record.temperature_C is None else record.temperature_C
    return np.stack([record.force_N, record.disp_m, record.velocity_m_s, warm], axis=1)


def beyond(
    seen: np.ndarray, part: np.ndarray, settings: Settings, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """The rows, and those of both ends again with a force that the damper cannot give."""
    least, most = part <= part.min() + 1e-6, part >= part.max() - 1e-6
    under, over = seen[least].copy(), seen[most].copy()
    under[:, 0] *= rng.uniform(settings.less, 1.0, len(under))
    over[:, 0] *= rng.uniform(1.0, settings.more, len(over))
    return np.concatenate([seen, under, over]), np.concatenate([part, part[least], part[most]])
