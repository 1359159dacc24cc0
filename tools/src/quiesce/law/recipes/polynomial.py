"""A current that grows with drift and drift rate: Cha and others 2013."""

from quiesce.law.forms.polynomial import PolynomialSection, PolynomialTable, Term, term
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.rig import LawRig

# Powers of stroke and of its velocity.
TERMS = {
    "d1_A": (0, 0), "d2_A_m": (1, 0), "d3_A_m2": (2, 0), "d4_A_m3": (3, 0),
    "e2_A_s_m": (0, 1), "e3_A_s2_m2": (0, 2), "e4_A_s3_m3": (0, 3),
}  # fmt: skip


def make(rig: LawRig, values: dict[str, float]) -> PolynomialTable:
    return PolynomialTable(tuple(_section(rig, values, i) for i in range(len(rig.dampers))))


def _section(rig: LawRig, values: dict[str, float], i: int) -> PolynomialSection:
    inputs = (rig.input("stroke", i), rig.input("stroke velocity", i))
    terms: list[Term] = [
        term(inputs, powers, values[name]) for name, powers in TERMS.items() if values[name]
    ]
    return PolynomialSection(inputs, (True, True), tuple(terms) or (term(inputs, (0, 0), 0.0),))


RECIPE = Recipe(
    "polynomial",
    "I = d1 + d2 |x| + d3 x^2 + d4 |x|^3 + e2 |v| + e3 v^2 + e4 |v|^3 of the stroke",
    "review, eq 28; Cha and others 2013",
    "",
    (
        Setting("d1_A", 0.0, -20.0, 20.0, "constant"),
        Setting("d2_A_m", 0.0, -1e4, 1e4, "of the stroke"),
        Setting("d3_A_m2", 0.0, -1e6, 1e6, "of its square"),
        Setting("d4_A_m3", 0.0, -1e8, 1e8, "of its cube"),
        Setting("e2_A_s_m", 2.0, -1e3, 1e3, "of its velocity"),
        Setting("e3_A_s2_m2", 0.0, -1e4, 1e4, "of that squared"),
        Setting("e4_A_s3_m3", 0.0, -1e5, 1e5, "of that cubed"),
    ),
    make,
    equation="I = d1 + d2 |r| + d3 r^2 + d4 |r|^3 + e2 |v_r| + e3 v_r^2 + e4 |v_r|^3, 0 .. 20 A",
    errata="Prints d3 and e3 twice and the displacement in the group of e, where the text has "
    "the velocity; odd powers without magnitudes would treat the two ways of a symmetric "
    "structure differently. e1 is d1.",
    when="Nothing but the stroke is known, and a search is at hand.",
)
