"""What a search goes over: settings of a recipe, the gain of its tracker, parameters that are
asked for."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.engine.params import parameters
from quiesce.law.recipe import Recipe
from quiesce.law.rig import LawRig
from quiesce.tune.gains.ranges import Range, range_of, tracker_range

LOG_RATIO = 100.0  # of bounds above 0, from which on a range is on a log scale
DIGITS = 4  # that a value is rounded to: what is printed is what was tried
TRACKER_GAIN = "tracker_gain_mA_kN"
PROPORTIONAL = "proportional"


@dataclass(frozen=True)
class Dimension:
    """A number between low and high; it is not searched where they are equal."""

    name: str
    default: float
    low: float
    high: float
    allowed: Range
    is_whole: bool = False
    is_parameter: bool = False  # of the controller, beside the law's table

    @property
    def is_searched(self) -> bool:
        return self.low < self.high

    @property
    def is_log(self) -> bool:
        return self.low > 0 and self.high / self.low > LOG_RATIO

    def value(self, unit: float) -> float:
        """Of 0 .. 1."""
        if self.is_log:
            found = self.low * (self.high / self.low) ** unit
        else:
            found = self.low + (self.high - self.low) * unit
        rounded = round(found) if self.is_whole else float(f"{found:.{DIGITS}g}")
        return float(min(max(rounded, self.low), self.high))

    def unit(self, value: float) -> float:
        """The place of a value in 0 .. 1; of one outside the nearer end."""
        inside = min(max(value, self.low), self.high)
        if self.is_log:
            return float(np.log(inside / self.low) / np.log(self.high / self.low))
        return (inside - self.low) / (self.high - self.low)


@dataclass(frozen=True)
class Space:
    """known: all numbers that there are, in order; start: values of the first trial."""

    known: tuple[Dimension, ...]
    start: dict[str, float]

    @property
    def searched(self) -> tuple[Dimension, ...]:
        return tuple(one for one in self.known if one.is_searched)

    def values(self, point: np.ndarray) -> dict[str, float]:
        """Of a point in the unit cube of what is searched."""
        found = {one.name: one.value(float(x)) for one, x in zip(self.searched, point, strict=True)}
        return {**self.start, **found}

    def point(self, values: Mapping[str, float]) -> np.ndarray:
        return np.array([one.unit(values[one.name]) for one in self.searched])

    def settings(self, values: Mapping[str, float]) -> dict[str, float]:
        """Of the recipe."""
        return {one.name: values[one.name] for one in self.known if not one.is_parameter}

    def parameters(self, values: Mapping[str, float]) -> dict[str, int]:
        """Of the controller."""
        return {one.name: round(values[one.name]) for one in self.known if one.is_parameter}


def space_of(
    recipe: Recipe, rig: LawRig, tracker: str, fixed: Sequence[str] = (), asked: Sequence[str] = ()
) -> Space:
    """fixed: words NAME=VALUE, not searched; asked: words NAME=LOW:HIGH, searched there.

    UsageError where a word names nothing that there is, or no value or range of it.
    """
    known = {
        one.name: Dimension(
            one.name, one.default, *range_of(one, rig), (one.low, one.high), one.is_whole
        )
        for one in recipe.settings
    }
    if tracker == PROPORTIONAL:
        known[TRACKER_GAIN] = _tracker_gain(rig)
    start: dict[str, float] = {}
    named: list[str] = []
    for option, words in (("--fix", fixed), ("--search", asked)):
        for word in words:
            name, _, text = word.partition("=")
            told = f"{option} {word}"
            one = known.get(name) or _parameter(told, name, recipe)
            if name in named:
                raise UsageError(f"{told}: {name} is named twice")
            named.append(name)
            if option == "--fix":
                start[name] = _number(told, text, one)
                known[name] = replace(one, low=start[name], high=start[name])
            else:
                low, high = _asked_range(told, text, one)
                known[name] = replace(one, low=low, high=high)
    values = {name: start.get(name, one.default) for name, one in known.items()}
    return Space(tuple(known.values()), values)


def _number(told: str, text: str, one: Dimension) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    low, high = one.allowed
    if not low <= value <= high or (one.is_parameter and value != round(value)):
        what = "an integer" if one.is_parameter else "a number"
        raise UsageError(f"{told}: expected {what} in {low:g} .. {high:g}")
    return value


def _asked_range(told: str, text: str, one: Dimension) -> Range:
    ends = text.split(":")
    if len(ends) != 2:
        raise UsageError(f"{told}: expected NAME=LOW:HIGH")
    low, high = (_number(told, end, one) for end in ends)
    if not low < high:
        raise UsageError(f"{told}: an empty range; expected a low end below the high one")
    return low, high


def _tracker_gain(rig: LawRig) -> Dimension:
    """It starts at the middle of its range: the parameter's default is next to all or nothing."""
    one = _parameter(TRACKER_GAIN, TRACKER_GAIN, None)
    wanted = tracker_range(rig)
    if wanted is None:
        return replace(one, low=one.allowed[0], high=one.allowed[1])
    low, high = (float(round(min(max(x, one.allowed[0]), one.allowed[1]))) for x in wanted)
    return replace(one, default=float(round((low * high) ** 0.5)), low=low, high=high)


def _parameter(told: str, name: str, recipe: Recipe | None) -> Dimension:
    """Of the controller, not searched."""
    for one in parameters():
        if one["name"] == name and not one["labels"] and not one["choices"]:
            default = float(one["default"])
            allowed = float(one["min"]), float(one["max"])
            return Dimension(name, default, default, default, allowed, True, True)
    settings = ", ".join(one.name for one in recipe.settings) if recipe else ""
    raise UsageError(
        f"{told}: '{name}' is neither a setting of the recipe ({settings or 'it has none'}) nor a "
        "parameter that is a number (quiesce params)"
    )
