"""The damper of a plant file as data: from a damper file, and with another force."""

import tomllib
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown

# Keys of models that are not kernels, which the force is proportional to.
FORCE_KEYS = ("force_scale", "base_N_s_m", "per_A_N_s_m", "base_N_m", "per_A_N_m", "area_m2")
LEARNED_FORCE_KEYS = ("force_scale_N", "consequents_N")
DAMPER_KEYS = ("model", "stroke_m", "speed_m_s", "field", "parameters", "thermal")


def require_one_damper(data: dict[str, Any], file: Path) -> None:
    """UsageError for a plant whose dampers have names and ends: [[damper]]."""
    if isinstance(data.get("damper"), list):
        raise UsageError(
            f"{shown(file)}: its dampers have names and ends ([[damper]]); this works on plants "
            "with one plain [damper]"
        )


def with_own_damper(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A plant's data with the contents of its damper file, if it names one, in place of the name:
    the same plant, wherever it is written. UsageError where the file cannot be read."""
    name = data.get("damper", {}).get("file")
    if not isinstance(name, str):
        return data
    file = folder / name
    try:
        damper = tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name a damper file") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{shown(file)}: not a TOML file: {one_line(error)}") from None
    coil = {"coil": damper["coil"]} if "coil" in damper else {}
    own = {key: damper[key] for key in DAMPER_KEYS if key in damper}
    own |= {key: data["damper"][key] for key in ("ratio",) if key in data["damper"]}
    return {**coil, **data, "damper": own}


def scale_force(damper: dict[str, Any], factor: float) -> None:
    """Multiplies a valid damper's force by this. UsageError where its model has no such factor."""
    keys = damper.get("parameters", damper)
    names = force_names(damper["model"])
    if damper["model"] == "squeeze_biviscosity":
        keys.setdefault("force_scale", 1.0)
    if "base" in keys or not any(name in keys for name in names):
        raise UsageError(
            f"the force of the damper model {damper['model']} cannot be varied; --robustness none"
        )
    for name in names:
        if name in keys:
            value = keys[name]
            is_list = isinstance(value, list)
            keys[name] = [factor * one for one in value] if is_list else factor * value


def force_names(model: str) -> tuple[str, ...]:
    """Parameters that the force is proportional to, all taken together: of a kernel those with a
    force in their natural size."""
    if model in ("squeeze_biviscosity", "viscous", "switched_stiffness", "elastomer"):
        return FORCE_KEYS
    from quiesce.damper.library import models

    if model in models():
        return tuple(one.name for one in models()[model].parameters if one.scale[0] == 1)
    return LEARNED_FORCE_KEYS
