"""All current while body and stroke move the same way: Karnopp and others 1974, Krasnicki 1980."""

from quiesce.law.forms.signs import SignsTable
from quiesce.law.recipe import Recipe
from quiesce.law.recipes.common import OFF_A, ON_A, BAND_m_s, Sign, alike
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> SignsTable:
    band = values["band_m_s"]
    pairs = [
        (Sign({("velocity", damper.a): 1.0}, band), Sign({("stroke velocity", i): 1.0}, band))
        for i, damper in enumerate(rig.dampers)
    ]
    return alike(rig, values, pairs)


RECIPE = Recipe(
    "skyhook_on_off",
    "on while v_a v_r > 0",
    "Karnopp and others 1974, Krasnicki 1980",
    "",
    (ON_A, OFF_A, BAND_m_s),
    make,
    equation="I = on while v_a v_r > 0, else off",
    when="No map and no force sensor; the first one to try.",
)
