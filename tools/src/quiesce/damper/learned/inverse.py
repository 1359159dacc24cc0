"""Inverse models: the current for a wanted force.

InverseNetwork gives it from force, displacement and velocity. Near v = 0 every current gives the
same force, so rows there are left out of the training and the network's answer is held.
stepped_current is the other way: it moves the current until a forward model's force agrees.
"""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown
from quiesce.damper.data.split import Segment
from quiesce.damper.learned.model import Report, silent
from quiesce.damper.learned.network import Network, fit
from quiesce.damper.library import Scales

SCHEMA = "quiesce-inverse-damper"
VERSION = 1
_KEYS = ("force_scale_N", "disp_scale_m", "velocity_scale_m_s", "max_current_A")


@dataclass(frozen=True)
class Settings:
    hidden: tuple[int, ...] = (24, 12)
    least_speed: float = 0.1  # of the largest: below it rows are left out and the answer is held
    epochs: int = 80
    decay: float = 1e-3


@dataclass(frozen=True)
class InverseNetwork:
    """Inputs are scaled by the largest values of the training and cut off at +-1."""

    force_scale_N: float
    disp_scale_m: float
    velocity_scale_m_s: float
    max_current_A: float
    least_speed_m_s: float
    network: Network

    def current_A(
        self, force_N: np.ndarray, disp_m: np.ndarray, velocity_m_s: np.ndarray, held_A: float = 0.0
    ) -> np.ndarray:
        """Currents for wanted forces in turn, all arrays of one length, within 0 .. max_current_A.

        Slower than least_speed_m_s the current before is held, at first held_A; a force that does
        not resist the motion gets 0.
        """
        scales = (self.force_scale_N, self.disp_scale_m, self.velocity_scale_m_s)
        columns = [
            np.clip(np.asarray(values, float) / scale, -1.0, 1.0)
            for values, scale in zip((force_N, disp_m, velocity_m_s), scales, strict=True)
        ]
        wanted = self.max_current_A * self.network(np.stack(columns, axis=1))[:, 0]
        wanted = np.clip(wanted, 0.0, self.max_current_A)
        wanted[columns[0] * columns[2] < 0.0] = 0.0
        for k in np.flatnonzero(np.abs(velocity_m_s) < self.least_speed_m_s):
            wanted[k] = wanted[k - 1] if k > 0 else held_A
        return wanted

    def to_toml(self) -> dict[str, Any]:
        scales = {key: getattr(self, key) for key in _KEYS}
        return {
            "schema": SCHEMA,
            "version": VERSION,
            **scales,
            "least_speed_m_s": self.least_speed_m_s,
            "layer": self.network.tables(),
        }

    def write(self, file: Path) -> None:
        with output_files(file.parent) as staging:
            (staging / file.name).write_text(tomli_w.dumps(self.to_toml()), encoding="utf-8")


def read_inverse(file: Path) -> InverseNetwork:
    """UsageError with file and key where it is wrong."""
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise UsageError(f"{shown(file)}: {one_line(error)}")
    where = shown(file)
    if table.get("schema") != SCHEMA or table.get("version") != VERSION:
        raise UsageError(f"{where}: schema: expected {SCHEMA}, version {VERSION}")
    scales = [number(table, key, where) for key in _KEYS]
    least_m_s = number(table, "least_speed_m_s", where)
    return InverseNetwork(*scales, least_m_s, read_layers(table.get("layer"), where))


def number(table: Mapping[str, Any], key: str, where: str) -> float:
    value = table.get(key)
    if not isinstance(value, int | float) or isinstance(value, bool) or not 0.0 < value < 1e12:
        raise UsageError(f"{where}: {key}: expected a number > 0, found {value!r}")
    return float(value)


def read_layers(tables: Any, where: str) -> Network:
    if not isinstance(tables, list) or not tables or not all(isinstance(t, dict) for t in tables):
        raise UsageError(f"{where}: layer: expected tables [[layer]] with weights and biases")
    weights, biases, inputs = [], [], 3
    for k, table in enumerate(tables):
        key = f"{where}: layer[{k + 1}]"
        units = 1 if k == len(tables) - 1 else table.get("units")
        if not isinstance(units, int) or isinstance(units, bool) or not 1 <= units <= 1024:
            raise UsageError(f"{key}.units: expected an integer in 1 .. 1024, found {units!r}")
        weights.append(numbers(table.get("weights"), units * inputs, f"{key}.weights"))
        biases.append(numbers(table.get("biases"), units, f"{key}.biases"))
        weights[-1] = weights[-1].reshape(units, inputs)
        inputs = units
    return Network(weights, biases)


def numbers(values: Any, count: int, key: str) -> np.ndarray:
    good = isinstance(values, list) and all(
        isinstance(one, int | float) and not isinstance(one, bool) and np.isfinite(one)
        for one in values
    )
    if not good or len(values) != count:
        found = len(values) if isinstance(values, list) else repr(values)
        raise UsageError(f"{key}: expected {count} finite numbers, found {found}")
    return np.array(values, dtype=float)


def train(
    segments: Sequence[Segment],
    scales: Scales,
    seed: int = 0,
    settings: Settings | None = None,
    progress: Report = silent,
) -> InverseNetwork:
    """UsageError where the current is the same throughout."""
    settings = settings or Settings()
    columns = ("force_N", "disp_m", "velocity_m_s", "command")
    force, disp, velocity, current = (
        np.concatenate([getattr(one.record, name)[one.rows] for one in segments])
        for name in columns
    )
    most_A = float(current.max())
    if not np.ptp(current) > 1e-3 * max(most_A, 1e-9):
        raise UsageError("an inverse model needs tests at two currents or more")
    least_m_s = settings.least_speed * scales.speed_m_s
    fast = np.abs(velocity) >= least_m_s
    inputs = np.stack(
        [force / scales.force_N, disp / scales.disp_m, velocity / scales.speed_m_s], axis=1
    )[fast]
    rng = np.random.default_rng(seed)
    network = Network.random((3, *settings.hidden, 1), rng)
    targets = (current[fast] / most_A)[:, None]
    fit(network, inputs, targets, rng, settings.epochs, decay=settings.decay)
    error = most_A * float(np.sqrt(np.mean((network(inputs) - targets) ** 2)))
    progress(f"inverse_network: {error:.3g} A root mean square")
    return InverseNetwork(
        scales.force_N, scales.disp_m, scales.speed_m_s, most_A, least_m_s, network
    )


def stepped_current(
    current_A: float,
    wanted_N: float,
    force_N: float,
    weakest_N: float,
    strongest_N: float,
    range_A: tuple[float, float],
    tolerance_N: float,
) -> float:
    """The next current, from a forward model's force now and at both ends of range_A.

    Kept within the tolerance; raised or lowered by the part of the way that is missing; the least
    where the wanted force does not resist the motion. Source: review of MR damper models, eq 35,
    with the check of the sign that it lacks and without its division by zero.
    """
    least_A, most_A = range_A
    if wanted_N * force_N <= 0.0:
        return least_A
    missing_N = abs(wanted_N) - abs(force_N)
    if abs(missing_N) <= tolerance_N:
        return current_A
    if missing_N > 0.0:
        reach_N = abs(strongest_N) - abs(force_N)
        part = 1.0 if reach_N <= 0.0 else min(missing_N / reach_N, 1.0)
        return current_A + part * (most_A - current_A)
    reach_N = abs(force_N) - abs(weakest_N)
    part = 1.0 if reach_N <= 0.0 else min(-missing_N / reach_N, 1.0)
    return current_A - part * (current_A - least_A)
