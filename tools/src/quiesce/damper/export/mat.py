"""A damper model as a MAT file (version 5), with units and laws in words."""

import io
from collections.abc import Mapping
from typing import Any

import numpy as np

from quiesce.damper.command_range import command_kind, command_unit
from quiesce.damper.library import RIG, models
from quiesce.damper.model_file import DamperModel

LAW = "value = c0 + c1 i + c2 i^2; i: effective {} in {}; cut off at low and high"
RIG_UNITS = {
    "rise_s": "s", "fall_s": "s", "inertia_kg": "kg", "skew_s": "s", "offset_N": "N",
    "drift_N_s": "N/s", "field_exponent": "-", "field_saturation": "-", "field_ref_A": "A",
}  # fmt: skip


def mat_bytes(damper: DamperModel) -> bytes:
    """One struct `damper`: name, model, title, source, valid, fit, stroke_m, speed_m_s, rig, and
    parameters: for a kernel a struct each with value (coefficients), unit, low, high and text."""
    from scipy.io import savemat

    known = models().get(damper.model)
    table: dict[str, Any] = {
        "name": damper.name,
        "model": damper.model,
        "title": known.title if known else damper.model,
        "equations": known.source if known else "",
        "stroke_m": damper.stroke_m,
        "speed_m_s": damper.speed_m_s,
        "source": damper.source,
        "valid": damper.valid,
        "fit": damper.fit,
        "rig": {name: float(damper.rig.get(name, 0.0)) for name in RIG},
        "rig_units": {name: RIG_UNITS.get(name, "") for name in RIG},
        "parameters": parameters_of(damper),
        "law": LAW.format(command_kind(damper), command_unit(damper)) if known else "",
    }
    out = io.BytesIO()
    savemat(out, {"damper": storable(table)}, long_field_names=True, oned_as="row")
    return out.getvalue()


def parameters_of(damper: DamperModel) -> Mapping[str, Any]:
    known = models().get(damper.model)
    if known is None:
        return damper.parameters
    return {
        one.name: {
            "value": np.atleast_1d(np.asarray(damper.parameters[one.name], float)),
            "unit": one.unit,
            "low": one.min,
            "high": one.max,
            "text": one.text,
        }
        for one in known.parameters
    }


def storable(value: Any) -> Any:
    """What savemat takes: no empty structs, lists of tables as cells, valid field names."""
    if isinstance(value, Mapping):
        kept = {field_name(key): storable(one) for key, one in value.items()}
        return {key: one for key, one in kept.items() if not is_empty(one)} or ""
    if isinstance(value, bool):
        return np.bool_(value)
    if isinstance(value, list | tuple):
        if all(isinstance(one, int | float) and not isinstance(one, bool) for one in value):
            return np.asarray(value, dtype=float)
        cells = np.empty(len(value), dtype=object)
        for k, one in enumerate(value):
            cells[k] = storable(one)
        return cells
    if isinstance(value, int | float | np.ndarray):
        return value
    return str(value)


def is_empty(value: Any) -> bool:
    return isinstance(value, str | np.ndarray) and len(value) == 0


def field_name(key: str) -> str:
    name = "".join(c if c.isascii() and (c.isalnum() or c == "_") else "_" for c in str(key))
    return name[:63] if name[:1].isalpha() else f"x{name}"[:63]
