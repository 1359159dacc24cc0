"""Fuzzy rules of the stroke and its velocity: all that they need is at the damper."""

from quiesce.law.forms.fuzzy_signals import FuzzySignalsTable
from quiesce.law.from_rules import Source, table_of_rules
from quiesce.law.grid_rules import constant, evenly, grid, variable
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import ON_A, within_ceiling_A
from quiesce.law.rig import LawRig
from quiesce.rules.model import Singleton


def make(rig: LawRig, values: dict[str, float]) -> FuzzySignalsTable:
    on_A = within_ceiling_A(rig, values["on_A"])
    outward, back = values["outward_share"], values["back_share"]

    def current(i: int, k: int) -> Singleton:
        x, v = i - 2, k - 2
        way = outward if x * v > 0 else back if x * v < 0 else 0.5 * (outward + back)
        return constant(on_A * way * (abs(x) + abs(v)) / 4.0)

    inputs = (
        variable("r", values["stroke_m"], evenly(values["stroke_m"], 2)),
        variable("v_r", values["stroke_m_s"], evenly(values["stroke_m_s"], 2)),
    )
    base = grid("fuzzy_drift", inputs, current)
    return table_of_rules(rig, base, (Source("stroke"), Source("stroke velocity")), 1.0)


RECIPE = Recipe(
    "fuzzy_drift",
    "5 x 5 fuzzy rules of the stroke and its velocity: the current grows with both",
    "review, text on fuzzy controllers: displacement and velocity are their inputs",
    "",
    (
        ON_A,
        Setting("stroke_m", 0.005, 1e-6, 1.0, "the stroke from which on it is large"),
        Setting("stroke_m_s", 0.2, 1e-4, 10.0, "likewise its velocity"),
        Setting("outward_share", 1.0, 0.0, 1.0, "share of on_A where the stroke grows"),
        Setting("back_share", 1.0, 0.0, 1.0, "share of on_A where it comes back"),
    ),
    make,
    equation="I = sum of w_i I_i over the rules, sum of w_i 1; I_i: on x (|i| + |j|) / 4 for sets "
    "i of r and j of v_r, -2 .. 2; x outward_share where r v_r > 0, x back_share where r v_r < 0, "
    "their mean else",
    errata="The review names inputs and prints no rule base.",
    when="Only the damper's own stroke is measured.",
)
