"""Skyhook and groundhook in shares, with a plain damper beside them."""

from quiesce.law.block import Compiled
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import LIMIT_N, Part, both_ends, static_forces
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> Compiled:
    both_ends(rig)
    parts = [
        Part(
            i,
            {
                ("velocity", damper.a): values["sky_N_s_m"],
                ("velocity", damper.b or 0): -values["ground_N_s_m"],
                ("stroke velocity", i): values["between_N_s_m"],
            },
            values["limit_N"],
        )
        for i, damper in enumerate(rig.dampers)
    ]
    return static_forces(rig, parts)


RECIPE = Recipe(
    "mixed_hooks",
    "F = c_s v_a - c_g v_b + c (v_a - v_b): comfort and road holding in shares",
    "Ahmadian 1997",
    "inverse",
    (
        Setting("sky_N_s_m", 2000.0, 0.0, 1e6, "damping of the upper body to the sky"),
        Setting("ground_N_s_m", 1000.0, 0.0, 1e6, "damping of the lower body to the ground"),
        Setting("between_N_s_m", 0.0, 0.0, 1e6, "damping between the two"),
        LIMIT_N,
    ),
    make,
    equation="F = c_s v_a - c_g v_b + c v_r",
    when="Comfort and road holding in shares that a search can set.",
)
