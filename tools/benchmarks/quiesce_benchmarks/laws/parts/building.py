"""The building of 1996 on El Centro at five times its rate, unscaled (Dyke and others 1996)."""

import tempfile
from pathlib import Path

import numpy as np
from quiesce.base.table import format_table
from quiesce.compare.laws import ComparedLaw, constant
from quiesce.compare.run import Case, Comparison, Shaking
from quiesce.engine.bench import Bench
from quiesce.engine.trace import Trace

from quiesce_benchmarks.laws import rigs
from quiesce_benchmarks.part import Effort, Measured

TITLE = "building: published peaks, without and with laws"
FIGURES = (
    ("dyke_uncontrolled_worst_pct", "%", 5.0, "lower"),
    ("dyke_passive_off_worst_pct", "%", 5.0, "lower"),
    ("dyke_passive_on_worst_pct", "%", 5.0, "lower"),
    ("dyke_clipped_optimal_worst_pct", "%", 18.0, "lower"),
    ("dyke_best_x3_cm", "cm", 0.215, "lower"),
    ("dyke_best_accel_cm_s2", "cm/s2", 709.0, "lower"),
)
FLOORS = ("first", "second", "third")
# Peaks: displacements cm, drifts cm, accelerations cm/s2, force N; empty where none is published.
PUBLISHED = {
    "uncontrolled": ([0.538, 0.820, 0.962], [], [856, 1030, 1400], []),
    "passive off": ([0.211, 0.357, 0.455], [], [420, 480, 717], [258]),
    "passive on": ([0.076, 0.196, 0.306], [], [281, 494, 767], [979]),
    "clipped optimal": ([0.114, 0.185, 0.212], [0.114, 0.090, 0.101], [696, 739, 703], [941]),
}
# Of the third floor's acceleration against the force; found by hand on this record.
PUBLISHED_WEIGHTS = {"force_1_N2": 1e-12}
# Ours on this record alone, found by searches of 900 trials over weights and its tracker's gain:
# that trades the two figures for one another, 190 gives 0.2154 with 710 cm/s2.
BEST_WEIGHTS = {
    "force_1_N2": 1.237e-14,
    "displacement_1_m2": 61.55,
    "drift_1_m2": 45.46,
    "accel_noise_m_s2": 0.1959,
}
BEST_GAIN_mA_kN = 188
SEEDS = (1, 2, 3, 4, 5)


def peaks(trace: Trace) -> tuple[list[float], list[float], list[float], list[float]]:
    places = np.array([1e-4 * trace[f"{name}_true_um"] for name in FLOORS])
    accels = [0.1 * np.abs(trace[f"{name}_true_mm_s2"]).max() for name in FLOORS]
    drifts = np.abs(np.diff(places, axis=0, prepend=0.0)).max(axis=1)
    force_N = 1e-3 * np.abs(trace["brace_true_force_mN"]).max()
    return list(np.abs(places).max(axis=1)), list(drifts), accels, [float(force_N)]


def difference_pct(found: tuple, published: tuple) -> float:
    pairs = [
        (ours, theirs)
        for own, their in zip(found, published, strict=True)
        for ours, theirs in zip(own, their or [None] * len(own), strict=True)
        if theirs is not None
    ]
    return max(100.0 * abs(ours / theirs - 1.0) for ours, theirs in pairs)


def run(on: Comparison, law: ComparedLaw, seed: int) -> tuple:
    return peaks(on.trace(Case(law, rigs.el_centro(), seed)))


def measure(effort: Effort) -> Measured:
    shaking = Shaking(time_scale=rigs.FIVE_TIMES)
    on = rigs.comparison(rigs.BUILDING, shaking)
    with tempfile.TemporaryDirectory(prefix="quiesce-laws-") as name:
        folder = Path(name)
        board = rigs.files(rigs.BUILDING)[1]
        bare = Comparison(Bench(), rigs.bare(folder, rigs.BUILDING), board, shaking)
        optimal = rigs.made(rigs.BUILDING, "clipped_optimal", PUBLISHED_WEIGHTS)
        best = rigs.made(rigs.BUILDING, "clipped_optimal", BEST_WEIGHTS)
        gain = f"tracker_gain_mA_kN={BEST_GAIN_mA_kN}"
        ours = rigs.compared(folder, "best", best, "tracker=proportional", gain)
        published_law = rigs.compared(folder, "optimal", optimal, "tracker=compare")
        found = {
            "uncontrolled": run(bare, constant(0, "off"), effort.seed),
            "passive off": run(on, constant(0, "off"), effort.seed),
            "passive on": run(on, constant(on.rig.all_mA, "on"), effort.seed),
            "clipped optimal": run(on, published_law, effort.seed),
        }
        seeds = SEEDS[:1] if effort.is_quick else SEEDS
        over_seeds = [run(on, ours, seed) for seed in seeds]
    values: dict[str, float | None] = {
        f"dyke_{key.replace(' ', '_')}_worst_pct": difference_pct(found[key], PUBLISHED[key])
        for key in PUBLISHED
        if key.startswith("passive") or key in ("uncontrolled", "clipped optimal")
    }
    values["dyke_best_x3_cm"] = max(one[0][2] for one in over_seeds)
    values["dyke_best_accel_cm_s2"] = max(max(one[2]) for one in over_seeds)
    return Measured(values, {"weights": PUBLISHED_WEIGHTS}, (table(found, over_seeds[0]),))


def table(found: dict[str, tuple], ours: tuple) -> str:
    rows = []
    for key, one in [*found.items(), ("ours", ours)]:
        rows.append([key, *_cells(one)])
        if key in PUBLISHED:
            rows.append(["  published", *_cells(PUBLISHED[key])])
    head = ["", "x, cm", "drifts, cm", "a, cm/s2", "force, N"]
    return format_table(head, rows, (0, 1, 2, 3, 4))


def _cells(one: tuple) -> list[str]:
    return [
        " ".join(f"{value:.3f}" for value in one[0]),
        " ".join(f"{value:.3f}" for value in one[1]) or "-",
        " ".join(f"{value:.0f}" for value in one[2]),
        " ".join(f"{value:.0f}" for value in one[3]) or "-",
    ]
