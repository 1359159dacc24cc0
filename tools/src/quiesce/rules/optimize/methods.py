"""The search methods by name, with what the command line says of them."""

from dataclasses import dataclass

from quiesce.base.searches.names import NAMES

GA, DE, NSGA2 = "ga", "de", "nsga2"
METHODS = (GA, DE, NSGA2, *NAMES)
ROULETTE, TOURNAMENT = "roulette", "tournament"
SELECTIONS = (TOURNAMENT, ROULETTE)

POPULATION, NSGA2_POPULATION = 24, 40
# The papers give no figures; these are ours.
CROSSOVER, NSGA2_CROSSOVER = 0.8, 0.9


@dataclass(frozen=True)
class Settings:
    method: str
    population: int
    selection: str | None = None  # of the genetic algorithm
    crossover: float | None = None  # of searches over bits


def method_settings(method: str, population: int | None, selection: str) -> Settings:
    """population: None for the method's own."""
    if method == GA:
        return Settings(method, population or POPULATION, selection, CROSSOVER)
    if method == NSGA2:
        return Settings(method, population or NSGA2_POPULATION, crossover=NSGA2_CROSSOVER)
    return Settings(method, population or POPULATION)
