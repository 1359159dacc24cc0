"""Changes of current, temperature and damper: the adaptive model beside frozen ones."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from quiesce.base.table import format_table
from quiesce.damper.online import ADAPTIVE, FROZEN, LAST_FORCE, STOPPED, Followed, follow, stream_of
from quiesce.damper.simulate import simulator
from quiesce.damper.task import Plan

from quiesce_benchmarks.damper.one_set import records_of_test
from quiesce_benchmarks.damper.real import data_folder
from quiesce_benchmarks.papers.online_rig import Rig, recorded, test_of
from quiesce_benchmarks.part import Effort

TANH, BOUC_WEN = "rd1005_kwok_tanh_smooth", "rd1005_kwok_bouc_wen_soft"
SETTLE_s = 2.0
QUICK_s = 6.0
# On the measured damper.
MEASURED_A = ((0.5, 1.0), (1.0, 0.5))
# The model file of the damper that is there after the change: no fit to data before it.
PUBLISHED = "published file of what is there after"


@dataclass(frozen=True)
class Change:
    before: Rig
    before_A: float
    after: Rig
    after_A: float
    sine_Hz: float | None = None  # None: a chirp


# The rates of on-line use were found on chirps; no sine was looked at.
CHANGES = {
    "current up": Change(Rig(TANH), 0.5, Rig(TANH), 1.5),
    "current down": Change(Rig(TANH), 1.5, Rig(TANH), 0.5),
    "temperature": Change(Rig(TANH, 20.0), 1.0, Rig(TANH, 80.0), 1.0),
    "damper swapped": Change(Rig(TANH), 1.0, Rig(BOUC_WEN), 1.0),
    "swapped back": Change(Rig(BOUC_WEN), 1.0, Rig(TANH), 1.0),
    "current down, 2 Hz": Change(Rig(TANH), 1.5, Rig(TANH), 0.5, 2.0),
    "temperature, 2 Hz": Change(Rig(TANH, 20.0), 1.0, Rig(TANH, 80.0), 1.0, 2.0),
    "damper swapped, 2 Hz": Change(Rig(TANH), 1.0, Rig(BOUC_WEN), 1.0, 2.0),
}


def followed(change: Change, effort: Effort) -> Followed:
    """The same motion before and after."""
    kind = "chirp" if change.sine_Hz is None else "sine"
    duration_s = QUICK_s if effort.is_quick else None
    records = [
        recorded(rig, test_of(kind, current_A, change.sine_Hz), effort.seed, duration_s)
        for rig, current_A in (
            (change.before, change.before_A),
            (change.after, change.after_A),
        )
    ]
    plan = Plan(FROZEN, seed=effort.seed, quick=effort.is_quick, jobs=2)
    beside = [(PUBLISHED, simulator(change.after.damper()))]
    return follow(stream_of(records, None, SETTLE_s), plan, SETTLE_s, beside=beside)


def on_measured_damper(effort: Effort) -> dict[str, dict[str, Any]]:
    """A change of current of a damper that was measured, 10 mm at 1 Hz; nothing where the
    measurements are not on this machine."""
    folder = data_folder()
    if folder is None:
        return {}
    by_level = {round(one.level or 0.0, 2): one for one in records_of_test(folder)}
    out = {}
    for before_A, after_A in MEASURED_A:
        stream = stream_of([by_level[before_A], by_level[after_A]], None, SETTLE_s)
        plan = Plan(FROZEN, seed=effort.seed, quick=effort.is_quick, jobs=2)
        out[f"measured, {before_A:g} to {after_A:g} A"] = numbers_of(follow(stream, plan, SETTLE_s))
    return out


def numbers_of(found: Followed) -> dict[str, Any]:
    errors = found.errors_pct()
    return {
        "after_pct": errors[ADAPTIVE]["after"],
        "best_frozen": found.best_frozen(),
        "best_frozen_after_pct": errors[found.best_frozen()]["after"],
        "over_best_frozen": found.over_best_frozen(),
        "models": errors,
    }


def table_of(changes: dict[str, dict[str, Any]]) -> str:
    models = [ADAPTIVE, *FROZEN, STOPPED, LAST_FORCE, PUBLISHED]
    rows = []
    for kind, found in changes.items():
        for part in ("before", "during", "after"):
            errors = [found["models"].get(name) for name in models]
            cells = [f"{one[part]:.2f}" if one else "-" for one in errors]
            ratio = f"{found['over_best_frozen']:.2f}" if part == "after" else ""
            rows.append([kind if part == "before" else "", part, *cells, ratio])
    head = ["change", "", *models, "ratio"]
    title = (
        "error, % of the force: second half before a change, first 2 s, from 2 s on; ratio: "
        "adaptive over the best of those frozen at the change"
    )
    return f"{title}\n{format_table(head, rows, left=(0, 1))}"


def worst(changes: dict[str, dict[str, Any]], key: str) -> float:
    return float(np.max([one[key] for one in changes.values()]))
