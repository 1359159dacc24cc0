"""Free gains on what a damper's own end and stroke say, alike for all dampers."""

from quiesce.law.block import Compiled
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import LIMIT_N, Part, static_forces
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> Compiled:
    parts = []
    for i, damper in enumerate(rig.dampers):
        gains = {
            ("acceleration", damper.a): values["accel_N_s2_m"],
            ("velocity", damper.a): values["velocity_N_s_m"],
            ("stroke", i): values["stroke_N_m"],
            ("stroke velocity", i): values["stroke_N_s_m"],
        }
        if damper.b is not None:
            gains["acceleration", damper.b] = values["lower_accel_N_s2_m"]
            gains["velocity", damper.b] = values["lower_velocity_N_s_m"]
        used = {place: gain for place, gain in gains.items() if gain != 0.0}
        parts.append(Part(i, used or {("stroke velocity", i): 0.0}, values["limit_N"]))
    return static_forces(rig, parts)


RECIPE = Recipe(
    "clipped_linear",
    "F = g_a a_a + g_v v_a + g_b a_b + g_w v_b + g_x r + g_r v_r, clipped",
    "static output feedback",
    "inverse",
    (
        Setting("accel_N_s2_m", 0.0, -1e5, 1e5, "of the absolute acceleration of end a"),
        Setting("velocity_N_s_m", 1000.0, -1e6, 1e6, "of its absolute velocity"),
        Setting("lower_accel_N_s2_m", 0.0, -1e5, 1e5, "of end b's acceleration, if it is a body"),
        Setting("lower_velocity_N_s_m", 0.0, -1e6, 1e6, "of its velocity, likewise"),
        Setting("stroke_N_m", 0.0, -1e7, 1e7, "of the stroke"),
        Setting("stroke_N_s_m", 1000.0, -1e6, 1e6, "of the stroke's velocity"),
        LIMIT_N,
    ),
    make,
    equation="F = g_a a_a + g_v v_a + g_b a_b + g_w v_b + g_x r + g_r v_r",
    when="Gains from a search (quiesce tune law); a signal whose gain is 0 needs no sensor.",
)
