"""Damper files (schema quiesce-damper): what identification writes and plants read."""

import tempfile
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown
from quiesce.damper.library import FIELD, RIG, DamperFile, Model, models

SCHEMA = "quiesce-damper"
VERSION = 1
_FIELD_KEYS = tuple(zip(("exponent", "saturation", "reference_A"), FIELD, strict=True))


@dataclass(frozen=True)
class DamperModel:
    """A damper model with its values. parameters: for a kernel coefficients against the current,
    ascending; for a learned model whatever its own reader wants."""

    name: str
    model: str
    stroke_m: float
    speed_m_s: float
    parameters: Mapping[str, Any]
    rig: Mapping[str, float] = field(default_factory=dict)  # values of RIG that are not 0
    source: Mapping[str, Any] | str = field(default_factory=dict)
    valid: Mapping[str, Any] = field(default_factory=dict)
    fit: Mapping[str, Any] = field(default_factory=dict)
    thermal: Mapping[str, float] = field(default_factory=dict)  # [thermal], checked by the library

    @property
    def is_kernel(self) -> bool:
        """Runs by the library's rows, which know no temperature."""
        return self.model in models() and not self.thermal

    def kernel_row(self) -> tuple[Model, list[int], np.ndarray]:
        """Model, orders and the library's row, rig included."""
        one = models()[self.model]
        # What a file may leave out is a factor or an exponent of 1.
        values = [self.parameters.get(p.name, 1.0) for p in one.parameters]
        laws = [np.atleast_1d(np.asarray(value, float)) for value in values]
        rig = [float(self.rig.get(name, 0.0)) for name in RIG]
        return one, [len(law) for law in laws], np.concatenate([*laws, rig])

    @property
    def field_table(self) -> dict[str, float]:
        """[field] of a file; empty where there is no field law."""
        if not self.rig.get("field_exponent"):
            return {}
        return {key: float(self.rig.get(name, 0.0)) for key, name in _FIELD_KEYS}

    def to_toml(self) -> str:
        table: dict[str, Any] = {
            "schema": SCHEMA,
            "version": VERSION,
            "name": self.name,
            "model": self.model,
            "stroke_m": self.stroke_m,
            "speed_m_s": self.speed_m_s,
            "source": self.source if isinstance(self.source, str) else dict(self.source),
            "valid": dict(self.valid),
            "parameters": dict(self.parameters),
        }
        lags = {key: self.rig[key] for key in ("rise_s", "fall_s") if self.rig.get(key)}
        if lags:
            table["coil"] = {"rise_s": 0.0, "fall_s": 0.0} | lags
        if self.field_table:
            table["field"] = self.field_table
        table["thermal"] = dict(self.thermal)
        others = {key: self.rig[key] for key in RIG if self.rig.get(key)}
        others = {key: value for key, value in others.items() if key not in (*lags, *FIELD)}
        for key, value in (("rig", others), ("fit", dict(self.fit))):
            if value:
                table[key] = value
        return tomli_w.dumps({key: value for key, value in table.items() if value not in ({}, "")})


def from_row(
    one: Model,
    orders: Sequence[int],
    row: np.ndarray,
    name: str,
    stroke_m: float,
    speed_m_s: float,
    **more: Any,
) -> DamperModel:
    """A kernel's row as a damper model; `more`: source, valid, fit."""
    parameters: dict[str, Any] = {}
    first = 0
    for parameter, order in zip(one.parameters, orders, strict=True):
        values = [float(value) for value in row[first : first + order]]
        parameters[parameter.name] = values[0] if order == 1 else values
        first += order
    rig = {key: float(value) for key, value in zip(RIG, row[first:], strict=True) if value}
    return DamperModel(name, one.name, stroke_m, speed_m_s, parameters, rig, **more)


def write_model(file: Path, damper: DamperModel) -> None:
    with output_files(file.parent) as staging:
        (staging / file.name).write_text(damper.to_toml(), encoding="utf-8")


def opened(damper: DamperModel) -> DamperFile:
    """A model that is in no file yet, in the library."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "damper.toml"
        file.write_text(damper.to_toml(), encoding="utf-8")
        return DamperFile(file)


def model_of_text(text: str, where: str) -> DamperModel:
    """A damper file's text that stands elsewhere. UsageError with `where` and key."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "damper.toml"
        file.write_text(text, encoding="utf-8")
        try:
            return read_model(file)
        except UsageError as error:
            raise UsageError(str(error).replace(str(file), where)) from None


def read_model(file: Path) -> DamperModel:
    """UsageError with file and key where it is wrong; the library checks the parameters."""
    DamperFile(file)
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise UsageError(f"{shown(file)}: {one_line(error)}") from None
    rig = {key: float(value) for key, value in table.get("rig", {}).items() if key in RIG}
    coil = table.get("coil", {})
    rig |= {key: float(coil[key]) for key in ("rise_s", "fall_s") if key in coil}
    field_law = table.get("field", {})
    rig |= {name: float(field_law[key]) for key, name in _FIELD_KEYS if key in field_law}
    keys = table.get("parameters", {})
    return DamperModel(
        table["name"],
        table["model"],
        # Springs have it among their parameters.
        float(table.get("stroke_m", keys.get("stroke_m", 0.0))),
        float(table.get("speed_m_s", 0.0)),
        keys,
        rig,
        table.get("source", {}),
        table.get("valid", {}),
        table.get("fit", {}),
        table.get("thermal", {}),
    )
