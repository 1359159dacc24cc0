"""A fit as a least-squares problem over variables, evaluated for many candidates at once.

A variable is a parameter's value at one node of the current, or a value of the rig. Forces are
linear in some of them (Parameter.is_linear, and the rig's mass, offset and drift): those follow
from the others by a small least-squares problem with bounds (variable projection), so that a
search sees the others only.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment, records_in
from quiesce.damper.fit.bounded import bounded_least_squares
from quiesce.damper.fit.setting import Setting, law_matrix
from quiesce.damper.library import RIG, Scales

# The rig's values: natural size, search range in it, and whether the force is linear in it.
_RIG_LINEAR = {"inertia_kg", "offset_N", "drift_N_s"}
_RIG_SEARCH = {
    "rise_s": (1e-4, 0.1),
    "fall_s": (1e-4, 0.1),
    "skew_s": (-0.01, 0.01),
    "field_exponent": (0.6, 6.0),
    "field_saturation": (0.02, 20.0),
}
_RIG_BOUNDS = {
    "rise_s": (1e-6, 2.0),
    "fall_s": (1e-6, 2.0),
    "skew_s": (-0.05, 0.05),
    "inertia_kg": (0.0, 1e9),
    "field_exponent": (0.3, 12.0),
    "field_saturation": (1e-4, 100.0),
}

# Searched logarithmically: positive ranges wider than this.
_LOG_RATIO = 8.0
# How far beyond its search range a nonlinear variable may move while it is polished.
_ROOM = 30.0
# Substeps a sample at most while searching; stiffer candidates are cut off there.
SEARCH_SUBSTEPS = 16
# The same while polishing: stiffer ones are cut off beyond what is stable, and so refused.
FIT_SUBSTEPS = 64
# Time constants of a model below this part of a sampling interval cannot be told from zero.
_FASTEST = 0.1
# Numbers that one evaluation may hold: candidates times samples.
_CHUNK = 4_000_000


@dataclass(frozen=True)
class Variable:
    name: str  # parameter or rig name, "@0.5A" behind it where there are several nodes
    unit: str
    slot: int  # parameter index, or count of parameters + index in RIG
    node: int
    search: tuple[float, float]
    bounds: tuple[float, float]
    is_linear: bool
    is_log: bool
    natural: float  # its size

    def to_value(self, part: np.ndarray) -> np.ndarray:
        """Search coordinate 0 .. 1 to value."""
        low, high = self.search
        if self.is_log:
            return low * (high / low) ** part
        return low + (high - low) * part

    def to_part(self, value: np.ndarray) -> np.ndarray:
        low, high = self.search
        if self.is_log:
            return np.log(np.maximum(value, 1e-300) / low) / np.log(high / low)
        return (value - low) / (high - low)


class Problem:
    """The model of `setting` against the segments. Values are SI; `values` arrays are
    [candidates, variables]. Every record counts the same (`weigh` "test": errors relative to its
    own force) or every sample does ("sample")."""

    def __init__(self, setting: Setting, segments: Sequence[Segment], weigh: str = "test") -> None:
        self.setting = setting
        self.segments = trimmed(segments)
        self.scales = Scales.of(self.segments)
        self.records = records_in(self.segments)
        self._motions = {id(record): library.motion(record) for record in self.records}
        fastest_s = _FASTEST / max(record.rate_Hz for record in self.records)
        self.variables = variables_of(setting, self.scales, fastest_s)
        self.nonlinear = [k for k, one in enumerate(self.variables) if not one.is_linear]
        self.linear = [k for k, one in enumerate(self.variables) if one.is_linear]
        self.orders = setting.orders
        self._law = law_matrix(setting.nodes_A)
        self._weights = weights_of(self.segments, weigh)
        self.target = self._scored(
            {id(record): record.force_N[None, :] for record in self.records}
        )[0]
        self.size = float(np.sqrt(np.sum(self.target**2)))
        self.evaluations = 0

    @property
    def model(self) -> library.Model:
        return self.setting.model

    def values_from(self, parts: np.ndarray) -> np.ndarray:
        """Variables from search coordinates [candidates, nonlinear]; linear ones are 0."""
        out = np.zeros((len(parts), len(self.variables)))
        for j, k in enumerate(self.nonlinear):
            out[:, k] = self.variables[k].to_value(parts[:, j])
        return out

    def parts_of(self, values: np.ndarray) -> np.ndarray:
        """Search coordinates of the nonlinear variables, [candidates, nonlinear]."""
        parts = [self.variables[k].to_part(values[:, k]) for k in self.nonlinear]
        return np.stack(parts, axis=1)

    # Rows of the library

    def rows(self, values: np.ndarray) -> np.ndarray:
        """Rows of the library from values of the variables, [candidates, row length]."""
        values = np.atleast_2d(values)
        count = len(self.model.parameters)
        firsts = np.concatenate([[0], np.cumsum(self.orders)])
        out = np.zeros((len(values), firsts[-1] + len(RIG)))
        for name, value in self.setting.fixed.items():
            slot = RIG.index(name) + firsts[-1] if name in RIG else firsts[self.model.index(name)]
            out[:, slot] = value
        for slot, parameter in enumerate(self.model.parameters):
            order = self.orders[slot]
            if is_given(self.setting, slot, order - 1) and parameter.name not in self.setting.fixed:
                law = self._law[:, -1] if order > 1 else np.ones(1)
                value = parameter.search_low * parameter.natural(self.scales)
                out[:, firsts[slot] : firsts[slot] + order] += value * law
        for k, one in enumerate(self.variables):
            if one.slot >= count:
                out[:, firsts[-1] + one.slot - count] = values[:, k]
                continue
            first, order = firsts[one.slot], self.orders[one.slot]
            law = self._law[:, one.node] if order > 1 else np.ones(1)
            out[:, first : first + order] += values[:, k, None] * law
        return out

    def simulate(self, values: np.ndarray, record: Record, finest: int = 0) -> np.ndarray:
        """Forces in N before any average, [candidates, samples]. Each candidate gets the steps that
        its own rates ask for, rounded up to a power of two, at most `finest` where given."""
        rows = self.rows(values)
        steps = self._steps(rows, record, finest)
        out = np.empty((len(rows), len(record)))
        for count in np.unique(steps):
            group = steps == count
            out[group] = library.simulate(
                self.model, self.orders, rows[group], self._motions[id(record)], int(count)
            )
        self.evaluations += len(rows)
        return out

    def _steps(self, rows: np.ndarray, record: Record, finest: int) -> np.ndarray:
        if self.model.states == 0:
            return np.ones(len(rows), dtype=int)
        rates = library.fastest_rates(self.model, self.orders, rows, record)
        needed = np.clip(
            rates / (library.STEP_RATE * record.rate_Hz), 1.0, finest or library.MAX_SUBSTEPS
        )
        return 2 ** np.ceil(np.log2(needed)).astype(int)

    def _scored(self, forces: dict[int, np.ndarray]) -> np.ndarray:
        """Weighted scored samples of all segments, side by side."""
        parts = [
            weight * forces[id(segment.record)][:, segment.rows]
            for segment, weight in zip(self.segments, self._weights, strict=True)
        ]
        return np.concatenate(parts, axis=1)

    def outputs(self, values: np.ndarray, finest: int = 0) -> np.ndarray:
        """Weighted model forces at all scored samples, [candidates, samples]."""
        forces = {}
        for record in self.records:
            simulated = self.simulate(values, record, finest)
            forces[id(record)] = averaged(record, simulated)
        return self._scored(forces)

    # Costs

    def project(self, values: np.ndarray, finest: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """Best linear variables for given nonlinear ones (the linear entries of `values` are not
        read): values with them, and relative errors ||F - F_model|| / ||F||, [candidates]."""
        values = np.array(np.atleast_2d(values), dtype=float)
        lanes = len(self.linear) + 1
        samples = sum(len(record) for record in self.records)
        most = max(1, _CHUNK // (lanes * samples))
        errors = np.empty(len(values))
        for first in range(0, len(values), most):
            chunk = slice(first, first + most)
            values[chunk], errors[chunk] = self._project_chunk(values[chunk], finest)
        return values, errors

    def _project_chunk(self, values: np.ndarray, finest: int) -> tuple[np.ndarray, np.ndarray]:
        count, linear = len(values), len(self.linear)
        values[:, self.linear] = 0.0
        unit = np.repeat(values[:, None, :], linear + 1, axis=1)
        sizes = np.array([self.variables[k].natural for k in self.linear])
        for j, k in enumerate(self.linear):
            unit[:, j + 1, k] = sizes[j]
        with np.errstate(all="ignore"):
            outputs = self.outputs(unit.reshape(-1, values.shape[1]), finest)
            outputs = outputs.reshape(count, linear + 1, -1)
            outputs[:, 1:] -= outputs[:, :1]
            return values, np.linalg.norm(self.solve_linear(values, outputs), axis=1)

    def solve_linear(self, values: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Writes the best linear variables into `values` and returns the residuals (model -
        measured) / ||measured||, [candidates, samples], infinite where a column diverges. columns:
        weighted outputs without the linear variables, then what each of them adds at its natural
        size, [candidates, 1 + linear, samples]."""
        # Beyond this a column diverges, and its square would overflow.
        finite = (np.abs(columns) < 1e100).all(axis=(1, 2))
        columns = np.where(finite[:, None, None], columns, 0.0)
        output, basis = columns[:, 0], columns[:, 1:]
        if self.linear:
            chosen = [self.variables[k] for k in self.linear]
            sizes = np.array([one.natural for one in chosen])
            low, high = np.array([one.bounds for one in chosen]).T / sizes
            amounts = bounded_least_squares(basis, self.target - output, low, high)
            values[:, self.linear] = amounts * sizes
            output = output + np.einsum("cl,cln->cn", amounts, basis)
        residuals = (output - self.target) / self.size
        residuals[~finite] = np.inf
        return residuals

    def residuals(self, values: np.ndarray) -> np.ndarray:
        """(model - measured) / ||measured||, weighted, [scored samples]."""
        return (self.outputs(values, FIT_SUBSTEPS)[0] - self.target) / self.size

    def error(self, values: np.ndarray) -> float:
        """||F - F_model|| / ||F|| over the scored samples, weighted."""
        return float(np.sqrt(np.sum(self.residuals(values) ** 2)))

    def jacobian(self, values: np.ndarray, steps: np.ndarray) -> np.ndarray:
        """Derivative of the residuals by each variable, from one-sided differences with these
        steps, [samples, variables]."""
        moved = np.repeat(values[None, :], len(values) + 1, axis=0)
        moved[np.arange(1, len(values) + 1), np.arange(len(values))] += steps
        samples = sum(len(record) for record in self.records)
        most = max(2, _CHUNK // samples)
        base = None
        columns = []
        for first in range(0, len(moved), most):
            outputs = self.outputs(moved[first : first + most], FIT_SUBSTEPS)
            base = outputs[0] if base is None else base
            columns.append(outputs)
        outputs = np.concatenate(columns)
        return ((outputs[1:] - outputs[0]) / steps[:, None]).T / self.size

    def difference_steps(self, values: np.ndarray) -> np.ndarray:
        """Steps for `jacobian` that stay inside the bounds."""
        out = np.empty(len(values))
        for k, one in enumerate(self.variables):
            size = abs(values[k]) if one.is_log else max(abs(values[k]), 1e-3 * one.natural)
            step = 1e-6 * size
            out[k] = -step if values[k] + step > one.bounds[1] else step
        return out


def trimmed(segments: Sequence[Segment]) -> list[Segment]:
    """The same rows, of records that end with the last one that is scored: what follows need not
    be simulated. A record whose force is averaged stays as it is."""
    ends: dict[int, int] = {}
    for one in segments:
        ends[id(one.record)] = max(ends.get(id(one.record), 0), one.end)
    cut: dict[int, Record] = {}
    for one in segments:
        key, end = id(one.record), ends[id(one.record)]
        if key not in cut:
            is_whole = end == len(one.record) or one.record.average_samples > 1
            cut[key] = one.record if is_whole else one.record.rows(0, end)
    return [Segment(cut[id(one.record)], one.first, one.end) for one in segments]


def averaged(record: Record, forces: np.ndarray) -> np.ndarray:
    """The record's moving average over each row."""
    if record.average_samples == 1:
        return forces
    return np.array([record.averaged(row) for row in forces])


def weights_of(segments: Sequence[Segment], weigh: str) -> list[float]:
    """A factor a segment on its residuals."""
    if weigh == "sample":
        return [1.0] * len(segments)
    norms = [
        float(np.sqrt(np.sum(segment.record.force_N[segment.rows] ** 2))) for segment in segments
    ]
    largest = max(norms)
    return [largest / max(norm, 1e-6 * largest) for norm in norms]


def variables_of(setting: Setting, scales: Scales, fastest_s: float) -> list[Variable]:
    """fastest_s: the shortest time constant that is looked for."""
    out = []
    for slot, parameter in enumerate(setting.model.parameters):
        if parameter.name in setting.fixed:
            continue
        search = parameter.search_range(scales)
        count = setting.orders[slot]
        for node in range(count):
            if is_given(setting, slot, node):
                continue
            suffix = f"@{setting.nodes_A[node]:g}A" if count > 1 else ""
            out.append(
                make_variable(
                    parameter.name + suffix,
                    parameter.unit,
                    slot,
                    node,
                    setting.bounds.get(parameter.name),
                    search,
                    (
                        max(parameter.min, fastest_s if parameter.unit == "s" else -np.inf),
                        parameter.max,
                    ),
                    parameter.is_linear,
                    parameter.natural(scales),
                )
            )
    for name in setting.rig:
        out.append(rig_variable(name, setting, scales))
    return out


def is_given(setting: Setting, slot: int, node: int) -> bool:
    """Whether a parameter's value at this node is not searched: its range is one point, and the
    node is the last, where such parameters (ratios) are normalised."""
    parameter = setting.model.parameters[slot]
    is_point = parameter.search_low == parameter.search_high
    last = setting.orders[slot] - 1
    return is_point and parameter.name not in setting.bounds and node == last


def rig_variable(name: str, setting: Setting, scales: Scales) -> Variable:
    natural = {
        "inertia_kg": scales.force_N * scales.disp_m / scales.speed_m_s**2,
        "offset_N": scales.force_N,
        "drift_N_s": scales.force_N * scales.speed_m_s / scales.disp_m,
        "skew_s": 1e-3,
        "rise_s": 1e-2,
        "fall_s": 1e-2,
        "field_exponent": 1.0,
        "field_saturation": 1.0,
    }[name]
    return make_variable(
        name,
        name.rsplit("_", 1)[1],
        len(setting.model.parameters) + RIG.index(name),
        0,
        setting.bounds.get(name),
        _RIG_SEARCH.get(name, (-natural, natural)),
        _RIG_BOUNDS.get(name, (-np.inf, np.inf)),
        name in _RIG_LINEAR,
        natural,
    )


def make_variable(
    name: str,
    unit: str,
    slot: int,
    node: int,
    given: tuple[float, float] | None,
    search: tuple[float, float],
    admissible: tuple[float, float],
    is_linear: bool,
    natural: float,
) -> Variable:
    bounds = admissible
    if search[0] == search[1]:  # a ratio: one at the last node, as far as that above others
        search = (0.01 * search[0], 1.5 * search[0])
    search = (max(search[0], admissible[0]), min(search[1], admissible[1]))
    if given is not None:
        bounds = (max(given[0], admissible[0]), min(given[1], admissible[1]))
        if not bounds[0] < bounds[1]:
            raise UsageError(
                f"bounds of {name}: nothing is left inside its admissible range "
                f"{admissible[0]:g} .. {admissible[1]:g} {unit}"
            )
        search = bounds
    is_log = not is_linear and search[0] > 0.0 and search[1] / search[0] >= _LOG_RATIO
    if given is None and is_log:
        bounds = (max(bounds[0], search[0] / _ROOM), min(bounds[1], search[1] * _ROOM))
    elif given is None and not is_linear:
        room = search[1] - search[0]
        bounds = (max(bounds[0], search[0] - room), min(bounds[1], search[1] + room))
    return Variable(name, unit, slot, node, search, bounds, is_linear, is_log, natural)
