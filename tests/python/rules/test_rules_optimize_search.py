"""The search methods on costs whose optimum is known; runs, limits and states without a bench."""

import json
import threading
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from quiesce.base.errors import UsageError
from quiesce.base.searches import by_pymoo
from quiesce.base.searches.names import NAMES
from quiesce.rules.optimize import state as optimize_state
from quiesce.rules.optimize.coding import Coding
from quiesce.rules.optimize.methods import method_settings
from quiesce.rules.optimize.objective import Steady
from quiesce.rules.optimize.run import Limits, Problem, Runner, simplify
from quiesce.rules.optimize.search import make_search
from quiesce.rules.optimize.state import State

LEVELS = (5,) * 6 + (1024,) * 3
TARGET = (0, 4, 2, 3, 1, 4, 700, 20, 333)
FIRST = (0,) * 9
METHODS = {
    "tournament": method_settings("ga", 30, "tournament"),
    "roulette": method_settings("ga", 30, "roulette"),
    **{name: method_settings(name, 30, "tournament") for name in ("de", "nsga2", *NAMES)},
}
SETTINGS = {"method": "any", "seed": 3}


def distance(genome: tuple[int, ...]) -> float:
    """0 at TARGET only; 100 for the farthest corner."""
    shares = [abs(g - t) / (n - 1) for g, t, n in zip(genome, TARGET, LEVELS, strict=True)]
    return 100.0 * sum(shares) / len(shares)


def steady_of(genome: tuple[int, ...]) -> tuple[Steady, ...]:
    """Two objectives in conflict: distance from the target, and how large the first genes are."""
    return (
        Steady(
            100.0 - distance(genome),
            0.0,
            float(sum(genome[:6])),
        ),
    )


def costs_of(people, name: str) -> np.ndarray:
    rows = [[distance(one), float(sum(one[:6]))] for one in people]
    return np.array(rows)[:, : 2 if name == "nsga2" else 1]


def make_problem(evaluate=steady_of, objectives: int = 1) -> Problem:
    def costs(outcomes) -> np.ndarray:
        rows = [[100.0 - o[0].amp_reduction_pct, o[0].mean_current_A] for o in outcomes]
        return np.array(rows)[:, :objectives]

    return Problem(
        canonical=lambda genome: genome,
        evaluate=evaluate,
        costs=costs,
        cost=lambda outcome: 100.0 - outcome[0].amp_reduction_pct,
    )


def run(
    folder: Path,
    name: str,
    limits: Limits,
    problem: Problem | None = None,
    state: State | None = None,
    jobs: int = 2,
) -> Runner:
    settings = METHODS[name]
    problem = problem or make_problem(objectives=2 if name == "nsga2" else 1)
    with ThreadPoolExecutor(jobs) as pool:
        file = folder / "state.json"
        runner = Runner(problem, state or State(dict(SETTINGS)), file, pool)
        runner.run(make_search(LEVELS, FIRST, settings, np.random.default_rng(3)), limits)
    return runner


def loaded(folder: Path) -> State:
    return optimize_state.load(folder / "state.json", dict(SETTINGS), LEVELS, 1)


# Methods


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tournament", "roulette", "de"])
def test_the_known_optimum_is_found(tmp_path, name) -> None:
    runner = run(tmp_path, name, Limits(120))
    best = runner.best()
    assert best[:6] == TARGET[:6]
    assert max(abs(g - t) for g, t in zip(best[6:], TARGET[6:], strict=True)) <= 24
    assert runner.history.best[0] > 10 * runner.history.best[-1]


@pytest.mark.slow
def test_differential_evolution_does_as_well_as_scipy(tmp_path) -> None:
    from scipy.optimize import differential_evolution

    counts = np.array(LEVELS)
    reference = differential_evolution(
        lambda x: distance(tuple(np.minimum(np.floor(x * counts), counts - 1).astype(int))),
        [(0.0, 1.0)] * len(LEVELS), popsize=4, maxiter=60, polish=False, rng=1, tol=0.0,
    )  # fmt: skip
    ours = run(tmp_path, "de", Limits(61), jobs=1)
    assert ours.history.best[-1] <= max(1.2 * reference.fun, 0.5)


