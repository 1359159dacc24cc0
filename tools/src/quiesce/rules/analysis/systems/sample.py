"""Points at which a system is looked at: random ones, and such whose inputs stand at corners."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.rules.analysis.systems.signs import MAYBE, YES
from quiesce.rules.analysis.systems.support import corners, fires_at
from quiesce.rules.system.model import System
from quiesce.rules.system.reference import fired_at

POINTS = 1 << 15
CHUNK = 1 << 12
SEED = 1
SHARE_OF_CORNERS = 0.5  # of each input's places


@dataclass(frozen=True)
class Sample:
    """x: [input, point]. rule_fires: [rule, point], output_fires: [output, point]; by the signs
    where those are certain, else by float64."""

    x: np.ndarray
    rule_fires: np.ndarray
    output_fires: np.ndarray


def draw(system: System, count: int, seed: int = SEED) -> np.ndarray:
    """[input, point] within the universes."""
    rng = np.random.default_rng(seed)
    rows = []
    for variable in system.inputs:
        at = np.array(corners(variable))
        places = np.concatenate([at, 0.5 * (at[1:] + at[:-1])])
        is_corner = rng.random(count) < SHARE_OF_CORNERS
        anywhere = rng.uniform(variable.minimum, variable.maximum, count)
        rows.append(np.where(is_corner, rng.choice(places, count), anywhere))
    return np.array(rows)


def sampled(system: System, count: int = POINTS) -> Sample:
    x = draw(system, count)
    rules, outputs = [], []
    for first in range(0, count, CHUNK):
        part = list(x[:, first : first + CHUNK])
        size = len(part[0])
        signs = fires_at(system, part)
        fired, strengths = fired_at(system, part)
        rules.append([decided(one, strengths[i]) for i, one in enumerate(signs.rules)])
        outputs.append(
            [
                decided(one, np.max([np.zeros(size), *(f.strength for f in fired[i])], axis=0))
                for i, one in enumerate(signs.outputs)
            ]
        )
    return Sample(x, np.concatenate(rules, axis=1), np.concatenate(outputs, axis=1))


def decided(signs: np.ndarray, strength: np.ndarray) -> np.ndarray:
    return np.where(signs == MAYBE, strength > 0.0, signs == YES)


def place_text(system: System, x: Sequence[float]) -> str:
    return ", ".join(
        f"{one.name} = {value:.6g}" for one, value in zip(system.inputs, x, strict=True)
    )
