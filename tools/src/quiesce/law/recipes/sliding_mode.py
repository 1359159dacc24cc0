"""Sliding on s = lambda x + v, with a boundary layer in which the force is linear."""

from quiesce.law.block import Compiled
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import LIMIT_N, Part, static_forces
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> Compiled:
    parts = []
    for i, damper in enumerate(rig.dampers):
        x, v = ("displacement", damper.a), ("velocity", damper.a)
        slope = values["switching_N"] / values["layer_m_s"]
        parts += [
            Part(i, {x: slope * values["lambda_1_s"], v: slope}, values["switching_N"]),
            Part(i, {v: values["equivalent_N_s_m"]}, values["limit_N"]),
        ]
    return static_forces(rig, parts)


RECIPE = Recipe(
    "sliding_mode",
    "F = c v + K sat(s / phi), s = lambda x + v",
    "review, text on Lee's law",
    "inverse",
    (
        Setting("lambda_1_s", 5.0, 0.0, 1e3, "how fast it slides to rest", (0.1, 100)),
        Setting("switching_N", 200.0, 0.001, 1e6, "force beyond the layer"),
        Setting("layer_m_s", 0.05, 1e-4, 100.0, "width of the boundary layer"),
        Setting("equivalent_N_s_m", 0.0, 0.0, 1e6, "of the equivalent force"),
        LIMIT_N,
    ),
    make,
    equation="F = c v + K sat(s / phi), s = lambda x + v",
    errata="No equation is printed: this is the plain form. The review's 'synovial' is 'sliding'.",
    when="A stiff force with a soft edge where the damper's strength is known and little else.",
)
