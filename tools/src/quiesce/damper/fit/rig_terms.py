"""Mass and skew around a damper model: taken in only where the data determine them and a rig may
have them.

Both mimic what a model lacks: a hysteresis that a static model has not looks like a late force, a
stiffness like a mass. So a model is fitted without them first. They are then tried from there, and
stay where their 95 % interval is at most half of the value on either side and the value is one
that a rig may have.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from quiesce.damper.data.split import Segment
from quiesce.damper.fit.intervals import intervals
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.setting import Setting
from quiesce.damper.library import Scales

MASS, SKEW = "inertia_kg", "skew_s"
DOUBTFUL = (MASS, SKEW)

# Unless the user says otherwise: a mass that weighs a tenth of the largest force, 2 ms or three
# rows of skew.
_WEIGHT_PART = 0.1
_GRAVITY_m_s2 = 9.80665
_SKEW_s = 2e-3
_SKEW_ROWS = 3.0
# Half of the 95 % interval over the value, at most.
_KNOWN = 0.5
# Of the acceleration's square, what must not be in proportion to the displacement: at one
# frequency a mass is a negative stiffness.
_OTHER_THAN_STIFFNESS = 0.05


@dataclass(frozen=True)
class Verdict:
    """On one term. `note` says in words why one that the data ask for is left out."""

    name: str
    is_kept: bool
    note: str = ""


def limits_for(
    segments: Sequence[Segment], stated: Mapping[str, tuple[float, float]]
) -> dict[str, tuple[float, float]]:
    """Bounds of mass (kg) and skew (s); what the user stated wins."""
    most_kg = _WEIGHT_PART * Scales.of(segments).force_N / _GRAVITY_m_s2
    slowest_Hz = min(one.record.rate_Hz for one in segments)
    most_s = max(_SKEW_s, _SKEW_ROWS / slowest_Hz)
    usual = {MASS: (0.0, most_kg), SKEW: (-most_s, most_s)}
    return {name: stated.get(name, bounds) for name, bounds in usual.items()}


def tells_mass(segments: Sequence[Segment]) -> bool:
    """Whether the acceleration is more than a factor times the displacement. Every test counts as
    its force does."""
    products = np.zeros((2, 2))
    for one in segments:
        record, rows = one.record, one.rows
        pair = np.stack([record.disp_m[rows], record.accel_m_s2[rows]])
        products += pair @ pair.T / max(float(np.sum(record.force_N[rows] ** 2)), 1e-300)
    explained = products[0, 1] ** 2 / max(products[0, 0] * products[1, 1], 1e-300)
    return bool(1.0 - explained >= _OTHER_THAN_STIFFNESS)


def doubtful_terms(setting: Setting) -> tuple[str, ...]:
    """Terms of a setting's rig that have to earn their place; one whose bounds leave zero out is
    known to be there."""
    return tuple(
        name
        for name in DOUBTFUL
        if name in setting.rig and _holds_zero(setting.bounds.get(name, (0.0, 0.0)))
    )


def _holds_zero(bounds: tuple[float, float]) -> bool:
    low, high = bounds
    return low <= 0.0 <= high


def told_terms(names: Sequence[str], segments: Sequence[Segment]) -> tuple[str, ...]:
    """Those that these rows can tell at all."""
    return tuple(name for name in names if name != MASS or tells_mass(segments))


def without(setting: Setting, names: Sequence[str]) -> Setting:
    """names: of the rig; their bounds go, too."""
    bounds = {name: value for name, value in setting.bounds.items() if name not in names}
    rig = tuple(name for name in setting.rig if name not in names)
    return replace(setting, rig=rig, bounds=bounds)


def verdicts(problem: Problem, values: np.ndarray, names: Sequence[str]) -> list[Verdict]:
    """On terms of a fit that was free to use them within their limits."""
    found = {one.name: one for one in intervals(problem, values) if one.name in names}
    return [
        verdict(name, found[name].value, found[name].relative, problem.setting.bounds[name])
        for name in names
    ]


def verdict(name: str, value: float, relative: float, limits: tuple[float, float]) -> Verdict:
    low, high = limits
    edge = 1e-3 * (high - low)
    is_least_mass = name == MASS and value <= low + edge
    if not is_least_mass and (value >= high - edge or value <= low + edge):
        return Verdict(name, False, implausible_text(name, low, high))
    return Verdict(name, bool(np.isfinite(relative)) and relative <= _KNOWN)


def implausible_text(name: str, low: float, high: float) -> str:
    if name == MASS:
        return (
            f"moving mass left out: the data ask for more than {high:.3g} kg, which no rig with "
            "this force is expected to have; if this one has, --rig-mass-kg LOW:HIGH states it"
        )
    return (
        f"skew of the force left out: the data ask for more than {1e3 * max(-low, high):.3g} ms; "
        "if the channels are that far apart, --bound skew_s=LOW:HIGH states it"
    )
