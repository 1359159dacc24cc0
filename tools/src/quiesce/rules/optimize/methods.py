"""The search methods by name, with what the command line says of them."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from quiesce.base.searches.names import NAMES
from quiesce.rules.optimize import de as optimize_de
from quiesce.rules.optimize import ga as optimize_ga
from quiesce.rules.optimize import named as optimize_named
from quiesce.rules.optimize import nsga2 as optimize_nsga2
from quiesce.rules.optimize.de import DeSettings
from quiesce.rules.optimize.ga import GaSettings
from quiesce.rules.optimize.genes import Genome
from quiesce.rules.optimize.named import NamedSettings
from quiesce.rules.optimize.nsga2 import NsgaSettings
from quiesce.rules.optimize.search import Search

GA, DE, NSGA2 = "ga", "de", "nsga2"
METHODS = (GA, DE, NSGA2, *NAMES)

Settings = GaSettings | DeSettings | NsgaSettings | NamedSettings


def method_settings(method: str, population: int | None, selection: str) -> Settings:
    size = {} if population is None else {"population": population}
    if method == GA:
        return GaSettings(selection=selection, **size)
    if method in NAMES:
        return NamedSettings(method, **size)
    return DeSettings(**size) if method == DE else NsgaSettings(**size)


def settings_json(method: str, settings: Settings) -> dict[str, Any]:
    return {"method": method, **asdict(settings)}


def make_search(
    levels: Sequence[int], first: Genome, settings: Settings, rng: np.random.Generator
) -> Search:
    if isinstance(settings, GaSettings):
        return optimize_ga.search(levels, first, settings, rng)
    if isinstance(settings, DeSettings):
        return optimize_de.search(levels, first, settings, rng)
    if isinstance(settings, NamedSettings):
        return optimize_named.search(levels, first, settings, rng)
    return optimize_nsga2.search(levels, first, settings, rng)
