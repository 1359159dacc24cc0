"""Which models `identify` tries, and how each is set up for the data.

Published models: parameters up to quadratic in the command, as far as the data have levels, and the
coil's lag where the command is switched. Networks (viscoplastic_N): parameters linear in the
effective current of the field law; each starts from the fit of the one with an element less.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from quiesce.base.errors import UsageError
from quiesce.damper.data.split import Segment, is_switched, levels_of
from quiesce.damper.fit.setting import Setting, nodes_of
from quiesce.damper.learned import MODELS
from quiesce.damper.library import RIG, model, models

NETWORK = "viscoplastic_"
GREY_BOX = "grey_box"
QUICK = ("kwok_tanh", "zhang_tanh", "normalised_bouc_wen", "viscoplastic_1", "viscoplastic_2")
MOST_PASSIVE = 3
MOST_ELEMENTS = 4
# Ginder's exponent of particles in a field below saturation: with few levels the data do not tell.
FIELD_EXPONENT = 1.5
LEVELS_FOR_EXPONENT = 5
# Two constant levels tell nothing of what lies between them.
LEVELS_FOR_SATURATION = 3


@dataclass(frozen=True)
class Choice:
    """What the user says about parameters; names that a model does not have are left out."""

    fixed: Mapping[str, float] = field(default_factory=dict)
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    rig: tuple[str, ...] | None = None  # None: chosen by the data
    most_coefficients: int = 3  # against the current
    method: str = "default"  # or of papers: "ga", "ga-plain", "de", and those of base.searches


@dataclass(frozen=True)
class Candidate:
    """A model as it is fitted."""

    name: str
    model: str
    is_passive: bool = False  # held passive by bounds


def network_candidates() -> list[Candidate]:
    """One chain: passive networks, then the largest with a stiffness of either sign."""
    passive = [
        Candidate(f"{NETWORK}{n}", f"{NETWORK}{n}", True) for n in range(1, MOST_PASSIVE + 1)
    ]
    free = [
        Candidate(f"{NETWORK}{n}_free", f"{NETWORK}{n}")
        for n in range(MOST_PASSIVE, MOST_ELEMENTS + 1)
    ]
    return [*passive, *free]


def parametric_candidates() -> dict[str, Candidate]:
    """By name: every kernel, networks in the order in which they grow."""
    published = [Candidate(name, name) for name in models() if not name.startswith(NETWORK)]
    return {one.name: one for one in [*published, *network_candidates()]}


def all_names() -> list[str]:
    return [*parametric_candidates(), *MODELS, GREY_BOX]


def is_told(name: str) -> bool:
    return name in models() and bool(models()[name].told)


def names_of(text: str) -> list[str]:
    """Of names and groups with commas; groups have no model that has to be told a geometry.
    UsageError, with the names that there are, for one that is not."""
    groups = {
        "quick": list(QUICK),
        "parametric": [name for name in parametric_candidates() if not is_told(name)],
        "all": [name for name in all_names() if not is_told(name)],
    }
    names: list[str] = []
    for word in text.split(","):
        names += groups.get(word, [word])
    known = all_names()
    for name in names:
        if name not in known:
            raise UsageError(f"no model '{name}'; there are {', '.join([*groups, *known])}")
    return list(dict.fromkeys(names))


def rig_of(candidate: Candidate, segments: Sequence[Segment], choice: Choice) -> tuple[str, ...]:
    """What around the model is fitted."""
    lag = ("rise_s", "fall_s") if is_switched(segments) else ()
    rig: tuple[str, ...] = ("inertia_kg", "skew_s", *lag) if choice.rig is None else choice.rig
    if not has_offset(candidate.model) and choice.rig is None:
        rig += ("offset_N",)
    levels, switched = len(levels_of(segments)), is_switched(segments)
    has_between = switched or levels >= LEVELS_FOR_SATURATION
    if candidate.model.startswith(NETWORK) and len(nodes_of(segments, 2)) > 1 and has_between:
        rig += ("field_saturation",)
        if switched or levels >= LEVELS_FOR_EXPONENT:
            rig += ("field_exponent",)
    return tuple(name for name in rig if name not in choice.fixed)


def has_offset(model_name: str) -> bool:
    return any(one.name == "f0_N" for one in model(model_name).parameters)


def setting_of(candidate: Candidate, segments: Sequence[Segment], choice: Choice) -> Setting:
    """The model of a candidate set up for these segments."""
    one = model(candidate.model)
    known = {parameter.name for parameter in one.parameters}
    rig = rig_of(candidate, segments, choice)
    fixed = {name: value for name, value in choice.fixed.items() if name in known or name in RIG}
    bounds = {name: value for name, value in choice.bounds.items() if name in known or name in rig}
    most = min(choice.most_coefficients, 2 if candidate.model.startswith(NETWORK) else 3)
    nodes = nodes_of(segments, most)
    if "field_saturation" in rig:
        nodes = (0.0, nodes[-1])
        fixed["field_ref_A"] = nodes[-1]
        if "field_exponent" not in rig:
            fixed.setdefault("field_exponent", FIELD_EXPONENT)
    elif "field_exponent" in rig or "field_exponent" in fixed:
        fixed.setdefault("field_ref_A", max(abs(nodes[-1]), 1e-6))
    elif is_switched(segments) and most == 3 and len(nodes) > 1:
        # While the coil's current moves it passes every level in between.
        nodes = (nodes[0], 0.5 * (nodes[0] + nodes[-1]), nodes[-1])
    if candidate.is_passive:
        low, high = bounds.get("k_N_m", (0.0, 1e15))
        bounds["k_N_m"] = (max(low, 0.0), high)
    return Setting(one, nodes, fixed=fixed, bounds=bounds, rig=rig)
