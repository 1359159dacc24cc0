"""Plants that differ from a plant file in a few ways, written as plant files of their own."""

import copy
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w

from quiesce.base.errors import UsageError, one_line
from quiesce.base.matrix_file import with_own_matrices
from quiesce.base.paths import shown
from quiesce.plant.damper import require_one_damper, scale_force, with_own_damper
from quiesce.plant.library import SAFE_PART, Plant, USUAL_STEP_us


@dataclass(frozen=True)
class Variant:
    """What to change; the defaults change nothing."""

    rise_s: float | None = None  # of the coil
    fall_s: float | None = None  # None: as rise_s where that is given
    force: float = 1.0  # factor of the damper's force
    freq: float = 1.0  # factor of all natural frequencies, damping ratios kept
    drive_V: float | None = None

    @property
    def name(self) -> str:
        """Short and usable in a file name: lag5ms_force1_drive0.1V_freq1, what changed only."""
        parts = []
        if self.rise_s is not None:
            parts.append(f"lag{1e3 * self.rise_s:g}ms")
        if self.fall_s is not None:
            parts.append(f"fall{1e3 * self.fall_s:g}ms")
        if self.force != 1.0:
            parts.append(f"force{self.force:g}")
        if self.drive_V is not None:
            parts.append(f"drive{self.drive_V:g}V")
        if self.freq != 1.0:
            parts.append(f"freq{self.freq:g}")
        return "_".join(parts) or "nominal"


def read_plant_data(file: Path) -> dict[str, Any]:
    """The file's TOML, with its damper file's contents in place of its name; the plant library
    checks what is in it."""
    try:
        data = tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name a plant file")
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{shown(file)}: not a TOML file: {one_line(error)}")
    require_one_damper(data, file)
    if isinstance(data.get("structure"), dict):
        data["structure"] = with_own_matrices(data["structure"], file.parent)
    return with_own_damper(_with_whole_paths(data, file.parent), file.parent)


def _with_whole_paths(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Sensor files by their whole paths, so that the plant may be written elsewhere."""
    out = copy.deepcopy(data)
    sensors = out.get("sensors")
    wired = list(sensors.values()) if isinstance(sensors, dict) else []
    for one in [out.get("sensor"), *wired]:
        if isinstance(one, dict) and isinstance(one.get("file"), str):
            one["file"] = str((folder / one["file"]).resolve())
    return out


def changed(data: dict[str, Any], variant: Variant) -> dict[str, Any]:
    """A copy of a valid plant's data with the variant's changes."""
    out = copy.deepcopy(data)
    if variant.force != 1.0:
        scale_force(out["damper"], variant.force)
    _scale_frequencies(out["structure"], variant.freq)
    if variant.rise_s is not None:
        out["coil"] = {**out["coil"], "rise_s": variant.rise_s, "fall_s": variant.rise_s}
    if variant.fall_s is not None:
        out["coil"]["fall_s"] = variant.fall_s
    if variant.drive_V is not None:
        out["shaker"]["drive_V"] = variant.drive_V
    if variant.name != "nominal":
        out["name"] = f"{data['name']} {variant.name}"
    return out


def write_variant(plant: Path, variant: Variant, file: Path) -> None:
    data = changed(read_plant_data(plant), variant)
    if variant.force > 1.0 or variant.freq > 1.0:
        data = _with_short_steps(data, file)
    file.write_text(tomli_w.dumps(data), encoding="utf-8")


def _with_short_steps(data: dict[str, Any], file: Path) -> dict[str, Any]:
    """Faster than the plant that it is made from, it may not go with that one's steps."""
    step_us = data.get("integration", {}).get("max_step_us", USUAL_STEP_us)
    file.write_text(tomli_w.dumps({**data, "integration": {"max_step_us": 1.0}}), encoding="utf-8")
    safe_us = 1e6 * Plant(file).safe_step_s
    if step_us <= safe_us:
        return data
    return {**data, "integration": {"max_step_us": SAFE_PART * safe_us}}


def _scale_frequencies(structure: dict[str, Any], factor: float) -> None:
    """All natural frequencies times factor, with the same damping ratios and shapes."""
    if factor == 1.0:
        return
    for mode in structure.get("mode", []):
        mode["freq_Hz"] *= factor
    for key, power in (("stiffness_N_m", 2), ("damping_N_s_m", 1)):
        if key in structure:
            structure[key] = [[value * factor**power for value in row] for row in structure[key]]
