"""What a campaign varies: a factor is one dimension of its design."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from quiesce.base.errors import UsageError

# How a number meets the value that is in the file.
SET, TIMES, PLUS = "set", "times", "plus"
# A normal one is drawn between these quantiles: no draw is infinite.
CUT = 1e-9


@dataclass(frozen=True)
class Assignment:
    """A key, from where it is in the campaign, and what happens to its value."""

    key: str
    value: Any
    how: str = SET

    def changed(self, old: Any) -> Any:
        """UsageError where there is no number to change. An array changes in all its numbers."""
        if self.how == SET:
            return self.value
        if isinstance(old, list) and old:
            return [self.changed(item) for item in old]
        if isinstance(old, bool) or not isinstance(old, int | float):
            raise UsageError(f"{self.key}: there is no number in the file, which {self.how} needs")
        return old * self.value if self.how == TIMES else old + self.value


@dataclass(frozen=True)
class Level:
    """A value of a factor: what it is called in tables, and what it sets."""

    label: Any  # a number or a text
    sets: tuple[Assignment, ...]


@dataclass(frozen=True)
class Choices:
    """One of some. is_crossed: every sample is run with each of them."""

    name: str
    levels: tuple[Level, ...]
    is_crossed: bool = False

    def at(self, share: float) -> Level:
        """share: 0 .. 1."""
        return self.levels[min(int(share * len(self.levels)), len(self.levels) - 1)]


@dataclass(frozen=True)
class Spread:
    """A number between low and high, uniform in itself or in its logarithm; or, where is_normal,
    with mean low and standard deviation high."""

    name: str
    key: str
    low: float
    high: float
    how: str = SET
    is_log: bool = False
    is_normal: bool = False
    is_whole: bool = False

    def at(self, share: float) -> Level:
        value = self._value(share)
        whole = min(math.floor(value), int(self.high)) if self.is_whole else value
        return Level(whole, (Assignment(self.key, whole, self.how),))

    def _value(self, share: float) -> float:
        if self.is_normal:
            from scipy.special import ndtri

            return float(self.low + self.high * ndtri(min(max(share, CUT), 1.0 - CUT)))
        if self.is_log:
            return self.low * (self.high / self.low) ** share
        # A whole number has as much room as any other.
        return self.low + (self.high - self.low + self.is_whole) * share


Factor = Choices | Spread


def level_of(key: str, value: Any, how: str) -> Level:
    """Of a value by itself: a number or a text is its own label, what nests is told as JSON."""
    plain = isinstance(value, int | float | str) and not isinstance(value, bool)
    label = value if plain else json.dumps(value, separators=(",", ":"))
    return Level(label, (Assignment(key, value, how),))


def evenly(spread: Spread, count: int) -> Choices:
    """So many levels from low to high, for a grid."""
    shares: Sequence[float] = [i / (count - 1) for i in range(count)] if count > 1 else [0.5]
    return Choices(spread.name, tuple(spread.at(share) for share in shares), True)
