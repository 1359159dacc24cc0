"""From estimated parameters to a plant file, with the rest taken from a base plant.

A recording of drive and acceleration fixes ratios only. The scale is set by the modal mass at the
sensor, and the damper's geometry, viscosity and yield stress are the base plant's: they relabel
force_scale and viscosity_ratio, which are estimated.
"""

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.plant.damper import require_one_damper

# Of the damper model squeeze_biviscosity: from the base plant, not from the recording.
ASSUMED_DAMPER_KEYS = ("plate_radius_m", "gap_m", "viscosity_Pa_s", "coil_turns", "coil_radius_m")
# An integration step is at most this long and this angle of the fastest mode: the first for trials
# and the plant file, the second, within 1e-6 in frequency, for what is fitted to the last digit.
STEP_us = 500.0
COARSE_rad = 0.3
FINE_rad = 0.1
# Part of what the plant's fastest motion allows that a step may take (plant_model.cpp: 0.9).
SAFE_PART = 0.8


@dataclass(frozen=True)
class Base:
    """What a recording cannot tell."""

    file: Path
    table: dict[str, Any]
    modal_mass_kg: float  # of the first mode, for a shape of 1 at the sensor
    ref_current_A: float  # the largest that was recorded
    is_damper_at_sensor: bool

    @property
    def damper(self) -> dict[str, Any]:
        return self.table["damper"]

    @property
    def model(self) -> str:
        return self.damper["model"]

    @property
    def ref_freq_Hz(self) -> float:
        return float(self.table["shaker"].get("ref_freq_Hz", 10.0))

    @property
    def field_per_A(self) -> float:
        return self.damper["coil_turns"] / (2.0 * math.pi * self.damper["coil_radius_m"])

    @property
    def yield_Pa(self) -> float:
        """Yield stress at the largest recorded current: assumed, force_scale goes with it."""
        exponent = float(self.damper.get("yield_exponent", 1.0))
        field = self.field_per_A * self.ref_current_A
        return self.damper["yield_coefficient"] * field**exponent

    def yield_force_N(self, force_scale: float) -> float:
        """Damper force far beyond yield at the largest recorded current (Bingham limit)."""
        damper = self.damper
        plates = 2.0 * math.pi * damper["plate_radius_m"] ** 3 / (3.0 * damper["gap_m"])
        return force_scale * plates * self.yield_Pa

    def yield_velocity_m_s(self, viscosity_ratio: float) -> float:
        """Velocity at which the film yields at the largest recorded current."""
        damper = self.damper
        wall = 3.0 * damper["viscosity_Pa_s"] * damper["plate_radius_m"]
        return viscosity_ratio * damper["gap_m"] ** 2 * self.yield_Pa / wall

    def zero_field_N_s_m(self, force_scale: float) -> float:
        """Damper coefficient without current."""
        damper = self.damper
        film = 1.5 * math.pi * damper["viscosity_Pa_s"] * damper["plate_radius_m"] ** 4
        return force_scale * film / damper["gap_m"] ** 3


def read_base(
    file: Path, modal_mass_kg: float, ref_current_A: float, is_damper_at_sensor: bool
) -> Base:
    """The file must be a valid plant (Plant(file) tells); here only TOML is read."""
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UsageError(f"{shown(file)}: {error}")
    require_one_damper(table, file)
    if ref_current_A > float(table["driver"]["max_current_A"]):
        raise UsageError(
            f"{shown(file)}: driver.max_current_A = {table['driver']['max_current_A']} A, but "
            f"{ref_current_A:g} A were recorded; name a base plant with your driver's range"
        )
    # A recording without current leaves the base plant's damper as it is.
    ref_current_A = ref_current_A or float(table["driver"]["max_current_A"])
    return Base(file, table, modal_mass_kg, ref_current_A, is_damper_at_sensor)


def modal_shapes(base: Base, values: dict[str, float], count: int) -> list[dict[str, float]]:
    """Frequency, damping and shapes of each mode, as a plant file has them."""
    at_sensor_1 = 1.0 / math.sqrt(base.modal_mass_kg)
    gain_N_V = values["mode1_residue_m_s2_V"] / at_sensor_1**2
    modes = []
    for i in range(1, count + 1):
        at_sensor = at_sensor_1 * values.get(f"mode{i}_shape_ratio", 1.0)
        at_damper = at_sensor
        if not base.is_damper_at_sensor:
            at_damper = at_sensor_1 * values.get(f"mode{i}_damper_ratio", 1.0)
        modes.append(
            {
                "freq_Hz": values[f"mode{i}_freq_Hz"],
                "damping_ratio": values[f"mode{i}_damping_ratio"],
                "at_force": values[f"mode{i}_residue_m_s2_V"] / (at_sensor * gain_N_V),
                "at_damper": at_damper,
                "at_sensor": at_sensor,
            }
        )
    return modes


