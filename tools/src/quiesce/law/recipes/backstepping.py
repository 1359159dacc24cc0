"""Backstepping on one mass: its errors fade as h1 and h2 say. Zapateiro and others 2009."""

from quiesce.law.block import Compiled
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import LIMIT_N, Part, static_forces
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> Compiled:
    h1, h2, mass = values["h1_1_s"], values["h2_1_s"], values["mass_kg"]
    stiffness = mass * (values["coupling_1_s2"] + h1 * h2) - values["stiffness_N_m"]
    damping = mass * (h1 + h2) - values["damping_N_s_m"]
    parts = [
        Part(
            i,
            {("displacement", damper.a): stiffness, ("velocity", damper.a): damping},
            values["limit_N"],
        )
        for i, damper in enumerate(rig.dampers)
    ]
    return static_forces(rig, parts)


RECIPE = Recipe(
    "backstepping",
    "F = m (1 + h1 h2) x + m (h1 + h2) v - k x - c v",
    "review, eq 33; Zapateiro and others 2009",
    "inverse",
    (
        Setting("mass_kg", 100.0, 1e-3, 1e6, "of the body", is_tuned=False),
        Setting("stiffness_N_m", 1e4, 0.0, 1e9, "of what holds it", is_tuned=False),
        Setting("damping_N_s_m", 100.0, 0.0, 1e7, "likewise", is_tuned=False),
        Setting("h1_1_s", 5.0, 0.0, 1e3, "how fast the first error fades", (0.1, 100)),
        Setting("h2_1_s", 5.0, 0.0, 1e3, "how fast the second one does", (0.1, 100)),
        Setting(
            "coupling_1_s2",
            1.0,
            0.0,
            1e4,
            "the 1 of the published form, where time is in s",
            is_tuned=False,
        ),
        LIMIT_N,
    ),
    make,
    equation="F = m (1 + h1 h2) x + m (h1 + h2) v - k x - c v",
    errata="The printed denominator lacks g, and g's sign is not that of the minus before it. As "
    "a force there is no denominator: to divide by the hysteretic state is the inverse's "
    "work. Tracker bank does it: its models with memory observe that state, the hysteresis "
    "observer that the law needs; tracker inverse has a map without memory.",
    when="One mass whose mount is known. Tracker bank for a damper with hysteresis.",
)
