"""What of a model is fitted: current laws, fixed values, bounds, and what of the rig."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.data.split import Segment, levels_of, same_within
from quiesce.damper.library import RIG, Model

MAX_ORDER = 3


@dataclass(frozen=True)
class Setting:
    """A model to fit. Parameters that follow the current are described by their values at
    `nodes_A` (1 to 3 currents: constant, linear, quadratic in between)."""

    model: Model
    nodes_A: tuple[float, ...]
    constant: frozenset[str] = frozenset()  # parameters that do not follow the current after all
    fixed: Mapping[str, float] = field(default_factory=dict)  # by name, rig included
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)  # SI, any name
    rig: tuple[str, ...] = ()  # free values of RIG; the others are 0 or fixed

    def __post_init__(self) -> None:
        known = {one.name for one in self.model.parameters} | set(RIG)
        for name in [*self.constant, *self.fixed, *self.bounds, *self.rig]:
            if name not in known:
                raise UsageError(
                    f"model {self.model.name} has no parameter '{name}'; it has "
                    f"{', '.join(one.name for one in self.model.parameters)} "
                    f"and, around it, {', '.join(RIG)}"
                )
        for one in self.model.parameters:
            value = self.fixed.get(one.name)
            if value is not None and not one.min <= value <= one.max:
                raise UsageError(
                    f"{one.name} = {value:g}: model {self.model.name} allows "
                    f"{one.min:g} .. {one.max:g} {one.unit}"
                )
        untold = [one for one in self.model.told if one.name not in {*self.fixed, *self.bounds}]
        if untold:
            raise UsageError(
                f"model {self.model.name} does not find its geometry; state "
                + ", ".join(f"{one.name} ({one.text})" for one in untold)
                + f", such as --fix {untold[0].name}=VALUE"
            )
        for name, (low, high) in self.bounds.items():
            if not low < high:
                raise UsageError(f"bounds of {name}: the first has to be below the second")

    @property
    def orders(self) -> list[int]:
        """Coefficients against the current, for every parameter of the model."""
        return [
            len(self.nodes_A)
            if one.follows_current and one.name not in self.constant and one.name not in self.fixed
            else 1
            for one in self.model.parameters
        ]


def nodes_of(segments: Sequence[Segment], most: int = MAX_ORDER) -> tuple[float, ...]:
    """Currents at which parameters are described: the ends of what the segments hold, and the
    middle where there are three levels or more. One level, or most = 1: one node."""
    levels = levels_of(segments)
    if any(segment.record.level is None for segment in segments):
        commands = np.concatenate([segment.record.command for segment in segments])
        low, high = np.quantile(commands, [0.02, 0.98])
        if high - low <= same_within(high):  # but for moments: one level
            return (float(low),)
        levels = [float(low), float(high)]
        middle = np.mean(
            (commands > low + 0.2 * (high - low)) & (commands < high - 0.2 * (high - low))
        )
        if middle > 0.2:  # the command is not just switched between its ends
            levels.insert(1, float(0.5 * (low + high)))
    count = min(most, len(levels), MAX_ORDER)
    if count <= 1:
        return (float(np.mean(levels)),)
    if count == 2:
        return (levels[0], levels[-1])
    return (levels[0], float(0.5 * (levels[0] + levels[-1])), levels[-1])


def law_matrix(nodes_A: Sequence[float]) -> np.ndarray:
    """Coefficients (ascending powers of A) from values at the nodes: [nodes, nodes]."""
    return np.linalg.inv(np.vander(np.asarray(nodes_A, dtype=float), increasing=True))
