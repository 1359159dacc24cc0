"""Takagi, Sugeno and Kang: a straight line of stroke and velocity in each fuzzy region."""

from quiesce.law.forms.fuzzy_signals import FuzzySignalsTable
from quiesce.law.from_rules import Source, table_of_rules
from quiesce.law.grid_rules import grid, variable
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.rig import LawRig
from quiesce.rules.model import Input, Singleton


def make(rig: LawRig, values: dict[str, float]) -> FuzzySignalsTable:
    def line(i: int, k: int) -> Singleton:
        """Signs of r and v_r; slopes are of magnitudes, so that both ways are alike."""
        x, v = 2 * i - 1, 2 * k - 1
        part = "outward" if x == v else "back"
        slopes = (x * values[f"p_{part}_A_m"], v * values[f"q_{part}_A_s_m"])
        return Singleton(f"{i}{k}", values[f"r_{part}_A"], slopes)

    inputs = (_sides(values, "stroke_m"), _sides(values, "stroke_m_s"))
    base = grid("tsk", inputs, line)
    return table_of_rules(rig, base, (Source("stroke"), Source("stroke velocity")), 1.0)


def _sides(values: dict[str, float], name: str) -> Input:
    """Two sets that cross at 0."""
    reach, layer = values[name], values[f"layer_{name.removeprefix('stroke_')}"]
    if layer > reach:
        raise ValueError(f"its layer of {layer:g} is wider than {name}, {reach:g}")
    return variable(name, reach, [-layer, layer])


def _line(part: str, where: str) -> tuple[Setting, ...]:
    return (
        Setting(f"p_{part}_A_m", 0.0, -1e4, 1e4, f"of |r| where the stroke {where}"),
        Setting(f"q_{part}_A_s_m", 10.0, -1e3, 1e3, "likewise of |v_r|"),
        Setting(f"r_{part}_A", 0.0, -20.0, 20.0, "likewise a constant"),
    )


RECIPE = Recipe(
    "tsk",
    "Takagi-Sugeno-Kang: straight lines of the stroke and its velocity in fuzzy regions",
    "review, by name (fuzzy neural networks)",
    "",
    (
        *_line("outward", "grows"),
        *_line("back", "comes back"),
        Setting("stroke_m", 0.05, 1e-6, 1.0, "largest stroke that counts", is_tuned=False),
        Setting("stroke_m_s", 1.0, 1e-4, 10.0, "likewise its velocity", is_tuned=False),
        Setting("layer_m", 0.0005, 1e-7, 1.0, "where the stroke's sign is sure", is_tuned=False),
        Setting("layer_m_s", 0.01, 1e-5, 10.0, "likewise its velocity's", is_tuned=False),
    ),
    make,
    equation="I = sum of w_i (p_i |r| + q_i |v_r| + r_i), sum of w_i 1; i: the stroke grows, or "
    "comes back, alike both ways",
    errata="The review prints no equation, and p r + q v_r without regions of both signs would "
    "treat the two ways of a symmetric structure differently.",
    when="p, q and r from a search, or a rule base that was trained elsewhere (quiesce law rules).",
)
