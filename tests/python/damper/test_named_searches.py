"""Searches by name: on functions whose least value is known, in identification, in rule search."""

import os
import subprocess
import sys

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.searches import bees as bee_colony
from quiesce.base.searches.methods import METHODS
from quiesce.damper.fit import named
from quiesce.damper.fit.named import fit_named
from quiesce.damper.fit.population import values_of
from quiesce.rules.optimize.methods import method_settings
from quiesce.rules.optimize.search import make_search
from test_damper_published_fits import small_problem

TRIALS = 4000


def sphere(points: np.ndarray) -> np.ndarray:
    return np.sum((points - 0.37) ** 2, axis=1)


def rastrigin(points: np.ndarray) -> np.ndarray:
    """0 at 0.37; a local minimum every 0.1."""
    x = 10.24 * (points - 0.37)
    return np.sum(x**2 - 10.0 * np.cos(2.0 * np.pi * x) + 10.0, axis=1)


def best_of(name: str, function, seed: int, dimensions: int = 4) -> float:
    rng = np.random.default_rng(seed)
    search = METHODS[name](rng.random((30, dimensions)), rng)
    points, count, best = next(search), 0, np.inf
    while count < TRIALS:
        assert points.shape[1] == dimensions
        assert np.all((points >= 0.0) & (points <= 1.0))
        costs = function(points)
        count, best = count + len(costs), min(best, float(costs.min()))
        points = search.send(costs)
    return best


@pytest.mark.parametrize("name", METHODS)
def test_least_values_are_found(name: str):
    drawn = np.random.default_rng(1).random((TRIALS, 4))
    assert best_of(name, sphere, 1) < 1e-3 < sphere(drawn).min()
    assert best_of(name, rastrigin, 1) < 0.5 * rastrigin(drawn).min()


@pytest.mark.parametrize("name", METHODS)
def test_the_same_seed_is_the_same_search(name: str):
    assert best_of(name, rastrigin, 5) == best_of(name, rastrigin, 5)


@pytest.mark.parametrize("name", METHODS)
def test_what_diverges_is_survived(name: str):
    def broken(points: np.ndarray) -> np.ndarray:
        return np.where(points[:, 0] > 0.6, np.inf, sphere(points))

    assert best_of(name, broken, 2) < 1e-2


@pytest.mark.parametrize("name", METHODS)
def test_rules_are_searched_by_name(name: str):
    levels, target = (5, 5, 5, 64), np.array([4, 0, 2, 40])
    search = make_search(levels, (0,) * 4, method_settings(name, 12, ""), np.random.default_rng(1))
    genomes, best = next(search), np.inf
    assert (0,) * 4 in genomes or name == "cmaes"
    for _ in range(60):
        costs = np.array([np.sum(np.abs(target - g) / levels) for g in map(np.array, genomes)])
        best = min(best, float(costs.min()))
        genomes = search.send(np.stack([costs], axis=1))
        assert all(
            0 <= code < n for genome in genomes for code, n in zip(genome, levels, strict=True)
        )
    assert best < 0.25


@pytest.mark.parametrize("name", METHODS)
def test_a_damper_is_identified_by_name(name: str):
    problem = small_problem()
    found = fit_named(name, problem, 1, trials=3000)
    assert found.evaluations >= 3000
    assert found.error < 0.2
    assert found.is_complete


def test_wide_ranges_are_searched_by_their_logarithm():
    """As by the genetic algorithms, whose points they are compared with."""
    problem, told = small_problem(), []

    def offered(points: np.ndarray) -> np.ndarray:
        told.append(values_of(problem, points))
        return told[-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(named, "values_of", lambda _problem, points: offered(points))
        fit_named("cuckoo", problem, 1, trials=60)
    for one, found in zip(problem.variables, told[0].T, strict=True):
        low, high = one.search
        middle = np.sqrt(low * high) if one.is_log else 0.5 * (low + high)
        assert 0.4 < np.mean(found < middle) < 0.6
    assert {one.is_log for one in problem.variables} == {False, True}


def test_onlookers_choose_by_what_the_employed_bees_found(monkeypatch: pytest.MonkeyPatch):
    seen = []
    shares = bee_colony.shares
    monkeypatch.setattr(
        bee_colony, "shares", lambda costs: seen.append(costs.copy()) or shares(costs)
    )
    rng = np.random.default_rng(4)
    search = bee_colony.bees(rng.random((10, 3)), rng)
    next(search)
    search.send(np.full(10, 100.0))
    found = np.full(10, 101.0)
    found[7] = 0.0
    search.send(found)
    assert [list(one) for one in seen] == [[100.0] * 7 + [0.0] + [100.0] * 2]


def test_covariance_matrix_adaptation_draws_nothing_from_what_all_share():
    found = []
    for disturbed in (False, True):
        rng = np.random.default_rng(1)
        search, told = METHODS["cmaes"](rng.random((12, 3)), rng), []
        points = next(search)
        for generation in range(30):
            told.append(points)
            np.random.seed(generation if disturbed else 0)  # noqa: NPY002, what other threads do
            points = search.send(sphere(points))
        found.append(np.concatenate(told))
    np.testing.assert_array_equal(*found)


def test_pymoo_is_loaded_by_a_search_and_says_nothing():
    """Neither commands that search nothing nor the help of those that do wait for it."""
    lines = (
        "import sys, warnings; warnings.simplefilter('error')",
        "import quiesce.cli.rules.optimize, quiesce.cli.identify.command, quiesce.damper.fit_model",
        "assert 'pymoo' not in sys.modules",
        "import pymoo.functions; pymoo.functions.is_compiled = lambda: False",
        "import numpy as np; from quiesce.base.searches.methods import METHODS",
        "rng = np.random.default_rng(1)",
        "search = METHODS['pso'](rng.random((8, 2)), rng); points = next(search)",
        "for _ in range(5): points = search.send(points.sum(axis=1))",
    )
    done = subprocess.run(
        [sys.executable, "-c", "\n".join(lines)],
        env={**os.environ, "PYTHONPATH": str(ROOT / "tools/src")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
