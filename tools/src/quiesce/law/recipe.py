"""A recipe: a published law as a table for a rig."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from quiesce.base.errors import UsageError
from quiesce.law.block import Compiled
from quiesce.law.rig import LawRig
from quiesce.law.tables import Table


@dataclass(frozen=True)
class Setting:
    """A number that a recipe takes, low .. high.

    A search goes over `search` or, where that is None, over a range made from the rig
    (quiesce.tune.gains.space); not at all where is_tuned is False: a fact about the rig.
    """

    name: str  # with its unit
    default: float
    low: float
    high: float
    help: str
    search: tuple[float, float] | None = None
    is_tuned: bool = True
    is_whole: bool = False  # a switch: a search tries whole numbers only


@dataclass(frozen=True)
class Recipe:
    name: str
    summary: str
    source: str  # "review": the survey among the five papers, "elastomer paper": the fourth
    tracker: str  # what makes currents of its forces well; "" where it demands currents
    settings: tuple[Setting, ...]
    make: Callable[[LawRig, dict[str, float]], Table | Compiled]
    # x, v, a: absolute motion of a body; r, v_r: a damper's stroke and its velocity; F: its force,
    # above 0 where it resists a stroke that grows; indices a, b: of the damper's ends.
    equation: str = ""
    errata: str = ""  # what is wrong in the source; "" where nothing is
    when: str = ""  # to use it


@dataclass(frozen=True)
class Made:
    recipe: Recipe
    values: dict[str, float]
    table: Table
    compiled: Compiled | None  # of a linear system


def values_of(recipe: Recipe, words: Sequence[str]) -> dict[str, float]:
    """Its defaults with name=value words. UsageError where one is wrong."""
    values = {one.name: one.default for one in recipe.settings}
    bounds = {one.name: one for one in recipe.settings}
    for word in words:
        name, _, text = word.partition("=")
        if name not in values:
            known = ", ".join(values) or "none"
            raise UsageError(f"--set {word}: {recipe.name} has no '{name}'; it has: {known}")
        values[name] = _value(word, text, bounds[name])
    return values


def _value(word: str, text: str, setting: Setting) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not setting.low <= value <= setting.high:
        raise UsageError(f"--set {word}: expected a number in {setting.low:g} .. {setting.high:g}")
    return value


def make(recipe: Recipe, rig: LawRig, values: dict[str, float]) -> Made:
    """UsageError, in one line, where rig or values do not allow it."""
    try:
        made = recipe.make(rig, values)
    except ValueError as error:
        raise UsageError(f"{recipe.name}: {error}")
    if isinstance(made, Compiled):
        return Made(recipe, values, made.table, made)
    return Made(recipe, values, made, None)
