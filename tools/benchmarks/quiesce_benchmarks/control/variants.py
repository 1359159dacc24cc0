"""Plants other than the one in the file: what `./tools/benchmark control` varies."""

import math
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w
from quiesce.plant.library import Plant as PlantLibrary
from quiesce.plant.variant import Variant, changed, read_plant_data

from quiesce_benchmarks.control.rig import Plant, Rig, read_plant

SWITCHED_STIFFNESS = 0.1


@dataclass(frozen=True)
class Variation:
    """Changes of a plant, and what to call it."""

    label: str
    variant: Variant = Variant()
    remanence: float = 0.0  # share of the field that remains without current


def goal_variation(lag_s: float, force: float, drive_V: float, freq: float) -> Variation:
    """lag_s: of the coil. force, freq: factors of the damper's force, of all frequencies."""
    modes = f"modes {100.0 * (freq - 1.0):+.0f} %"
    label = f"{1e3 * lag_s:g} ms, force x{force:g}, {drive_V:g} V, {modes}"
    return Variation(label, Variant(rise_s=lag_s, force=force, freq=freq, drive_V=drive_V))


def coil_variations(rise_s: float) -> list[Variation]:
    """Coils that the goals do not ask for."""
    falls = [
        Variation(f"coil falls in {ratio:g} x its rise", Variant(fall_s=ratio * rise_s))
        for ratio in (0.5, 2.0)
    ]
    return [*falls, Variation("5 % remanence", remanence=0.05)]


def varied_plant(rig: Rig, variation: Variation) -> Plant:
    """UsageError where the bench refuses it."""
    data = changed(read_plant_data(rig.plant.file), variation.variant)
    if variation.remanence:
        data["coil"]["remanence"] = variation.remanence
    return made_plant(rig, data, f"{variation.variant.name}_{variation.remanence:g}")


def switched_stiffness_plant(rig: Rig) -> Plant:
    """The same structure with a damper whose current switches a stiffness, too.

    Full current adds as much damping as the first mode has by itself, and SWITCHED_STIFFNESS of its
    stiffness.
    """
    data = changed(read_plant_data(rig.plant.file), Variant())
    first = PlantLibrary(rig.plant.file).modes[0]
    mass_kg = first.at_damper**-2  # of the mode, as the damper feels it
    omega_rad_s = 2.0 * math.pi * first.freq_Hz
    full_A = rig.plant.max_current_A
    data["damper"] = {
        "model": "switched_stiffness",
        "base_N_s_m": 0.0,
        "per_A_N_s_m": 2.0 * first.damping_ratio * omega_rad_s * mass_kg / full_A,
        "base_N_m": 0.0,
        "per_A_N_m": SWITCHED_STIFFNESS * omega_rad_s**2 * mass_kg / full_A,
        "stroke_m": data["damper"].get("gap_m") or data["damper"]["stroke_m"],
    }
    return made_plant(rig, data, "switched_stiffness")


def energy_plants(rig: Rig) -> dict[str, Plant]:
    """Those on which the damper's work is looked at, by name."""
    return {"as it is": rig.plant, "with switched stiffness": switched_stiffness_plant(rig)}


def made_plant(rig: Rig, data: dict[str, Any], name: str) -> Plant:
    """Written beside the run's other files."""
    file = rig.folder / f"plant_{name}.toml"
    write_whole(file, tomli_w.dumps(data))
    return read_plant(rig.bench, file)


def write_whole(file: Path, text: str) -> None:
    """Another thread never reads half of it."""
    with tempfile.NamedTemporaryFile("w", dir=file.parent, delete=False, encoding="utf-8") as part:
        part.write(text)
    Path(part.name).replace(file)
