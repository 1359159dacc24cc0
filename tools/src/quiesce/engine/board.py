"""Boards as the bench reads them from their files: what is wired to what."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.engine.bench import Bench

SCALES_PER_UNIT = 1000
US_PER_s = 1_000_000


@dataclass(frozen=True)
class Sensor:
    """What turns a quantity into counts, in its own unit."""

    name: str
    measures: str
    unit: str
    unit_per_count: float  # > 0
    polarity: int
    offset_counts: int
    full_scale_counts: int
    period_us: int  # 0: a sample each tick

    def counts(self, values: np.ndarray) -> np.ndarray:
        """Of values in its unit, clipped at its full scale."""
        exact = values * self.polarity / self.unit_per_count
        rounded = np.rint(exact + self.offset_counts)
        return np.clip(rounded, -self.full_scale_counts, self.full_scale_counts).astype("<i4")

    def values(self, counts: np.ndarray) -> np.ndarray:
        """What such counts stand for, in its unit."""
        return (counts - self.offset_counts) * self.polarity * self.unit_per_count

    def is_due(self, ticks: int, rate_Hz: int) -> np.ndarray:
        """Of each tick: whether it is the first one that begins in one of its periods."""
        if self.period_us == 0:
            return np.ones(ticks, dtype=bool)
        period = np.arange(ticks, dtype=np.int64) * US_PER_s // (rate_Hz * self.period_us)
        return np.diff(period, prepend=-1) > 0


@dataclass(frozen=True)
class Board:
    name: str
    file: Path
    bodies: tuple[str, ...]
    sensors: tuple[Sensor, ...]
    dampers: tuple[str, ...]
    tracked: Sensor
    ceiling_mA: int  # of the damper that may have most
    lacks: dict[str, str | None]  # of each law of the bench: the first signal that it lacks


def read_sensor(data: dict[str, Any]) -> Sensor:
    return Sensor(
        data["name"],
        data["measures"],
        data["unit"],
        data["scale"] / SCALES_PER_UNIT,
        data["polarity"],
        data["offset_counts"],
        data["full_scale_counts"],
        data["period_us"],
    )


def load_board(bench: Bench, file: Path) -> Board:
    """UsageError, in the bench's words, where the file is not a valid board."""
    data = bench.json("board-check", str(file))
    sensors = tuple(read_sensor(sensor) for sensor in data["sensors"])
    return Board(
        name=data["name"],
        file=file,
        bodies=tuple(data["bodies"]),
        sensors=sensors,
        dampers=tuple(damper["name"] for damper in data["dampers"]),
        tracked=sensors[data["tracked"]],
        ceiling_mA=max(damper["ceiling_mA"] for damper in data["dampers"]),
        lacks=data["laws"],
    )
