"""Every law that can be run: each recipe with each tracker that it can have, and the laws that are
no recipe's, all of them from the registries."""

import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.engine.laws import labels
from quiesce.engine.params import parameters
from quiesce.law.recipe import Made, Recipe
from quiesce.law.recipes import RECIPES
from quiesce.law.tables import FORMS
from quiesce.table.file import read_words

from quiesce_benchmarks.laws import made_up_networks, rigs

# A damper's map that fits no rig: what a tracker costs does not depend on that.
MAP_DAMPER, MAP_MOST_A = "rd1005_kwok_tanh_smooth", 1.88
RIGS = (rigs.BUILDING, rigs.CAR, rigs.TWO_MASSES)
# The most elements and currents that there are.
BANK_DAMPER, BANK_MOST_A = "spencer_prototype", 2.25
NO_WORDS: tuple[int, ...] = ()
# Tables of laws that neither ship one nor have a recipe.
MADE_UP = {"network": made_up_networks.law_words}


@dataclass(frozen=True)
class LawCase:
    """words: of the law's table; map_words: of its tracker's. Empty: none, or what ships."""

    name: str  # of the recipe, or of the law
    law: str
    tracker: str  # "": the law demands currents
    rig: str
    words: tuple[int, ...]
    map_words: tuple[int, ...]

    @property
    def label(self) -> str:
        return f"{self.name}, {self.tracker}" if self.tracker else self.name


def made_anywhere(recipe: Recipe) -> Made:
    """On the first of the rigs that allows it. UsageError of the last one where none does."""
    return rigs.made(rig_of(recipe), recipe.name)


def rig_of(recipe: Recipe) -> str:
    """The first of RIGS that allows it; the last where none does."""
    for rig in RIGS[:-1]:
        try:
            rigs.made(rig, recipe.name)
        except UsageError:
            continue
        return rig
    return RIGS[-1]


def forms() -> list[str]:
    """Laws that are a table of a recipe, by label."""
    names = [form.__name__.rpartition(".")[2] for form in FORMS.values()]
    return [name for name in names if name not in MADE_UP]


def built_in() -> list[str]:
    """Laws that no recipe makes."""
    return [label for label in labels() if label not in forms()]


def trackers() -> list[str]:
    return next(list(one["labels"]) for one in parameters() if one["name"] == "tracker")


@cache
def map_words(tracker: str) -> tuple[int, ...]:
    """Of the table that a tracker works with, made here; none of one that works without, or whose
    table nobody has made yet: the run then says so."""
    if tracker == "network":
        return tuple(made_up_networks.tracker_words())
    if tracker == "bank":
        return tuple(rigs.bank_of(BANK_DAMPER, BANK_MOST_A))
    if tracker != "inverse":
        return NO_WORDS
    with tempfile.TemporaryDirectory(prefix="quiesce-laws-") as folder:
        return tuple(read_words(rigs.map_of(Path(folder), MAP_DAMPER, MAP_MOST_A)))


def of_recipe(recipe: Recipe) -> list[LawCase]:
    """With its own tracker first, then with the others."""
    table, rig = made_anywhere(recipe).table, rig_of(recipe)
    words = tuple(table.words())
    if table.demands != "force":
        return [LawCase(recipe.name, table.law, "", rig, words, NO_WORDS)]
    own = recipe.tracker or trackers()[0]
    return [
        LawCase(recipe.name, table.law, tracker, rig, words, map_words(tracker))
        for tracker in (own, *(one for one in trackers() if one != own))
    ]


def of_label(label: str) -> LawCase:
    """With the table that ships, or made up where a law has neither that nor a recipe."""
    words = tuple(MADE_UP[label]()) if label in MADE_UP else NO_WORDS
    return LawCase(label, label, "", rigs.BUILDING, words, NO_WORDS)


def all_cases() -> list[list[LawCase]]:
    """A list a law: its own tracker first."""
    return [*([of_label(label)] for label in built_in()), *map(of_recipe, RECIPES)]
