"""Skyhook of a damper and of an elastomer mount above it, each as far as it can."""

from quiesce.law.block import Compiled
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import LIMIT_N, Part, static_forces
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> Compiled:
    if len(rig.dampers) != 2:
        raise ValueError(f"board {rig.name} has {len(rig.dampers)} dampers; this law is for two")
    gains = (values["sky_N_s_m"], values["mount_N_s_m"])
    limits = (values["limit_N"], LIMIT_N.high)
    parts = [
        Part(i, {("velocity", rig.dampers[i].a): gains[i]}, limits[i]) for i in range(len(gains))
    ]
    return static_forces(rig, parts)


RECIPE = Recipe(
    "skyhook_elastomer",
    "a damper, and an elastomer mount above it, each against its upper body's own velocity",
    "elastomer paper, eqs 34 to 37",
    "inverse",
    (
        Setting("sky_N_s_m", 2000.0, 0.0, 1e6, "damping of the first damper's body to the sky"),
        Setting("mount_N_s_m", 2000.0, 0.0, 1e6, "the same of the mount's body"),
        LIMIT_N,
    ),
    make,
    equation="F_1 = sgn(v_1) min(limit, c_1 |v_1|), F_2 = c_2 v_2; the mount's stiffness is "
    "F_2 / r_2 where that is one that it has, the least where F_2 and r_2 have different signs",
    errata="eq 34 compares signed numbers and never clips below 0; eq 35 lacks its lower limit; "
    "eq 37 takes the inverse of a stiffness without the least one, and K(i) is in MPa of the "
    "modulus, not in N/m; eq 36 lacks the check of the sign. A spring that is switched while it is "
    "deflected can do work: this law is not strictly dissipative",
    when="a damper for large and slow, a mount for small and fast motion; the map needs a section "
    "for each, the mount's over stroke (quiesce identify inverse --over stroke)",
)
