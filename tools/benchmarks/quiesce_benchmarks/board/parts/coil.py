"""Steps of the current loop on simulated coils, beside what no loop could do better."""

import json
import subprocess
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import build_folder
from quiesce.base.table import format_table
from quiesce.engine.bench import ending, require_file

from quiesce_benchmarks.part import Effort, Measured

TITLE = "coil: full-scale steps of the current loop"
FIGURES = (
    ("current_step_ms_worst", "ms", 10.0, "lower"),
    ("current_step_bound_ms_worst", "ms", None, "lower"),
    ("current_step_beyond_bound_ms_worst", "ms", None, "lower"),
    ("current_overshoot_pct_worst", "%", 5.0, "lower"),
    ("current_steady_error_pct_worst", "%", 1.0, "lower"),
    ("current_coils_beyond_supply", "coils", None, "lower"),
)
TIMEOUT_s = 600


def steps() -> list[dict[str, Any]]:
    """A full-scale step of each coil and supply that the loop is for."""
    program = require_file(build_folder() / "host/tools/benchmarks/host/coil/coil_steps", "steps")
    done = subprocess.run([program], capture_output=True, text=True, timeout=TIMEOUT_s)
    if done.returncode != 0:
        raise BenchFailure(f"coil_steps ended with {ending(done.returncode)}")
    return [json.loads(line) for line in done.stdout.splitlines()]


def figures_of(found: list[dict[str, Any]]) -> dict[str, float | None]:
    """A coil that the supply does not drive to full scale has no step; it is counted."""
    possible = [one for one in found if one["is_possible"]]
    if not possible:
        raise BenchFailure("coil_steps found no coil that its supply drives to full scale")
    return {
        "current_step_ms_worst": max(one["step_ms"] for one in possible),
        "current_step_bound_ms_worst": max(one["bound_ms"] for one in possible),
        "current_step_beyond_bound_ms_worst": max(
            one["step_ms"] - one["bound_ms"] for one in possible
        ),
        "current_overshoot_pct_worst": max(one["overshoot_pct"] for one in possible),
        "current_steady_error_pct_worst": max(one["steady_pct"] for one in possible),
        "current_coils_beyond_supply": len(found) - len(possible),
    }


def row_of(one: dict[str, Any]) -> list[Any]:
    coil = [one["supply_V"], one["resistance_ohm"], one["inductance_mH"]]
    if not one["is_possible"]:
        return [*coil, "never", "never", "", ""]
    return [
        *coil,
        f"{one['step_ms']:.1f}",
        f"{one['bound_ms']:.1f}",
        f"{one['overshoot_pct']:.2f}",
        f"{one['steady_pct']:.4f}",
    ]


def measure(effort: Effort) -> Measured:
    found = steps()
    head = ["supply V", "ohm", "mH", "step ms", "at best ms", "overshoot %", "steady error %"]
    table = format_table(head, [row_of(one) for one in found])
    return Measured(figures_of(found), {"steps": found}, (table,))
