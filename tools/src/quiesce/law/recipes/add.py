"""Acceleration-driven damping: Savaresi, Silani and Bittanti 2005."""

from quiesce.law.forms.signs import SignsTable
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import OFF_A, ON_A, BAND_m_s, Sign, alike
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> SignsTable:
    pairs = [
        (
            Sign({("acceleration", damper.a): 1.0}, values["band_m_s2"]),
            Sign({("stroke velocity", i): 1.0}, values["band_m_s"]),
        )
        for i, damper in enumerate(rig.dampers)
    ]
    return alike(rig, values, pairs)


RECIPE = Recipe(
    "add",
    "on while a_a v_r > 0",
    "Savaresi, Silani and Bittanti 2005",
    "",
    (
        ON_A,
        OFF_A,
        BAND_m_s,
        Setting("band_m_s2", 0.05, 0.0, 100.0, "likewise of the acceleration"),
    ),
    make,
    equation="I = on while a_a v_r > 0, else off",
    when="Above resonance: it is the best for the next moment's acceleration alone. At "
    "resonance it is worse than nothing.",
)
