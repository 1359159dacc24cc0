"""All current while the damper's force takes energy from the body: McClamroch and Gavin 1995."""

from quiesce.law.forms.signs import SignsTable
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import OFF_A, ON_A, BAND_m_s, Sign, alike
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> SignsTable:
    pairs = [
        (
            Sign({("velocity", damper.a): 1.0}, values["band_m_s"]),
            Sign({("force", i): 1.0}, values["band_N"]),
        )
        for i, damper in enumerate(rig.dampers)
    ]
    return alike(rig, values, pairs)


RECIPE = Recipe(
    "bang_bang",
    "on while v_a F > 0",
    "review, text; McClamroch and Gavin 1995",
    "",
    (ON_A, OFF_A, BAND_m_s, Setting("band_N", 3.0, 0.0, 1e5, "likewise of the force")),
    make,
    equation="I = on while v_a F > 0, else off",
    errata="The review prints no formula for the original.",
    when="A force sensor at the damper and none of its stroke.",
)
