"""What a learned model sees: inputs in the order of the C++ library, cut off at the range of the
training data, scaled to -1 .. 1."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment

KEYS = ("current_A", "displacement_m", "velocity_m_s", "temperature_C")

# Rows that are enough to train on; beyond them every k-th is taken.
MOST_ROWS = 12_000


def column(record: Record, key: str) -> np.ndarray:
    if key == "temperature_C":
        if record.temperature_C is None:
            raise UsageError(f"{record.name}: no temperature, but other tests have one")
        return record.temperature_C
    values = {
        "current_A": record.command,
        "displacement_m": record.disp_m,
        "velocity_m_s": record.velocity_m_s,
        "force_N": record.force_N,  # of inverses
    }
    return values[key]


@dataclass(frozen=True)
class Box:
    keys: tuple[str, ...]
    low: np.ndarray  # SI
    high: np.ndarray

    @staticmethod
    def of(segments: Sequence[Segment], keys: Sequence[str] = KEYS[:3]) -> "Box":
        """Ranges of the data; inputs that do not vary are left out. UsageError where nothing
        moves."""
        found = []
        for key in keys:
            values = np.concatenate([column(one.record, key)[one.rows] for one in segments])
            low, high = float(values.min()), float(values.max())
            if high - low > 1e-9 * max(abs(low), abs(high), 1e-12):
                found.append((key, low, high))
        if not any(key in KEYS[1:3] for key, _, _ in found):
            raise UsageError("displacement and velocity are constant; nothing can be learned")
        names, low, high = zip(*found, strict=True)
        return Box(names, np.array(low), np.array(high))

    def __len__(self) -> int:
        return len(self.keys)

    def picked(self, record: Record) -> np.ndarray:
        """[samples, inputs], SI, not cut off."""
        return np.stack([column(record, key) for key in self.keys], axis=1)

    def scaled(self, picked: np.ndarray) -> np.ndarray:
        part = (np.clip(picked, self.low, self.high) - self.low) / (self.high - self.low)
        return 2.0 * part - 1.0

    def tables(self) -> dict[str, dict[str, Any]]:
        """The inputs' tables of a file."""
        return {
            key: {"range": [float(low), float(high)]}
            for key, low, high in zip(self.keys, self.low, self.high, strict=True)
        }


def stacked(
    segments: Sequence[Segment], box: Box, most: int = MOST_ROWS
) -> tuple[np.ndarray, np.ndarray]:
    """Scaled inputs [rows, inputs] and forces [rows] in N of the segments, at most `most` rows."""
    every = max(1, int(np.ceil(sum(len(one) for one in segments) / most)))
    inputs = [box.scaled(box.picked(one.record)[one.rows][::every]) for one in segments]
    forces = [one.record.force_N[one.rows][::every] for one in segments]
    return np.concatenate(inputs), np.concatenate(forces)


def input_keys(segments: Sequence[Segment]) -> tuple[str, ...]:
    """Current, displacement and velocity; temperature where every test has it."""
    has_temperature = all(one.record.temperature_C is not None for one in segments)
    return KEYS if has_temperature else KEYS[:3]
