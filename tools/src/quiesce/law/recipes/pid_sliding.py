"""Sliding on a PID surface: Bashir's adaptive law with its constant gains."""

from collections.abc import Iterable

import numpy as np

from quiesce.law.block import Compiled, System, compile_system
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> Compiled:
    count = len(rig.dampers)
    bodies = [damper.a for damper in rig.dampers]
    inputs = [rig.input("displacement", at) for at in bodies]
    inputs += [rig.input("velocity", at) for at in bodies]
    slope = values["switching_N"] / values["layer_m_s"]
    eye, none = np.eye(count), np.zeros((count, count))
    system = System(
        -values["leak_1_s"] * eye,
        np.hstack([eye, none]),
        slope * values["integral_1_s2"] * eye,
        slope * np.hstack([values["proportional_1_s"] * eye, eye]),
    )
    rows: Iterable[tuple[int, float]] = ((i, values["switching_N"]) for i in range(count))
    return compile_system(system, inputs, list(rows), rig.rate_Hz)


RECIPE = Recipe(
    "pid_sliding",
    "F = K sat(s / phi), s = kp x + ki int x + v",
    "review, eqs 29 and 30 (A-PIDSMC)",
    "proportional",
    (
        Setting("proportional_1_s", 5.0, 0.0, 1e3, "kp over kd", (0.1, 100)),
        Setting("integral_1_s2", 2.0, 0.0, 1e5, "ki over kd", (0.1, 1000)),
        Setting("leak_1_s", 0.5, 0.01, 100.0, "how fast the integral forgets"),
        Setting("switching_N", 200.0, 0.001, 1e6, "force beyond the layer"),
        Setting("layer_m_s", 0.05, 1e-4, 100.0, "width of the boundary layer"),
    ),
    make,
    equation="F = K sat(s / phi), s = kp x + ki int x dt + v, the integral leaking",
    errata="Right as printed. Their force tracker is tracker proportional with H = 1; nothing "
    "that is unbounded runs here, so the integral leaks.",
    when="With a force sensor at the damper, against drifts that an integral takes away.",
)
