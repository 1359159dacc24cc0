"""Fits of problems with few nonlinear variables: few simulations, and what they conclude."""

import threading

import conftest  # noqa: F401
import numpy as np
import pytest
from quiesce.damper import library
from quiesce.damper.data.split import whole
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.projected import Projected
from quiesce.damper.fit.search import Effort, agree
from quiesce.damper.fit.setting import Setting
from quiesce.damper.fit.small import fit_small
from quiesce_benchmarks.damper import bw7, speed
from quiesce_benchmarks.damper.synthetic import force_of, record_of, row_of, with_force

pytestmark = pytest.mark.usefixtures("build")


def hysteresis(noise: float = 0.0) -> Problem:
    """A normalised Bouc-Wen on its own force."""
    one = library.model(speed.MODEL)
    record = speed.test_record(3)
    row = row_of(one, [800.0, 1500.0, 900.0, 900.0, 0.8, 1.6, 20.0])
    force_N = force_of(one, row, record, 8)
    return Problem(Setting(one, (0.0,)), [whole(with_force(record, force_N, noise, 1))])


def test_projected_agrees_with_the_problem_with_fewer_simulations() -> None:
    problem = hysteresis(0.01)
    parts = np.random.default_rng(2).random((6, len(problem.nonlinear)))
    projected = Projected(problem)
    values, residuals = projected.solve(parts)
    few = problem.evaluations
    expected, errors = problem.project(problem.values_from(parts))
    assert few < (problem.evaluations - few) / 2
    np.testing.assert_allclose(np.linalg.norm(residuals, axis=1), errors, rtol=1e-8)
    np.testing.assert_allclose(problem.size * residuals[0] + problem.target,
                               problem.outputs(values[0])[0], atol=1e-6)  # fmt: skip
    np.testing.assert_allclose(values, expected, rtol=1e-5, atol=1e-6)


def test_projected_check_forgets_columns_that_are_not_the_same_for_all() -> None:
    problem = hysteresis()
    projected = Projected(problem)
    values, _residuals = projected.solve(np.full((3, 3), [[0.5], [0.4], [0.6]]))
    assert projected.check(values[0])
    projected._known[1] = projected._known[1][::-1]  # the wrong conclusion that check is for
    wrong, _residuals = projected.solve(np.full((1, 3), 0.5))
    assert not projected.check(wrong[0])
    again, _residuals = projected.solve(np.full((1, 3), 0.5))
    np.testing.assert_allclose(again[0], values[0], rtol=1e-6, atol=1e-6)


def test_projected_of_one_candidate_at_a_time_learns_nothing() -> None:
    problem = hysteresis()
    projected = Projected(problem)
    for part in (0.3, 0.6):
        parts = np.full((1, 3), part)
        _values, residuals = projected.solve(parts)
        _expected, errors = problem.project(problem.values_from(parts))
        np.testing.assert_allclose(np.linalg.norm(residuals, axis=1), errors, rtol=1e-8)


@pytest.mark.parametrize("seed", range(4))
def test_fit_small_ends_at_the_noise_in_few_simulations(seed: int) -> None:
    record, floor = bw7.truth_record(seed)
    problem = bw7.problem_of(record)
    found = fit_small(problem, seed)
    assert found.is_complete
    assert found.evaluations == problem.evaluations < 150
    assert problem.error(found.values) == pytest.approx(found.error, rel=1e-6)
    assert 0.99 * floor < found.error <= floor


def test_fit_small_is_the_same_for_a_seed() -> None:
    record, _floor = bw7.truth_record(5)
    first, second = (fit_small(bw7.problem_of(record), 9) for _ in range(2))
    np.testing.assert_array_equal(first.values, second.values)
    assert first.evaluations == second.evaluations


def test_fit_small_of_a_model_without_nonlinear_variables() -> None:
    one = library.model("choi_polynomial")
    record = record_of(speed.random_tones(1, (0.5, 3.0), 0.01), 200.0, 400)
    record = with_force(record, 500.0 * record.velocity_m_s)
    problem = Problem(Setting(one, (0.0,)), [whole(record)])
    found = fit_small(problem, 1)
    assert found.error < 1e-6


def test_fit_small_searches_on_where_the_model_is_wrong() -> None:
    one = library.model("kwok_tanh")
    problem = Problem(Setting(one, (0.0,)), hysteresis(0.01).segments)
    effort = Effort(population=16, generations=4, polished=1, polish_evaluations=20)
    found = fit_small(problem, 1, effort)
    assert found.is_complete
    assert problem.error(found.values) == pytest.approx(found.error, rel=1e-6)


def test_fit_small_keeps_the_best_when_it_is_stopped() -> None:
    stop = threading.Event()
    stop.set()
    found = fit_small(hysteresis(0.01), 1, Effort(stop=stop))
    assert not found.is_complete
    assert np.isfinite(found.values).all()


@pytest.mark.parametrize(
    ("ends", "expected"), [([0.3, 0.1, 0.1], True), ([0.3, 0.1], False), ([0.1, 0.10005], True)]
)
def test_agree_compares_the_two_best(ends: list[float], expected: bool) -> None:
    assert agree(ends) is expected