@pytest.mark.slow
def test_front_of_two_objectives_holds_both_ends_and_points_between(tmp_path) -> None:
    runner = run(tmp_path, "nsga2", Limits(80))
    costs = np.array([[distance(g), sum(g[:6])] for g in runner.visited])
    front = costs[by_pymoo.front(costs)]
    assert front[:, 1].min() == 0
    # With the small genes right, only the three others are left to be found.
    assert front[:, 0].min() < 5.0
    assert len(np.unique(front[:, 1])) >= 10
    for one in front:
        assert not ((costs <= one).all(axis=1) & (costs < one).any(axis=1)).any()


@pytest.mark.parametrize("name", METHODS)
def test_same_seed_same_search_whatever_the_jobs(tmp_path, name) -> None:
    one = run(tmp_path, name, Limits(8), jobs=1)
    other = run(tmp_path, name, Limits(8), jobs=4)
    assert one.state.digests == other.state.digests
    assert list(one.visited.items()) == list(other.visited.items())
    assert one.history == other.history


@pytest.mark.parametrize("name", METHODS)
def test_other_seed_other_search(name) -> None:
    found = []
    for seed in (3, 4):
        search = make_search(LEVELS, FIRST, METHODS[name], np.random.default_rng(seed))
        first = next(search)
        found.append((first, search.send(costs_of(first, name))))
    assert found[0][1] != found[1][1]
    # Covariance matrix adaptation begins at the start alone.
    assert found[0][0] != found[1][0] or name == "cmaes"


@pytest.mark.parametrize("name", METHODS)
def test_first_population_holds_the_start(name) -> None:
    start = tuple(n - 1 for n in LEVELS)
    for first in (start, TARGET, FIRST):
        search = make_search(LEVELS, first, METHODS[name], np.random.default_rng(0))
        assert next(search)[0] == first


@pytest.fixture
def algorithms(monkeypatch) -> list:
    """pymoo's algorithms as they are begun."""
    begun, asked = [], by_pymoo.asked

    def noted(algorithm, *more):
        begun.append(algorithm)
        return asked(algorithm, *more)

    monkeypatch.setattr(by_pymoo, "asked", noted)
    return begun


def test_elite_survives(algorithms) -> None:
    for name in ("tournament", "roulette"):
        search = make_search(LEVELS, FIRST, METHODS[name], np.random.default_rng(5))
        people, known = next(search), []
        for _ in range(20):
            costs = costs_of(people, name)
            known += [float(cost) for cost in costs[:, 0]]
            people = search.send(costs)
            assert len(people) == 30
            parents = sorted(float(cost) for cost in algorithms[-1].pop.get("F")[:, 0])
            assert parents == sorted(known)[:30]
    assert len(algorithms) == 2


@pytest.mark.parametrize("name", METHODS)
def test_a_space_that_is_searched_through_ends_no_search(name) -> None:
    search = make_search((2, 1), (1, 0), METHODS[name], np.random.default_rng(5))
    people, seen = next(search), set()
    for _ in range(12):
        seen |= set(people)
        people = search.send(np.array([[float(g[0])] * (1 + (name == "nsga2")) for g in people]))
    assert seen == {(0, 0), (1, 0)}


