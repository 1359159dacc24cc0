"""The measure of recovered parameters: truths, their tests, and what is concluded from fits."""

import conftest  # noqa: F401
import numpy as np
import pytest
from quiesce.damper import library
from quiesce.damper.data.split import whole
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.setting import Setting
from quiesce_benchmarks.damper import truth as damper_truth
from quiesce_benchmarks.damper import truth_c3
from quiesce_benchmarks.damper.truth import (
    ModelResult,
    ParameterResult,
    errors_pct,
    figures_of,
    orders_of,
)
from quiesce_benchmarks.damper.truth_cases import DETERMINED, RATE_Hz, make_truth, motions

pytestmark = pytest.mark.usefixtures("build")


def parameter(
    deviation_pct: float = 0.5,
    exact_pct: float = 0.1,
    noisy_pct: float = 1.0,
    coverage_pct: float | None = 95.0,
) -> ParameterResult:
    return ParameterResult("c", "N s/m", 1.0, deviation_pct, exact_pct, noisy_pct, coverage_pct)


def figure_values(*parameters: ParameterResult) -> dict[str, tuple[float | None, bool | None]]:
    found = figures_of([ModelResult("m", parameters, 10)], 0.1)
    return {one.name: (one.value, one.is_ok) for one in found}


def test_motions_have_the_derivatives_that_they_say() -> None:
    for record in motions():
        slope = np.gradient(record.disp_m, 1.0 / RATE_Hz)[1:-1]
        np.testing.assert_allclose(record.velocity_m_s[1:-1], slope, atol=2e-3)
        slope = np.gradient(record.velocity_m_s, 1.0 / RATE_Hz)[1:-1]
        np.testing.assert_allclose(record.accel_m_s2[1:-1], slope, atol=0.1)


@pytest.mark.parametrize("name", ["bingham", "modified_dahl", "kwok_tanh", "choi_polynomial"])
def test_truth_is_admissible_determined_and_the_optimum_of_its_problem(name: str) -> None:
    truth = make_truth(library.model(name), 2)
    for value, one in zip(truth.row, truth.model.parameters, strict=False):
        assert one.min <= value <= one.max
    problem = truth.problem()
    assert problem.error(truth.values(problem)) < 1e-3  # what finer integration makes
    assert np.max(truth.deviations()) <= DETERMINED


def test_truth_depends_on_the_seed_only() -> None:
    one = library.model("viscous_dahl")
    first, again, other = (make_truth(one, seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.row, again.row)
    assert not np.array_equal(first.row, other.row)
    noisy, same = (first.problem(0.01, 3).target for _ in range(2))
    np.testing.assert_array_equal(noisy, same)


def test_noise_is_the_part_of_all_forces_that_it_says() -> None:
    truth = make_truth(library.model("bingham"), 1)
    exact, noisy = truth.problem().target, truth.problem(0.01, 5).target
    part = np.std(noisy - exact) / np.sqrt(np.mean(exact**2))
    assert part == pytest.approx(0.01, rel=0.05)


def test_deviations_are_those_of_many_fits() -> None:
    """Cramer-Rao against the spread of linear estimates: all of a polynomial is linear."""
    truth = make_truth(library.model("second_order_polynomial"), 1)
    found = []
    for seed in range(60):
        problem = truth.problem(0.01, seed)
        values, _error = problem.project(np.zeros((1, len(problem.variables))))
        found.append(values[0] / truth.values(problem))
    np.testing.assert_allclose(np.std(found, axis=0), truth.deviations(), rtol=0.35)


def test_elements_of_a_network_count_in_any_order() -> None:
    one = library.model("viscoplastic_2")
    problem = Problem(Setting(one, (0.0,)), [whole(make_truth_record())])
    names = [variable.name for variable in problem.variables]
    orders = orders_of(problem)
    assert len(orders) == 2
    swapped = [names[k] for k in orders[1]]
    assert swapped.index("travel2_m") == names.index("travel1_m")
    assert swapped[:3] == names[:3]
    truth = np.arange(1.0, 1.0 + len(names))
    np.testing.assert_allclose(errors_pct(problem, truth[orders[1]], truth), 0.0)
    wrong = truth[orders[1]]
    wrong[0] *= 1.5
    assert np.max(errors_pct(problem, wrong, truth)) == pytest.approx(50.0)


def make_truth_record():
    return make_truth(library.model("bingham"), 1).records[0]


def test_quick_models_are_recovered_with_and_without_noise() -> None:
    size = damper_truth.Size(("bingham", "viscous_dahl"), 1, 3)
    told: list[str] = []
    results = damper_truth.measure(size, say=told.append)
    assert [one.name for one in results] == list(size.models)
    for one in [one for result in results for one in result.parameters]:
        assert one.is_determined and one.exact_error_pct < 1.0
        assert one.noisy_error_pct < max(5.0 * one.deviation_pct, 0.05)
        assert one.coverage_pct is not None
    # The bound is told before the fits are done.
    assert len(told) == 2 and told[0].startswith("bingham: Cramer-Rao")
    assert "bingham: " in damper_truth.table(results[0])
    assert damper_truth.summary(results).endswith("none")


def test_a_parameter_that_is_not_found_is_missed_and_listed() -> None:
    found = figure_values(parameter(), parameter(exact_pct=3.0))
    assert found["truth_recovered_pct"] == (50.0, False)
    text = damper_truth.summary([ModelResult("m", [parameter(exact_pct=3.0)], 1)])
    assert "m c: MISSED" in text


def test_a_parameter_that_the_tests_do_not_determine_is_listed_but_not_judged() -> None:
    lost = parameter(deviation_pct=np.inf, exact_pct=400.0, noisy_pct=900.0, coverage_pct=None)
    found = figure_values(parameter(), lost)
    assert found["truth_recovered_pct"] == (100.0, True)
    assert found["truth_parameters"][0] == 2.0
    assert found["truth_parameters_determined"][0] == 1.0
    text = damper_truth.summary([ModelResult("m", [lost], 1)])
    assert "not determined by these tests" in text


def test_noise_is_judged_where_the_bound_allows_it() -> None:
    found = figure_values(
        parameter(deviation_pct=2.0, noisy_pct=9.0, coverage_pct=None), parameter()
    )
    assert found["truth_noisy_recovered_pct"] == (100.0, True)
    found = figure_values(parameter(deviation_pct=1.0, noisy_pct=9.0))
    assert found["truth_noisy_recovered_pct"] == (0.0, False)


def test_coverage_misses_its_goal_on_either_side() -> None:
    found = figure_values(parameter(coverage_pct=80.0))
    assert found["truth_coverage_least_model_pct"][1] is False
    found = figure_values(parameter(coverage_pct=100.0))
    assert found["truth_coverage_most_model_pct"][1] is False


def test_least_squares_stands_beside_the_reference() -> None:
    text, worst_pct = truth_c3.table(1)
    assert worst_pct < 0.2
    assert text.count("reference") == 3 and "1 % noise" in text
