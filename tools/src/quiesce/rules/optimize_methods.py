"""The search methods by name, with what the command line says of them."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from quiesce.rules import optimize_de, optimize_ga, optimize_nsga2
from quiesce.rules.optimize_de import DeSettings
from quiesce.rules.optimize_ga import GaSettings
from quiesce.rules.optimize_genes import Genome
from quiesce.rules.optimize_nsga2 import NsgaSettings
from quiesce.rules.optimize_search import Search

GA, DE, NSGA2 = "ga", "de", "nsga2"
METHODS = (GA, DE, NSGA2)

Settings = GaSettings | DeSettings | NsgaSettings


def method_settings(method: str, population: int | None, selection: str) -> Settings:
    size = {} if population is None else {"population": population}
    if method == GA:
        return GaSettings(selection=selection, **size)
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
    return optimize_nsga2.search(levels, first, settings, rng)
