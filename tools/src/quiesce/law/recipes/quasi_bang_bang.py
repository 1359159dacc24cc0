"""A current for each quadrant of displacement and velocity: Aly 2013."""

from quiesce.law.forms.signs import SignsSection, SignsTable
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import ON_A, BAND_m_s, Sign, section
from quiesce.law.rig import Damper, LawRig


def make(rig: LawRig, values: dict[str, float]) -> SignsTable:
    return SignsTable(tuple(_section(rig, damper, values) for damper in rig.dampers))


def _section(rig: LawRig, damper: Damper, values: dict[str, float]) -> SignsSection:
    on = min(values["on_A"], 1e-3 * damper.ceiling_mA)  # a share is one of what there is
    # By the bits x > 0 and v > 0: x < 0 and v < 0, x > 0 and v < 0, x < 0 and v > 0, both.
    currents = (values["down_share"] * on, values["down_in_share"] * on,
                values["up_in_share"] * on, values["up_share"] * on)  # fmt: skip
    signs = (
        Sign({("displacement", damper.a): 1.0}, values["band_m"]),
        Sign({("velocity", damper.a): 1.0}, values["band_m_s"]),
    )
    return section(rig, damper, signs, currents, currents[0])


def _share(name: str, default: float, which: str) -> Setting:
    return Setting(name, default, 0.0, 1.0, f"share of on_A {which}")


RECIPE = Recipe(
    "quasi_bang_bang",
    "a share of the current in each quadrant of displacement and velocity",
    "review, eq 32; Aly 2013",
    "",
    (
        ON_A,
        BAND_m_s,
        Setting("band_m", 0.0001, 0.0, 1.0, "likewise of the displacement"),
        _share("up_share", 0.2, "moving out, x > 0"),
        _share("down_share", 0.2, "moving out, x < 0"),
        _share("down_in_share", 1.0, "coming back, x > 0"),
        _share("up_in_share", 1.0, "coming back, x < 0"),
    ),
    make,
    equation="I = on times a share for each quadrant of x_a and v_a",
    errata="It names one quadrant twice and is not its own mirror image: equal shares of "
    "opposite quadrants are. Its weights favour the inward quadrants; below resonance the "
    "outward ones are what works.",
    when="A single body whose displacement is known.",
)
