"""Skyhook below a frequency, acceleration-driven above it: Savaresi and Spelta 2007.

Their rule is skyhook where a^2 - w^2 v^2 <= 0 and acceleration-driven where it is above 0. Of the
two factors a - w v and a + w v the second has the sign of a where |a| is larger, and that of v
where |w v| is: so the whole rule is one sign, that of a + w v.
"""

from math import pi

from quiesce.law.forms.signs import SignsTable
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import OFF_A, ON_A, BAND_m_s, Sign, alike
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> SignsTable:
    w = 2.0 * pi * values["cross_Hz"]
    pairs = [
        (
            Sign({("acceleration", damper.a): 1.0, ("velocity", damper.a): w}, values["band_m_s2"]),
            Sign({("stroke velocity", i): 1.0}, values["band_m_s"]),
        )
        for i, damper in enumerate(rig.dampers)
    ]
    return alike(rig, values, pairs)


RECIPE = Recipe(
    "sh_add",
    "on while (a_a + w v_a) v_r > 0: skyhook below w, acceleration-driven above",
    "Savaresi and Spelta 2007",
    "",
    (
        ON_A,
        OFF_A,
        BAND_m_s,
        Setting("band_m_s2", 0.05, 0.0, 100.0, "likewise of the sum"),
        Setting("cross_Hz", 1.8, 0.01, 100.0, "frequency between the two", (0.2, 30)),
    ),
    make,
    equation="I = on while (a_a + w v_a) v_r > 0, else off",
    errata="Their two cases, told by the sign of a^2 - w^2 v^2, are the sign of this one sum.",
    when="A body with both: skyhook below w, acceleration-driven above.",
)
