"""A quarter of a car on a road that no law was tuned on: comfort, and the tyre's load."""

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

from quiesce.base.table import format_table
from quiesce.compare.records import Record
from quiesce.compare.roads import road
from quiesce.compare.run import Shaking
from quiesce.tune.gains.aim import Aim

from quiesce_benchmarks.laws import rigs, tuned
from quiesce_benchmarks.laws.tuned import Tried
from quiesce_benchmarks.part import Effort, Measured

TITLE = "unseen road: each law tuned on other roads"
FIGURES = (
    ("unseen_road_comfort_m_s2", "m/s2", None, "lower"),
    ("unseen_road_tyre", "of its load at rest", None, "lower"),
)
SPEED_km_h = 72.0
UNSEEN, TUNED_ON = 1, (2,)  # seeds of C roads; the first is the one that part car runs
SETTINGS, QUICK_SETTINGS = 16, 2
DAMPER, MOST_A = "rd1005_kwok_tanh_smooth", 1.88
AIMS = {"comfort": Aim("weighted_m_s2"), "tyre": Aim("tyre_share")}


def roads() -> list[Record]:
    """The unseen one first."""
    return [
        replace(road("C", SPEED_km_h, seed), name=f"road_{seed}") for seed in (UNSEEN, *TUNED_ON)
    ]


def measure(effort: Effort) -> Measured:
    records = roads()
    count = QUICK_SETTINGS if effort.is_quick else SETTINGS
    with tempfile.TemporaryDirectory(prefix="quiesce-laws-") as name:
        of_damper = rigs.map_of(Path(name), DAMPER, MOST_A)
        own = tuned.candidates(rigs.CAR, {}, of_damper)
        on = rigs.comparison(rigs.CAR, Shaking())
        tried = tuned.try_all(on, own, records, count, effort.seed)
    return judged(tried, records[0].name)


def judged(tried: Tried, unseen: str) -> Measured:
    laws = {label: law_data(label, tried, unseen) for label in tried.run()}
    chosen = {
        key: tuned.chosen_law(aim, tried.run(), unseen)[1].runs[unseen][aim.figure]
        for key, aim in AIMS.items()
    }
    values: dict[str, float | None] = {
        "unseen_road_comfort_m_s2": chosen["comfort"],
        "unseen_road_tyre": chosen["tyre"],
    }
    return Measured(values, {"laws": laws, "refused": tried.refused()}, (table(laws),))


def law_data(label: str, tried: Tried, unseen: str) -> dict[str, Any]:
    """By aim: settings and constants that are best on the other roads, on this one."""
    trials, as_it_comes = tried.run()[label], tried.untuned(label)
    found: dict[str, Any] = {"structure": rigs.CAR}
    for key, aim in AIMS.items():
        best = tuned.best(aim, trials, unseen)
        constant = tuned.best_constant(aim, tried.constants, unseen)
        own, beside = best.runs[unseen][aim.figure], constant[unseen][aim.figure]
        off = tried.constants[0][unseen][aim.figure]
        found[key] = {
            "figure": aim.figure,
            "tuned": own,
            "untuned": as_it_comes[unseen][aim.figure] if as_it_comes else None,
            "passive_off": off,
            "best_constant": beside,
            "beats_passive_off": bool(own < off),
            "beats_best_constant": bool(own < beside),
            "settings": best.values,
        }
    return found


def table(laws: dict[str, dict[str, Any]]) -> str:
    head = ["law", "comfort m/s2: tuned", "as it comes", "tyre: tuned", "as it comes"]
    rows = [
        [
            label,
            *(tuned.cell(one[key][name]) for key in AIMS for name in ("tuned", "untuned")),
        ]
        for label, one in sorted(laws.items(), key=lambda x: x[1]["comfort"]["tuned"])
    ]
    first = next(iter(laws.values()))
    for label, name in (("best constant", "best_constant"), ("no current", "passive_off")):
        rows.append([label, *(x for key in AIMS for x in (f"{first[key][name]:.3f}", ""))])
    return format_table(head, rows)
