"""The parameters of a model of equations, each with its law against the current."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper.library import FIELD, RIG
from quiesce.damper.model_file import DamperModel

WIDEST = 1e300
SPEED_m_s = 0.1  # where a file states none


@dataclass(frozen=True)
class Law:
    """coefficients: against the effective current in A, ascending, three; the value is held in
    low .. high."""

    name: str
    unit: str
    coefficients: tuple[float, float, float]
    low: float
    high: float
    text: str


def laws_of(damper: DamperModel) -> list[Law]:
    """In the model's order; a list of a spring's as name0, name1, .., without the stroke."""
    if not damper.is_kernel:
        return [law for name, value in damper.parameters.items() for law in _constants(name, value)]
    one, orders, row = damper.kernel_row()
    values = np.split(row[: -len(RIG)], np.cumsum(orders)[:-1])
    return [
        Law(known.name, known.unit, padded(found), known.min, known.max, known.text)
        for known, found in zip(one.parameters, values, strict=True)
    ]


def _constants(name: str, value: float | Sequence[float]) -> list[Law]:
    if name == "stroke_m":
        return []
    values = np.atleast_1d(np.asarray(value, float))
    names = [name] if np.ndim(value) == 0 else [f"{name}{k}" for k in range(len(values))]
    return [
        Law(one, "", padded([found]), -WIDEST, WIDEST, "constant")
        for one, found in zip(names, values, strict=True)
    ]


def padded(values: Sequence[float] | np.ndarray) -> tuple[float, float, float]:
    first, second, third = [*map(float, values), 0.0, 0.0][:3]
    return first, second, third


def field_of(damper: DamperModel) -> list[float]:
    """Exponent (0: no field law), saturation and reference of field_law.h."""
    return [float(damper.rig.get(name, 0.0)) for name in FIELD]