def damper_section(base: Base, values: dict[str, float]) -> dict[str, Any]:
    if base.model == "viscous":
        return {
            "model": "viscous",
            "base_N_s_m": values["base_N_s_m"],
            "per_A_N_s_m": values["per_A_N_s_m"],
            "stroke_m": base.damper["stroke_m"],
        }
    exponent = values["yield_exponent"]
    section = {"model": base.model, **{key: base.damper[key] for key in ASSUMED_DAMPER_KEYS}}
    if "min_gap_m" in base.damper:
        section["min_gap_m"] = base.damper["min_gap_m"]
    section["viscosity_ratio"] = values["viscosity_ratio"]
    field = base.field_per_A * base.ref_current_A
    section["yield_coefficient"] = base.yield_Pa / field**exponent
    section["yield_exponent"] = exponent
    section["force_scale"] = values["force_scale"]
    return section


def no_current_N_s_m(base: Base, values: dict[str, float]) -> float:
    """The damper's coefficient without current."""
    if base.model == "viscous":
        return values["base_N_s_m"]
    return base.zero_field_N_s_m(values["force_scale"])


def stiffest_N_s_m(base: Base, values: dict[str, float]) -> float:
    if base.model == "viscous":
        full_A = float(base.table["driver"]["max_current_A"])
        return values["base_N_s_m"] + values["per_A_N_s_m"] * full_A
    return base.zero_field_N_s_m(values["force_scale"]) / values["viscosity_ratio"]


def step_us(
    base: Base, values: dict[str, float], modes: list[dict[str, float]], angle_rad: float
) -> float:
    """An integration step that follows the fastest motion."""
    omega = 2.0 * np.pi * np.array([mode["freq_Hz"] for mode in modes])
    damping = 2.0 * np.array([mode["damping_ratio"] for mode in modes]) * omega
    shape2 = sum(mode["at_damper"] ** 2 for mode in modes)
    rate = omega.max() + np.linalg.norm(damping) + shape2 * stiffest_N_s_m(base, values)
    return float(max(1.0, min(STEP_us, 1e6 * angle_rad / omega.max(), SAFE_PART * 0.9e6 / rate)))


def plant_table(
    base: Base,
    values: dict[str, float],
    name: str,
    drive_V: float,
    angle_rad: float = COARSE_rad,
) -> dict[str, Any]:
    """A plant file as nested tables. values: by parameter name, see fit.py."""
    count = sum(1 for key in values if key.endswith("_freq_Hz"))
    modes = modal_shapes(base, values, count)
    at_sensor_1 = modes[0]["at_sensor"]
    return {
        "schema": "quiesce-plant",
        "version": 1,
        "name": name,
        "structure": {"kind": "modes", "mode": modes},
        "damper": damper_section(base, values),
        "driver": base.table["driver"],
        "coil": {"rise_s": values["rise_s"], "fall_s": values["fall_s"]},
        "shaker": {
            "gain_N_V": values["mode1_residue_m_s2_V"] / at_sensor_1**2,
            "ref_freq_Hz": base.ref_freq_Hz,
            "corner_Hz": values.get("corner_Hz", 0.0),
            "drive_V": drive_V,
        },
        "sensor": {**base.table["sensor"], "noise_mg": values["noise_mg"]},
        "integration": {"max_step_us": step_us(base, values, modes, angle_rad)},
    }


def toml_value(value: Any) -> str:
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return repr(float(value)) if isinstance(value, (float, np.floating)) else str(int(value))


def plant_text(table: dict[str, Any], head: list[str], notes: dict[str, str]) -> str:
    """TOML of a plant_table. head: comment lines; notes: comments by 'section.key'."""
    lines = [f"# {line}".rstrip() for line in head]

    def write(section: str, entries: dict[str, Any]) -> None:
        for key, value in entries.items():
            note = notes.get(f"{section}.{key}", "")
            lines.append(f"{key} = {toml_value(value)}" + (f"  # {note}" if note else ""))

    write("", {key: value for key, value in table.items() if not isinstance(value, dict)})
    for section, entries in table.items():
        if not isinstance(entries, dict):
            continue
        lines += ["", f"[{section}]"]
        write(section, {key: value for key, value in entries.items() if key != "mode"})
        for number, mode in enumerate(entries.get("mode", []), 1):
            lines += ["", f"[[{section}.mode]]"]
            write(f"{section}.mode{number}", mode)
    return "\n".join(lines) + "\n"
