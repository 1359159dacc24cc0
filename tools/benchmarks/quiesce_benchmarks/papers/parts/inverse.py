"""Review of MR dampers, eqs 35, 37, 38: inverses of a damper in force tracking.

The damper is that of the plant with a suspended mass, with that plant's coil; beside it, reported
only, one with hysteresis and a driver's lag. Each inverse is made from the damper's own file (map,
steps) or from recordings made with it, 1 % noise on the force (ffn, rnn, anfis), and judged on
wanted forces of kinds that no training has. No reading of the papers has numbers to compare with.
"""

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

from quiesce.base.paths import default_plant
from quiesce.base.table import format_table
from quiesce.damper.inverses.demand import Source
from quiesce.damper.inverses.excited import TESTS, excited
from quiesce.damper.inverses.made import made, to_compare
from quiesce.damper.inverses.methods import METHODS
from quiesce.damper.inverses.tracking import CONSTANT, IDEAL, Compared, DURATION_s, compare
from quiesce.damper.model_file import DamperModel, read_model
from quiesce.damper.report.tracking import error_table, numbers_of
from quiesce.damper.simulate import simulator

from quiesce_benchmarks.part import Effort, Measured

TITLE = "inverses of a damper in force tracking (review, eqs 35, 37, 38)"
FIGURE = "inverse_tracking_error_pct"
FIGURES = (
    (FIGURE, "%", None, "lower"),
    *((f"{FIGURE}_{name}", "%", None, "lower") for name in (*METHODS, CONSTANT, IDEAL)),
)
PLANT = "suspended_mass.toml"
PLANT_MOST_A = 1.5  # to which the damper was tested
OTHER = "spencer_prototype.toml"
OTHER_MOST_A = 2.25  # V, in that file
QUICK_s = 3.0


def plant_damper(plants: Path) -> DamperModel:
    """The plant's damper with the plant's coil."""
    plant = tomllib.loads((plants / PLANT).read_text(encoding="utf-8"))
    damper = read_model(plants / plant["damper"]["file"])
    return replace(damper, rig={**damper.rig, **plant.get("coil", {})})


def compared(damper: DamperModel, most_A: float, effort: Effort) -> tuple[Compared, dict[str, Any]]:
    simulate = simulator(damper)
    tests = 2 if effort.is_quick else TESTS
    source = Source(excited(damper, simulate, most_A, effort.seed, tests), most_A, damper)
    inverses = made(source, list(METHODS), effort.seed)
    duration_s = QUICK_s if effort.is_quick else DURATION_s
    found = compare(damper, simulate, to_compare(inverses), most_A, effort.seed, duration_s)
    return found, {"damper": damper.name, **numbers_of(inverses, found)}


def measure(effort: Effort) -> Measured:
    """`inverse_tracking_error_pct` is the worst of the methods."""
    plants = default_plant().parent
    found, reported = compared(plant_damper(plants), PLANT_MOST_A, effort)
    errors = found.errors_pct()
    values: dict[str, float | None] = {FIGURE: max(errors[name] for name in METHODS)}
    values |= {f"{FIGURE}_{name}": errors[name] for name in (*METHODS, CONSTANT, IDEAL)}
    tables = [titled(f"Force tracking, {reported['damper']}", found)]
    numbers = {"plant": reported}
    if not effort.is_quick:
        other, numbers["other"] = compared(
            read_model(plants.parent / "dampers" / OTHER), OTHER_MOST_A, effort
        )
        tables.append(titled(f"Force tracking, {numbers['other']['damper']}", other))
    return Measured(values, numbers, tuple(tables))


def titled(title: str, found: Compared) -> str:
    return f"{title}\n{format_table(*error_table(found), left=(0,))}"
