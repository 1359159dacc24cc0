"""The damper models of the C++ library (sim_hil/damper), over recorded motions.

A parameter set ("row") of a model is a vector: for every parameter its `orders[k]` coefficients
against the coil current (1 constant, 2 linear, 3 quadratic; ascending powers of A), then the values
of RIG. Rows are evaluated together, [count, length]; every candidate has the same bits alone and
in company, on every machine.
"""

import importlib.util
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import build_folder, how_to_build
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment

# Around every model, 0 where absent: time constants of a rising and a falling current (s), mass
# that moves with the force sensor (kg), time by which the force lags the motion (s), force at rest
# (N) and its change (N/s).
# Last the field law: exponent (0: none), saturation, and the current (A) at which the effective
# current is the current (sim_hil/damper/field_law.h).
RIG = (
    "rise_s",
    "fall_s",
    "inertia_kg",
    "skew_s",
    "offset_N",
    "drift_N_s",
    "field_exponent",
    "field_saturation",
    "field_ref_A",
)
FIELD = RIG[6:]

# Classical Runge-Kutta is stable below 2.78; this leaves it accurate.
STEP_RATE = 1.0
MAX_SUBSTEPS = 2000


@dataclass(frozen=True)
class Scales:
    """Largest force (N), displacement (m) and speed (m/s): the natural units of parameters."""

    force_N: float
    disp_m: float
    speed_m_s: float

    @staticmethod
    def of(segments: Sequence[Segment]) -> "Scales":
        """Of the segments' rows only: others may be held out."""
        return Scales(
            max(float(np.max(np.abs(one.record.force_N[one.rows]))) for one in segments),
            max(float(np.max(np.abs(one.record.disp_m[one.rows]))) for one in segments),
            max(float(np.max(np.abs(one.record.velocity_m_s[one.rows]))) for one in segments),
        )


@dataclass(frozen=True)
class Parameter:
    name: str
    unit: str
    min: float
    max: float
    search_low: float  # in multiples of the natural unit
    search_high: float
    scale: tuple[int, int, int]  # powers of force, displacement, speed
    is_linear: bool
    follows_current: bool
    text: str
    is_told: bool  # known of a damper, not found by a fit

    def natural(self, scales: Scales) -> float:
        """The size that one has in this parameter's unit."""
        force, disp, speed = self.scale
        return scales.force_N**force * scales.disp_m**disp * scales.speed_m_s**speed

    def search_range(self, scales: Scales) -> tuple[float, float]:
        natural = self.natural(scales)
        return (
            max(self.min, self.search_low * natural),
            min(self.max, self.search_high * natural),
        )


@dataclass(frozen=True)
class Model:
    name: str
    title: str
    source: str
    states: int
    uses_accel: bool
    parameters: tuple[Parameter, ...]

    @property
    def told(self) -> tuple[Parameter, ...]:
        """What has to be known of a damper before it can be fitted: geometry."""
        return tuple(one for one in self.parameters if one.is_told)

    def index(self, name: str) -> int:
        return [one.name for one in self.parameters].index(name)


@cache
def module() -> ModuleType:
    """The compiled module; UsageError where it has not been built."""
    files = sorted((build_folder() / "host/sim_hil/python").glob("quiesce_dampers*.so"))
    if not files:
        raise UsageError(f"the damper library is not built; {how_to_build()}")
    spec = importlib.util.spec_from_file_location("quiesce_dampers", files[0])
    if spec is None or spec.loader is None:
        raise UsageError(f"{files[0]} is not a Python module; delete it and build again")
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


@cache
def models() -> dict[str, Model]:
    """Every kernel of the library by name, in the library's order."""
    return {
        one["name"]: Model(
            one["name"],
            one["title"],
            one["source"],
            one["states"],
            one["uses_accel"],
            tuple(Parameter(**parameter) for parameter in one["parameters"]),
        )
        for one in module().models()
    }


def model(name: str) -> Model:
    """UsageError with the names that there are where there is no such model."""
    if name not in models():
        raise UsageError(f"no damper model '{name}'; there are {', '.join(models())}")
    return models()[name]


def motion(record: Record) -> Any:
    """The record's motion and command as the library wants them; reusable."""
    return module().Motion(
        record.rate_Hz,
        *(
            np.ascontiguousarray(values, dtype=float)
            for values in (record.disp_m, record.velocity_m_s, record.accel_m_s2, record.command)
        ),
    )


