"""What recipes share: systems without states from gains, and sections of signs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.law.block import Compiled, System, compile_system
from quiesce.law.forms.signs import SignsSection, SignsTable, combination
from quiesce.law.recipe import Setting
from quiesce.law.rig import Damper, LawRig
from quiesce.law.signal import Input

LIMIT_N = Setting("limit_N", 1e4, 0.001, 1e6, "largest force that is demanded of a damper")
ON_A = Setting("on_A", 20.0, 0.0, 20.0, "current where it is on; the damper's ceiling bounds it")
OFF_A = Setting("off_A", 0.0, 0.0, 20.0, "current where it is off")
BAND_m_s = Setting(
    "band_m_s", 0.001, 0.0, 10.0, "a velocity's sign changes only beyond it: noise must not switch"
)

Place = tuple[str, int]  # a quantity, and its body or damper


@dataclass(frozen=True)
class Part:
    """gains: N for 1 of each signal in SI units; limited by itself."""

    damper: int
    gains: dict[Place, float]
    limit_N: float


def static_forces(rig: LawRig, parts: Sequence[Part]) -> Compiled:
    """A linear law without a memory."""
    places = list(dict.fromkeys(place for part in parts for place in part.gains))
    inputs = [rig.input(*place) for place in places]
    d = np.array([[part.gains.get(place, 0.0) for place in places] for part in parts])
    none = np.zeros((0, 0))
    system = System(none, np.zeros((0, len(places))), np.zeros((len(parts), 0)), d)
    return compile_system(system, inputs, [(p.damper, p.limit_N) for p in parts], rig.rate_Hz)


@dataclass(frozen=True)
class Sign:
    """On where the sum of factors x signals is above band, in the unit of that sum."""

    factors: dict[Place, float]
    band: float


def section(
    rig: LawRig, damper: Damper, signs: Sequence[Sign], currents_A: Sequence[float], idle_A: float
) -> SignsSection:
    """currents_A by the number whose bit j is sign j; none is above the damper's ceiling."""
    places = list(dict.fromkeys(place for sign in signs for place in sign.factors))
    inputs: list[Input] = [rig.input(*place) for place in places]
    combinations = tuple(
        combination(inputs, [sign.factors.get(place, 0.0) for place in places], sign.band)
        for sign in signs
    )
    currents = tuple(min(round(1e3 * a), damper.ceiling_mA) for a in currents_A)
    return SignsSection(
        tuple(inputs), combinations, min(round(1e3 * idle_A), damper.ceiling_mA), currents
    )


def alike(rig: LawRig, values: dict[str, float], pairs: Sequence[tuple[Sign, Sign]]) -> SignsTable:
    """For each damper: on where both signs are the same, off where they differ, and until known."""
    on, off = values["on_A"], values["off_A"]
    return SignsTable(
        tuple(
            section(rig, damper, pair, (on, off, off, on), off)
            for damper, pair in zip(rig.dampers, pairs, strict=True)
        )
    )


def both_ends(rig: LawRig) -> None:
    """ValueError where a damper stands on the ground: the law is for what moves at both ends."""
    for damper in rig.dampers:
        if damper.b is None:
            raise ValueError(f"damper {damper.name} stands on the ground; it has no lower body")


def within_ceiling_A(rig: LawRig, current_A: float) -> float:
    """Not above what any of its dampers may take; rules are for all dampers alike."""
    return min(current_A, 1e-3 * max(damper.ceiling_mA for damper in rig.dampers))
