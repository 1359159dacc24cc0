"""Friction in proportion to the last peak of the stroke: Inaudi 1997."""

from quiesce.law.forms.friction import BACK, LIMIT, OUTWARD, FrictionSection, FrictionTable
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import LIMIT_N, BAND_m_s
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> FrictionTable:
    for i in range(len(rig.dampers)):
        rig.input("stroke", i)
        rig.input("stroke velocity", i)
    ways = (OUTWARD if values["outward"] else 0) | (BACK if values["back"] else 0)
    if not ways:
        raise ValueError("outward and back are both 0: it would never act")
    section = FrictionSection(
        round(values["gain_N_m"]),
        round(1e9 * values["least_peak_m"]),
        min(LIMIT, round(1e3 * values["limit_N"])),
        round(1e6 * values["band_m_s"]),
        ways,
    )
    return FrictionTable(tuple(section for _ in rig.dampers))


RECIPE = Recipe(
    "modulated_friction",
    "F = g |last peak of the stroke| sgn(v_r), gated by a least peak and by quadrants",
    "Inaudi 1997",
    "proportional",
    (
        Setting("gain_N_m", 50000.0, 0.0, 1e9, "force for 1 m of the last peak"),
        Setting("least_peak_m", 0.0, 0.0, 1.0, "below it there is no demand"),
        Setting("outward", 1.0, 0.0, 1.0, "1: acts where the stroke grows", (0, 1), is_whole=True),
        Setting("back", 1.0, 0.0, 1.0, "1: acts where it comes back", (0, 1), is_whole=True),
        BAND_m_s,
        LIMIT_N,
    ),
    make,
    equation="F = g |last peak of r| sgn(v_r)",
    when="Stroke and force alone, no accelerometer; what a cycle takes grows with the square "
    "of its amplitude, as in a linear damper.",
)
