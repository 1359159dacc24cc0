"""A damper between body and sky, as far as the real one can: Karnopp and others 1974."""

from quiesce.law.block import Compiled
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import LIMIT_N, Part, static_forces
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> Compiled:
    gain = values["sky_N_s_m"]
    parts = [
        Part(i, {("velocity", damper.a): gain}, values["limit_N"])
        for i, damper in enumerate(rig.dampers)
    ]
    return static_forces(rig, parts)


RECIPE = Recipe(
    "skyhook",
    "force against the body's own velocity: F = sgn(v_a) min(limit, c |v_a|)",
    "elastomer paper, eq 34; Karnopp and others 1974",
    "inverse",
    (Setting("sky_N_s_m", 2000.0, 0.0, 1e6, "damping to the sky"), LIMIT_N),
    make,
    equation="F = sgn(v_a) min(limit, c |v_a|)",
    errata="Compares signed numbers, so that below 0 it never clips; magnitudes here. The 0 of "
    "its other case is the damper's force without current.",
    when="A body to be kept quiet, at its own resonance and above. Tracker bank, not inverse, "
    "for a damper with hysteresis.",
)
