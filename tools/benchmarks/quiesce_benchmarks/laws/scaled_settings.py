"""Settings of a recipe for a rig of another size: scaled by their units, then tried at random, the
same number of times for every recipe."""

import re
from dataclasses import dataclass

import numpy as np
from quiesce.law.recipe import Recipe, Setting

UNIT = re.compile(r"^(N|m|s|A|Hz|kg|1)(\d?)$")
DECADES = 1.5  # either way of the scaled value
CHANCE = 0.5  # that a switch, a share, a current, or what is 0 by default is moved at all

Exponents = dict[str, int]


@dataclass(frozen=True)
class Sizes:
    """What is usual on a rig: a force, a motion, a time of it, a current."""

    N: float
    m: float
    s: float
    A: float

    def of(self, unit: Exponents) -> float:
        base = {"N": self.N, "m": self.m, "s": self.s, "A": self.A, "Hz": 1.0 / self.s,
                "kg": self.N * self.s**2 / self.m}  # fmt: skip
        return float(np.prod([base[name] ** power for name, power in unit.items()]))


def unit_of(name: str) -> Exponents:
    """By the end of a name, where the last of several units is what it is divided by: sky_N_s_m is
    N s/m. Empty: a share, a switch."""
    found: list[tuple[str, int]] = []
    for word in reversed(name.split("_")):
        match = UNIT.match(word)
        if match is None:
            break
        found.insert(0, (match[1], int(match[2] or 1)))
    exponents: Exponents = {}
    for place, (unit, power) in enumerate(found):
        is_below = len(found) > 1 and place == len(found) - 1
        exponents[unit] = exponents.get(unit, 0) + (-power if is_below else power)
    exponents.pop("1", None)
    return {unit: power for unit, power in exponents.items() if power}


def bounded(setting: Setting, value: float) -> float:
    return float(np.clip(value, setting.low, setting.high))


def scaled(setting: Setting, here: Sizes, there: Sizes) -> float:
    """Its default, which suits a rig of the sizes `there`."""
    unit = unit_of(setting.name)
    return bounded(setting, setting.default * here.of(unit) / there.of(unit))


def drawn(setting: Setting, here: Sizes, there: Sizes, rng: np.random.Generator) -> float:
    """Around the scaled default; where that is 0 around the rig's own size, either sign."""
    unit = unit_of(setting.name)
    start = scaled(setting, here, there)
    spread, chance = 10.0 ** rng.uniform(-DECADES, DECADES), rng.random()
    inside, sign = rng.random(), rng.choice([-1.0, 1.0])
    if unit and unit != {"A": 1} and start != 0.0:
        return bounded(setting, start * spread)
    if chance >= CHANCE:
        return start
    if not unit:
        return setting.low + inside * (setting.high - setting.low)
    size = inside * 2.0 * here.A if unit == {"A": 1} else here.of(unit) * spread
    return bounded(setting, size * (sign if setting.low < 0.0 else 1.0))


def trials(
    recipe: Recipe, here: Sizes, there: Sizes, count: int, seed: int
) -> list[dict[str, float]]:
    """Settings to try: first the scaled defaults, then drawn ones; the same for the same seed."""
    rng = np.random.default_rng([seed, *recipe.name.encode()])
    first = {one.name: scaled(one, here, there) for one in recipe.settings}
    others = [
        {one.name: drawn(one, here, there, rng) for one in recipe.settings}
        for _ in range(count - 1)
    ]
    return [first, *others]
