"""Records that no law was chosen on: for each of the seven, the law that is best on the others."""

import tempfile
from pathlib import Path

import numpy as np
from quiesce.base.table import format_table
from quiesce.compare.run import BEST, Cell, Shaking
from quiesce.compare.table import laws_of

from quiesce_benchmarks.laws import rigs
from quiesce_benchmarks.part import Effort, Measured

TITLE = "unseen: each record judged by the law that is best on the others"
FIGURES = (
    ("index_unseen_mean", "1", 0.94, "lower"),
    ("index_unseen_worst", "1", 1.0, "lower"),
    ("beats_hindsight_constant_of", "records", 5.0, "higher"),
)
# Recipe, its settings, tracker: settings as they come but where a unit of the rig asks for more.
CANDIDATES = {
    "skyhook on off": ("skyhook_on_off", {}, ()),
    "largest dissipation": ("max_dissipation", {}, ()),
    "bang bang": ("bang_bang", {}, ()),
    "lyapunov": ("lyapunov", {"natural_Hz": 5.5}, ()),
    "clipped optimal": ("clipped_optimal", {"force_1_N2": 1e-10}, ("tracker=compare",)),
    "clipped optimal, in proportion": (
        "clipped_optimal",
        {"force_1_N2": 1e-10},
        ("tracker=proportional", "tracker_gain_mA_kN=2000"),
    ),
    "friction": (
        "modulated_friction",
        {"gain_N_m": 4e5},
        ("tracker=proportional", "tracker_gain_mA_kN=2000"),
    ),
    "polynomial": ("polynomial", {"e2_A_s_m": 15.0}, ()),
}


def measure(effort: Effort) -> Measured:
    records = rigs.records()
    peak = rigs.el_centro().peak_m_s2
    on = rigs.comparison(rigs.BUILDING, Shaking(rigs.FIVE_TIMES, scale_to_m_s2=peak))
    seeds = (effort.seed,) if effort.is_quick else tuple(range(effort.seed, effort.seed + 3))
    with tempfile.TemporaryDirectory(prefix="quiesce-laws-") as name:
        laws = [
            rigs.compared(Path(name), label, rigs.made(rigs.BUILDING, recipe, settings), *options)
            for label, (recipe, settings, options) in CANDIDATES.items()
        ]
        cells = on.cells(laws, records, seeds)
    chosen = {record.name: best_without(cells, record.name) for record in records}
    unseen = {name: mean_index(cells, law, name) for name, law in chosen.items()}
    hindsight = {name: mean_index(cells, BEST, name) for name in unseen}
    values: dict[str, float | None] = {
        "index_unseen_mean": float(np.mean(list(unseen.values()))),
        "index_unseen_worst": max(unseen.values()),
        "beats_hindsight_constant_of": float(sum(unseen[n] < hindsight[n] for n in unseen)),
    }
    return Measured(values, {"chosen": chosen}, (table(cells, chosen),))


def mean_index(cells: list[Cell], law: str, record: str) -> float:
    return float(np.mean([c.index for c in cells if c.law == law and c.record == record]))


def best_without(cells: list[Cell], record: str) -> str:
    """The candidate with the best mean index over all other records."""
    others = [cell for cell in cells if cell.record != record]

    def index(law: str) -> float:
        return float(np.mean([cell.index for cell in others if cell.law == law]))

    return min(CANDIDATES, key=index)


def table(cells: list[Cell], chosen: dict[str, str]) -> str:
    laws = laws_of(cells)
    rows = [[law, *(f"{mean_index(cells, law, name):.3f}" for name in chosen)] for law in laws]
    rows.append(["chosen on the others", *chosen.values()])
    return format_table(["index", *chosen], rows)
