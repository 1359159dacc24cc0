"""All current while the lower body moves against the stroke."""

from quiesce.law.forms.signs import SignsTable
from quiesce.law.recipe import Recipe
from quiesce.law.recipes.common import OFF_A, ON_A, BAND_m_s, Sign, alike, both_ends
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> SignsTable:
    both_ends(rig)
    band = values["band_m_s"]
    pairs = [
        (
            Sign({("velocity", damper.b or 0): -1.0}, band),
            Sign({("stroke velocity", i): 1.0}, band),
        )
        for i, damper in enumerate(rig.dampers)
    ]
    return alike(rig, values, pairs)


RECIPE = Recipe(
    "groundhook_on_off",
    "on while -v_b v_r > 0",
    "two states of groundhook",
    "",
    (ON_A, OFF_A, BAND_m_s),
    make,
    equation="I = on while -v_b v_r > 0, else off",
    when="A wheel to be kept on the road, without a map.",
)