def values_at(one: Model, orders: Sequence[int], rows: np.ndarray, current_A: float) -> np.ndarray:
    """The model's parameters at this current, cut off at their admissible values: [parameters] for
    one row, [rows, parameters] for several."""
    rows = np.asarray(rows)
    columns = []
    first = 0
    for order in orders:
        value = np.zeros(rows.shape[:-1])
        for k in range(first + order - 1, first - 1, -1):
            value = value * current_A + rows[..., k]
        columns.append(value)
        first += order
    low = [parameter.min for parameter in one.parameters]
    high = [parameter.max for parameter in one.parameters]
    return np.clip(np.stack(columns, axis=-1), low, high)


def effective_A(rig: Mapping[str, float], current_A: float) -> float:
    """The current that parameters follow, of a coil current: the field law among RIG's values."""
    return module().effective_A(current_A, *(float(rig.get(name, 0.0)) for name in FIELD))


def substeps_for(rate_1_s: float, rate_Hz: float) -> int:
    """Integration steps a sample for states that change at this rate."""
    return int(np.clip(np.ceil(rate_1_s / (STEP_RATE * rate_Hz)), 1, MAX_SUBSTEPS))


def fastest_rates(
    one: Model, orders: Sequence[int], rows: np.ndarray, record: Record
) -> np.ndarray:
    """Fastest rate of each row's states (1/s) at the record's largest speed and its least and
    largest command: [rows]."""
    speed_m_s = float(np.max(np.abs(record.velocity_m_s)))
    currents_A = np.unique([record.command.min(), record.command.max()])
    rows = np.atleast_2d(rows)
    fastest = np.zeros(len(rows))
    rate_of = module().fastest_rate_1_s
    for current_A in currents_A:
        values = np.ascontiguousarray(values_at(one, orders, rows, float(current_A)))
        rates = [rate_of(one.name, row, speed_m_s) for row in values]
        fastest = np.maximum(fastest, rates)
    return fastest


def simulate(
    one: Model,
    orders: Sequence[int],
    rows: np.ndarray,
    record_motion: Any,
    steps: int,
    instruction_set: str = "",
) -> np.ndarray:
    """Forces in N at the samples, [rows, samples]; not finite where a row diverges."""
    rows = np.ascontiguousarray(np.atleast_2d(rows), dtype=float)
    return module().simulate(
        one.name, list(orders), rows, record_motion, int(steps), instruction_set
    )


def simulate_row(one: Model, orders: Sequence[int], row: np.ndarray, record: Record) -> np.ndarray:
    """Force in N of one row along a record, with the steps that its rates ask for: [samples]."""
    rate = float(fastest_rates(one, orders, row, record)[0]) if one.states else 0.0
    steps = substeps_for(rate, record.rate_Hz)
    return simulate(one, orders, row, motion(record), steps)[0]


def squared_error(
    one: Model,
    orders: Sequence[int],
    rows: np.ndarray,
    record_motion: Any,
    steps: int,
    force_N: np.ndarray,
    weight: np.ndarray,
    average_samples: int = 1,
    instruction_set: str = "",
) -> np.ndarray:
    """Weighted squared error of each row in N2, [rows], after the moving average that the
    measured force has been through."""
    rows = np.ascontiguousarray(np.atleast_2d(rows), dtype=float)
    return module().squared_error(
        one.name,
        list(orders),
        rows,
        record_motion,
        int(steps),
        np.ascontiguousarray(force_N, dtype=float),
        np.ascontiguousarray(weight, dtype=float),
        int(average_samples),
        instruction_set,
    )


class DamperFile:
    """A damper in a file (schema quiesce-damper), of any model of the library, as plants see it:
    without rig and coil lag."""

    def __init__(self, file: Path | str) -> None:
        """UsageError with file, line and key where the file is wrong."""
        try:
            self._damper = module().DamperFile(str(file))
        except ValueError as error:
            raise UsageError(one_line(error)) from None

    def simulate(self, record_motion: Any, steps: int) -> np.ndarray:
        """Forces in N at the motion's samples, at its command as the coil current."""
        return self._damper.simulate(record_motion, int(steps))

    def fastest_rate_1_s(self, current_A: float) -> float:
        """Bound of how fast the states change with this current."""
        return self._damper.fastest_rate_1_s(current_A)

    def substeps(self, record: Record) -> int:
        rate = max(
            self.fastest_rate_1_s(float(current_A))
            for current_A in (record.command.min(), record.command.max())
        )
        return substeps_for(rate, record.rate_Hz)
