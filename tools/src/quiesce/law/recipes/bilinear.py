"""A current that is a quadratic form of what a damper's ends do: feedback of bilinear systems."""

from itertools import combinations_with_replacement

from quiesce.law.forms.polynomial import PolynomialSection, PolynomialTable, term
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import both_ends
from quiesce.law.rig import LawRig
from quiesce.law.signal import Input

# Signals by short names, and where they are cut off, in SI units: what is small is told finely.
SIGNALS = {
    "accel": ("acceleration", 30.0),  # of end a
    "velocity": ("velocity", 2.0),
    "lower_accel": ("acceleration", 120.0),  # of end b
    "rate": ("stroke velocity", 2.0),
}
ACCELS = ("accel", "lower_accel")
PAIRS = tuple(combinations_with_replacement(SIGNALS, 2))


def _name(pair: tuple[str, str]) -> str:
    """With its unit: s^2/m^2 and one s more for each acceleration."""
    seconds = 2 + sum(one in ACCELS for one in pair)
    words = f"{pair[0]}_squared" if pair[0] == pair[1] else f"{pair[0]}_{pair[1]}"
    return f"{words}_A_s{seconds}_m2"


def make(rig: LawRig, values: dict[str, float]) -> PolynomialTable:
    both_ends(rig)
    return PolynomialTable(tuple(_section(rig, values, i) for i in range(len(rig.dampers))))


def _section(rig: LawRig, values: dict[str, float], i: int) -> PolynomialSection:
    damper = rig.dampers[i]
    assert damper.b is not None
    places = (damper.a, damper.a, damper.b, i)
    inputs = tuple(
        Input.of(rig.input(quantity, at).signal, limit)
        for (quantity, limit), at in zip(SIGNALS.values(), places, strict=True)
    )
    terms = [term(inputs, (0, 0, 0, 0), values["offset_A"])]
    for pair in PAIRS:
        if values[_name(pair)]:
            powers = [pair.count(name) for name in SIGNALS]
            terms.append(term(inputs, powers, values[_name(pair)]))
    return PolynomialSection(inputs, (False,) * len(inputs), tuple(terms))


RECIPE = Recipe(
    "bilinear",
    "I = i0 + y' Q y, y: acceleration and velocity of end a, acceleration of end b, v_r",
    "Gutman 1981: of a bilinear system u = -k x' P N x; Q from a search here. v_r led by the ends' "
    "accelerations is in it, and offset_A below 0 asks for a current late",
    "",
    (
        Setting("offset_A", -0.5, -20.0, 20.0, "i0"),
        *(
            Setting(
                _name(pair), 100.0 if pair == ("velocity", "rate") else 0.0, -1e3, 1e3,
                f"of {pair[0].replace('_', ' ')} x {pair[1].replace('_', ' ')}",
            )
            for pair in PAIRS
        ),
    ),
    make,
    equation="I = i0 + y' Q y, 0 .. 20 A",
    when="A vehicle's suspension, for comfort; gains from a search. It wants low corners: "
    "velocity_cutoff_mHz 100, dc_cutoff_mHz 20.",
)  # fmt: skip
