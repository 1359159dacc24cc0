"""A damper between the lower body and the ground: road holding."""

from quiesce.law.block import Compiled
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import LIMIT_N, Part, both_ends, static_forces
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> Compiled:
    both_ends(rig)
    parts = [
        Part(i, {("velocity", damper.b or 0): -values["ground_N_s_m"]}, values["limit_N"])
        for i, damper in enumerate(rig.dampers)
    ]
    return static_forces(rig, parts)


RECIPE = Recipe(
    "groundhook",
    "force against the lower body's own velocity: F = -c v_b",
    "Valasek and others 1997",
    "inverse",
    (Setting("ground_N_s_m", 2000.0, 0.0, 1e6, "damping of the lower body to the ground"), LIMIT_N),
    make,
    equation="F = -c v_b",
    when="A wheel to be kept on the road; the body pays for it.",
)
