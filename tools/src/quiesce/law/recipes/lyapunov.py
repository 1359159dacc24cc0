"""Stiffness and damping of a base-isolated mass: Nagarajaiah's rule of Lyapunov's kind."""

from math import pi

from quiesce.law.forms.signs import SignsTable
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import OFF_A, ON_A, BAND_m_s, Sign, alike
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> SignsTable:
    w = 2.0 * pi * values["natural_Hz"]
    band = values["band_m_s"]
    pairs = [
        (
            Sign({("displacement", damper.a): w, ("velocity", damper.a): 1.0}, band),
            Sign({("stroke velocity", i): 1.0}, band),
        )
        for i, damper in enumerate(rig.dampers)
    ]
    return alike(rig, values, pairs)


RECIPE = Recipe(
    "lyapunov",
    "on while (w x_a + v_a) v_r > 0",
    "review, eq 31 (Nagarajaiah)",
    "",
    (
        ON_A,
        OFF_A,
        BAND_m_s,
        Setting("natural_Hz", 1.0, 0.01, 100.0, "the body's frequency", (0.2, 30)),
    ),
    make,
    equation="I = on while (w x_a + v_a) v_r > 0, else off",
    errata="Right as printed; an absolute displacement drifts, so x_a is the view's high-passed "
    "one.",
    when="An isolated base, w the isolation's frequency.",
)
