"""One mass whose base moves at its own frequency and above: laws beside each other."""

import tempfile
from pathlib import Path

import numpy as np
from quiesce.base.paths import root
from quiesce.base.table import format_table
from quiesce.compare.laws import ComparedLaw, constant
from quiesce.engine.bench import Bench
from quiesce.engine.trace import read_trace

from quiesce_benchmarks.laws import rigs
from quiesce_benchmarks.part import Effort, Measured

TITLE = "single: one mass, its laws beside a prototype's"
FIGURES = (
    ("single_accel_worst_pct", "%", None, "lower"),
    ("single_stroke_worst_pct", "%", None, "lower"),
)
RIG = "single_mass"
DAMPER, MOST_A = "rd1005_kwok_tanh_smooth", 1.88
FROM_s = 10.0
# RMS of the acceleration, m/s2, and of the stroke, mm, of a prototype in floating point. Of its
# gains only Lyapunov's frequency (31 rad/s) and the shares of quasi bang bang are known.
PROTOTYPE = {
    "off": (7.23, 78.6),
    "on": (2.20, 6.6),
    "skyhook": (1.96, 22.8),
    "skyhook on off": (1.78, 14.6),
    "ADD": (2.91, 37.6),
    "clipped optimal": (1.75, 14.1),
    "PID sliding": (2.03, 24.0),
    "Lyapunov": (2.04, 7.2),
    "quasi bang bang": (2.10, 17.2),
}
# Of the stroke against the force.
OPTIMAL = {"accel_s4_m2": 0.0, "drift_1_m2": 1000.0, "force_1_N2": 1e-8}


def laws(folder: Path) -> list[ComparedLaw]:
    """As PROTOTYPE. Gains that are not known are round numbers of ours."""
    of_damper = rigs.map_of(folder, DAMPER, MOST_A)

    def law(label: str, recipe: str, settings: dict[str, float], *more: str) -> ComparedLaw:
        return rigs.compared(folder, label, rigs.made(RIG, recipe, settings), *more)

    skyhook = rigs.made(RIG, "skyhook", {"sky_N_s_m": 20000.0})
    return [
        constant(0, "off"),
        constant(round(1e3 * MOST_A), "on"),
        rigs.compared(folder, "skyhook", skyhook, map_file=of_damper),
        law("skyhook on off", "skyhook_on_off", {}),
        law("ADD", "add", {}),
        law("clipped optimal", "clipped_optimal", OPTIMAL, "tracker=compare"),
        law(
            "PID sliding", "pid_sliding", {"switching_N": 3000.0, "layer_m_s": 0.5},
            "tracker=proportional", "tracker_gain_mA_kN=10000",
        ),
        law("Lyapunov", "lyapunov", {"natural_Hz": 31.0 / (2.0 * np.pi)}),
        law("quasi bang bang", "quasi_bang_bang", {"down_in_share": 0.5}),
    ]  # fmt: skip


def figures(bench: Bench, folder: Path, law: ComparedLaw, seed: int) -> tuple[float, float]:
    """RMS of acceleration, m/s2, and stroke, mm, once they are steady."""
    trace = folder / "run.trace"
    bench.json(
        "run", "--scenario", str(root() / f"sim_hil/data/scenarios/{RIG}.toml"),
        "--law", law.law, "--seed", str(seed), "--trace", str(trace),
        "--columns", "t_s,mass_true_mm_s2,strut_true_stroke_um", *law.options,
    )  # fmt: skip
    found = read_trace(trace)
    steady = found["t_s"] >= FROM_s
    columns = (found["mass_true_mm_s2"], found["strut_true_stroke_um"])
    accel, stroke = (1e-3 * float(np.sqrt(np.mean(one[steady] ** 2))) for one in columns)
    return accel, stroke


def measure(effort: Effort) -> Measured:
    with tempfile.TemporaryDirectory(prefix="quiesce-laws-") as name:
        folder, bench = Path(name), Bench()
        found = {one.label: figures(bench, folder, one, effort.seed) for one in laws(folder)}
    apart = {
        label: [
            100.0 * (ours / theirs - 1.0)
            for ours, theirs in zip(one, PROTOTYPE[label], strict=True)
        ]
        for label, one in found.items()
    }
    values: dict[str, float | None] = {
        "single_accel_worst_pct": max(abs(one[0]) for one in apart.values()),
        "single_stroke_worst_pct": max(abs(one[1]) for one in apart.values()),
    }
    rows = [
        [
            label, f"{one[0]:.2f}", f"{PROTOTYPE[label][0]:.2f}", f"{apart[label][0]:+.0f}",
            f"{one[1]:.1f}", f"{PROTOTYPE[label][1]:.1f}", f"{apart[label][1]:+.0f}",
        ]
        for label, one in found.items()
    ]  # fmt: skip
    head = ["law", "a, m/s2", "prototype", "%", "stroke, mm", "prototype", "%"]
    return Measured(values, {"figures": found}, (format_table(head, rows),))
