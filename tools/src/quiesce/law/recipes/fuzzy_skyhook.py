"""Skyhook by fuzzy rules: more current the faster the body, none against its motion."""

from quiesce.law.forms.fuzzy_signals import FuzzySignalsTable
from quiesce.law.from_rules import Source, table_of_rules
from quiesce.law.grid_rules import constant, evenly, grid, variable
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import ON_A, within_ceiling_A
from quiesce.law.rig import LawRig
from quiesce.rules.model import Singleton

SHARES = (1.0, 0.5, 0.0, 0.5, 1.0)  # of the current, by the set of the body's velocity


def make(rig: LawRig, values: dict[str, float]) -> FuzzySignalsTable:
    on_A = within_ceiling_A(rig, values["on_A"])
    body, stroke = values["body_m_s"], values["stroke_m_s"]

    def current(i: int, k: int) -> Singleton:
        way = (i - 2) * (k - 1)
        return constant(on_A * SHARES[i] * (1.0 if way > 0 else 0.5 if way == 0 else 0.0))

    inputs = (variable("v_a", body, evenly(body, 2)), variable("v_r", stroke, evenly(stroke, 1)))
    base = grid("fuzzy_skyhook", inputs, current)
    return table_of_rules(rig, base, (Source("velocity"), Source("stroke velocity")), 1.0)


RECIPE = Recipe(
    "fuzzy_skyhook",
    "5 x 3 fuzzy rules of the body's velocity and the stroke's: on where both go one way",
    "review, text on fuzzy controllers (Das and others); the rules are those of skyhook",
    "",
    (
        ON_A,
        Setting("body_m_s", 0.1, 1e-4, 10.0, "the body's velocity from which on it is large"),
        Setting("stroke_m_s", 0.02, 1e-4, 10.0, "the stroke's velocity whose sign is certain"),
    ),
    make,
    equation="I = sum of w_i I_i over the rules, w_i from min of memberships, sum of w_i 1; I_i: "
    "on x (1, 1/2, 0, 1/2, 1) by v_a where v_r goes the same way, half where v_r is small, else 0",
    errata="The review names inputs and prints no rule base.",
    when="As skyhook_on_off, without its switching: no map and no force sensor.",
)
