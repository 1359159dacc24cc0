"""The plant in the recording."""

from pathlib import Path
from typing import Any

import tomli_w

from quiesce.commission.simulated import bare
from quiesce.commission.work import FOUND, RECORDING, Work
from quiesce.plant_id.find import find_plant

NAME = "find"
TITLE = "find the plant"
BARE_BASE = "base_without_damper.toml"


def run(work: Work) -> dict[str, Any]:
    wants = work.wants
    found = find_plant(
        work.path / f"{RECORDING}.csv",
        work.path / FOUND,
        base_of(work),
        wants.modal_mass_kg,
        not wants.is_damper_elsewhere,
        wants.mode_count,
        work.tell,
    )
    values = found.fit.values
    count = sum(1 for key in values if key.endswith("_freq_Hz"))
    return {
        "modes_Hz": [float(values[f"mode{i}_freq_Hz"]) for i in range(1, count + 1)],
        "damping_ratios": [float(values[f"mode{i}_damping_ratio"]) for i in range(1, count + 1)],
        "misfit": float(found.fit.misfit),
        "warnings": list(found.warnings),
    }


def base_of(work: Work) -> Path:
    """Without a damper where it was off while this was recorded."""
    if work.result("excite").get("has_damper", work.wants.damper is None):
        return work.base_plant
    file = work.path / BARE_BASE
    file.write_text(tomli_w.dumps(bare(work.base_plant)), encoding="utf-8")
    return file


def line(result: dict[str, Any]) -> str:
    modes = ", ".join(
        f"{freq_Hz:.4g} Hz ({100 * ratio:.2g} %)"
        for freq_Hz, ratio in zip(result["modes_Hz"], result["damping_ratios"], strict=True)
    )
    doubts = f"; {len(result['warnings'])} warnings" if result["warnings"] else ""
    return f"modes at {modes}; misfit {result['misfit']:.2g} times the noise{doubts}"