@pytest.mark.parametrize("levels", [(5,), (2,), (1,), (3, 7, 64), (1024, 5)])
def test_code_gives_back_every_level(levels) -> None:
    coding = Coding(levels)
    for genome in product(*(range(0, n, max(1, n // 16)) for n in levels)):
        assert coding.decode(coding.encode(genome)) == genome


def test_neighbouring_levels_of_a_power_of_two_differ_in_one_bit() -> None:
    coding = Coding((1024,))
    codes = np.array([coding.encode((i,)) for i in range(1024)])
    assert coding.bits == 10
    assert (np.abs(np.diff(codes.astype(int), axis=0)).sum(axis=1) == 1).all()


def test_all_levels_have_nearly_equal_shares_of_the_codes() -> None:
    coding = Coding((5,))
    bits = np.array(list(product((False, True), repeat=coding.bits)))
    counts = np.bincount([coding.decode(one)[0] for one in bits])
    assert len(counts) == 5 and counts.max() - counts.min() <= 1


def test_roulette_prefers_the_better_and_takes_equals_equally() -> None:
    shares = by_pymoo.roulette_shares(np.array([1.0, 3.0, 2.0]))
    assert np.allclose(shares, [2 / 3, 0, 1 / 3])
    assert np.allclose(by_pymoo.roulette_shares(np.full(4, 7.0)), 0.25)


def test_roulette_turns_by_the_shares(algorithms) -> None:
    search = make_search(LEVELS, FIRST, METHODS["roulette"], np.random.default_rng(5))
    search.send(costs_of(next(search), "roulette"))
    people = algorithms[0].pop
    rng = np.random.default_rng(1)
    chosen = by_pymoo.Roulette().do(None, people, 20000, 2, to_pop=False, random_state=rng)
    assert chosen.shape == (20000, 2)
    shares = np.bincount(chosen.ravel(), minlength=30) / chosen.size
    expected = by_pymoo.roulette_shares(people.get("F")[:, 0])
    assert np.allclose(shares, expected, atol=0.005) and expected.max() > 0.04


def test_front_is_that_of_brute_force() -> None:
    rng = np.random.default_rng(1)
    for size in (1, 5, 60, 400):
        costs = rng.integers(0, 6, (size, 3)).astype(float)
        expected = [
            i for i in range(size)
            if not any((one <= costs[i]).all() and (one < costs[i]).any() for one in costs)
        ]  # fmt: skip
        assert list(by_pymoo.front(costs)) == expected


def test_parents_are_the_best_fronts_and_the_lonely_of_the_last(algorithms) -> None:
    settings = method_settings("nsga2", 5, "")
    search = make_search(LEVELS, FIRST, settings, np.random.default_rng(1))
    assert len(next(search)) == 5
    first = np.array([[2.0, 2.0], [1.0, 9.0], [9.0, 1.0], [3.0, 4.0], [3.1, 3.9]])
    assert len(search.send(first)) == 5
    later = np.array([[4.0, 3.5], [20.0, 20.0], [21.0, 20.0], [20.0, 21.0], [30.0, 30.0]])
    search.send(later)
    parents = {tuple(costs) for costs in algorithms[0].pop.get("F").tolist()}
    # The second front is (3, 4), (3.1, 3.9), (4, 3.5): its middle one has the nearest neighbours.
    assert parents == {(2.0, 2.0), (1.0, 9.0), (9.0, 1.0), (3.0, 4.0), (4.0, 3.5)}
    search.send(np.full((5, 2), 50.0))
    assert {tuple(costs) for costs in algorithms[0].pop.get("F").tolist()} == parents


def test_equal_people_are_no_two_parents(algorithms) -> None:
    for name in ("tournament", "roulette", "nsga2"):
        search = make_search(LEVELS, FIRST, METHODS[name], np.random.default_rng(2))
        people = next(search)
        for _ in range(15):
            people = search.send(costs_of(people, name))
            bits = algorithms[-1].pop.get("X")
            assert len(np.unique(bits, axis=0)) == len(bits) == 30


# Runs


@pytest.mark.parametrize("name", METHODS)
def test_resumed_search_is_the_uninterrupted_one(tmp_path, name) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    whole.mkdir(), parts.mkdir()
    expected = run(whole, name, Limits(12))
    run(parts, name, Limits(5))
    assert len(loaded(parts).digests) == 5
    count = 0

    def counting(genome):
        nonlocal count
        count += 1
        return steady_of(genome)

    objectives = 2 if name == "nsga2" else 1
    known = loaded(parts)
    resumed = run(parts, name, Limits(12), make_problem(counting, objectives), state=known, jobs=1)
    assert list(resumed.visited.items()) == list(expected.visited.items())
    assert resumed.history == expected.history
    assert resumed.state.digests == expected.state.digests
    assert (parts / "state.json").read_text() == (whole / "state.json").read_text()
    first_part = expected.history.evaluations[4]
    assert count == len(expected.visited) - first_part


@pytest.mark.parametrize("name", METHODS)
def test_interruption_inside_a_generation_keeps_what_was_done(tmp_path, name) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    whole.mkdir(), parts.mkdir()
    expected = run(whole, name, Limits(9))
    left = 100
    lock = threading.Lock()

    def breaking(genome):
        nonlocal left
        with lock:
            left -= 1
        if left < 0:
            raise KeyboardInterrupt
        return steady_of(genome)

    objectives = 2 if name == "nsga2" else 1
    with pytest.raises(KeyboardInterrupt):
        run(parts, name, Limits(9), make_problem(breaking, objectives))
    state = loaded(parts)
    done = [n for n in expected.history.evaluations if n <= 100]
    assert len(state.digests) == len(done) < 9
    # Two jobs: the call that breaks may overtake one before it.
    assert 98 <= len(state.evaluated) <= 100
    resumed = run(parts, name, Limits(9), state=state)
    assert list(resumed.visited.items()) == list(expected.visited.items())
    assert resumed.history == expected.history


def test_more_generations_go_on_from_a_finished_search(tmp_path) -> None:
    (tmp_path / "all").mkdir(), (tmp_path / "two").mkdir()
    expected = run(tmp_path / "all", "de", Limits(10))
    run(tmp_path / "two", "de", Limits(6)).finish()
    resumed = run(tmp_path / "two", "de", Limits(10), state=loaded(tmp_path / "two"))
    assert resumed.history == expected.history


def test_evaluations_end_the_search_after_a_generation(tmp_path) -> None:
    runner = run(tmp_path, "de", Limits(50, evaluations=70))
    assert runner.history.evaluations[-1] >= 70 > runner.history.evaluations[-2]
    assert len(runner.history.best) < 50


def test_state_that_does_not_repeat_is_refused(tmp_path) -> None:
    run(tmp_path, "de", Limits(4))
    state = loaded(tmp_path)
    state.digests[2] = "0" * 16
    with pytest.raises(UsageError, match="generation 3 is not what it was"):
        run(tmp_path, "de", Limits(4), state=state)


def test_what_does_not_pay_goes_back_to_the_start(tmp_path) -> None:
    """Genes 0 .. 2 have no influence here."""

    def blind(genome):
        return steady_of((*TARGET[:3], *genome[3:]))

    problem = make_problem(blind)
    start = (1, 1, 1, *FIRST[3:])
    best = (4, 0, 3, *TARGET[3:])
    with ThreadPoolExecutor(1) as pool:
        runner = Runner(problem, State(dict(SETTINGS)), tmp_path / "state.json", pool)
        found = simplify(runner, problem, best, start, tolerance=0.0)
    assert found == (1, 1, 1, *TARGET[3:])


# States


def test_state_holds_figures_to_the_last_bit(tmp_path) -> None:
    rng = np.random.default_rng(9)
    figures = {
        tuple(int(rng.integers(n)) for n in LEVELS): (Steady(*rng.normal(size=3)),)
        for _ in range(20)
    }
    State(dict(SETTINGS), dict(figures), ["a"]).save(tmp_path / "state.json")
    assert loaded(tmp_path).evaluated == figures
    assert [p.name for p in tmp_path.iterdir()] == ["state.json"]


def good_state(folder: Path) -> dict:
    run(folder, "de", Limits(2))
    return json.loads((folder / "state.json").read_text())


def with_change(key: str, value):
    return lambda state: {**state, key: value}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (with_change("schema", "other"), "damaged"),
        (with_change("version", 1), "another version of this command .1, not 2.*--anew"),
        (with_change("version", 99), "another version"),
        (with_change("evaluated", 5), "damaged"),
        (with_change("evaluated", [[[0] * 8, [[1, 2, 3]]]]), "no genome"),
        (with_change("evaluated", [[[9] + [0] * 8, [[1, 2, 3]]]]), "no genome"),
        (with_change("evaluated", [[[0.5] + [0] * 8, [[1, 2, 3]]]]), "no genome"),
        (with_change("evaluated", [[[0] * 9, [[1, 2]]]]), "damaged"),
        (with_change("evaluated", [[[0] * 9, [[1, 2, "much"]]]]), "damaged"),
        (with_change("evaluated", [[[0] * 9, [[1, 2, 3], [1, 2, 3]]]]), "1 steady states"),
        (with_change("digests", None), "damaged"),
        (with_change("settings", []), "damaged"),
        (with_change("settings", {"method": "any", "seed": 4}), "seed: 4, not 3"),
        (with_change("settings", {"method": "any"}), "seed: null, not 3"),
        (lambda state: [state], "damaged"),
    ],
)
def test_damaged_or_other_state_is_refused(tmp_path, change, words) -> None:
    file = tmp_path / "state.json"
    file.write_text(json.dumps(change(good_state(tmp_path))))
    with pytest.raises(UsageError, match=words) as error:
        loaded(tmp_path)
    assert "state.json" in str(error.value) and "\n" not in str(error.value)


def test_state_that_is_no_json_is_refused(tmp_path) -> None:
    text = json.dumps(good_state(tmp_path))
    for content in (b"", text[: len(text) // 2].encode(), b"\xff\xfe\x00", b"null"):
        (tmp_path / "state.json").write_bytes(content)
        with pytest.raises(UsageError, match="damaged"):
            loaded(tmp_path)


def test_missing_state_is_refused(tmp_path) -> None:
    with pytest.raises(UsageError, match="nothing to resume"):
        loaded(tmp_path)
