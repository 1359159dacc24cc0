"""All current while force and stroke go the same way: Jansen and Dyke 2000."""

from quiesce.law.forms.signs import SignsTable
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import OFF_A, ON_A, BAND_m_s, Sign, alike
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> SignsTable:
    pairs = [
        (
            Sign({("force", i): 1.0}, values["band_N"]),
            Sign({("stroke velocity", i): 1.0}, values["band_m_s"]),
        )
        for i in range(len(rig.dampers))
    ]
    return alike(rig, values, pairs)


RECIPE = Recipe(
    "max_dissipation",
    "on while F v_r > 0: the damper's spring takes nothing back",
    "Jansen and Dyke 2000",
    "",
    (ON_A, OFF_A, BAND_m_s, Setting("band_N", 3.0, 0.0, 1e5, "likewise of the force")),
    make,
    equation="I = on while F v_r > 0, else off",
    when="A damper with much hysteresis, all sensors at the damper itself.",
)
