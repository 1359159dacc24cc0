"""The measure of a 7-parameter fit against scipy's differential evolution.

No test looks at how long anything took."""

import conftest  # noqa: F401
import numpy as np
import pytest
from quiesce_benchmarks.damper import bw7, speed
from quiesce_benchmarks.damper.bw7 import Case, Outcome

pytestmark = pytest.mark.usefixtures("build")


@pytest.fixture(scope="module")
def cases() -> list[Case]:
    return bw7.measure(bw7.Size(3, 1))


def test_truth_has_the_noise_that_the_floor_says() -> None:
    record, floor = bw7.truth_record(2)
    assert len(record) == speed.SAMPLES
    assert floor == pytest.approx(bw7.NOISE_PART, rel=0.1)


def test_truth_depends_on_the_seed_only() -> None:
    first, again, other = (bw7.truth_record(seed)[0].force_N for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


def test_truths_lie_within_the_bounds_of_the_search() -> None:
    for seed in range(10):
        problem = bw7.problem_of(bw7.truth_record(seed)[0])
        row = speed.random_rows(1, 1000 + seed)[0]
        for value, variable in zip(row, problem.variables, strict=False):
            assert variable.bounds[0] <= value <= variable.bounds[1]
        assert len(problem.variables) == 7


@pytest.mark.slow
def test_both_reach_the_noise_floor_and_ours_in_fewer_evaluations(cases: list[Case]) -> None:
    assert all(one.ours.is_success for one in cases)
    scipy = cases[0].scipy
    assert scipy is not None and scipy.is_success
    assert scipy.evaluations > 50 * cases[0].ours.evaluations
    assert [one.scipy is None for one in cases] == [False, True, True]


def test_ratios_are_of_the_cases_that_both_have() -> None:
    ours = Outcome(1.0, 50, 0.5)
    cases = [Case(ours, Outcome(1.0, 5000, 20.0)), Case(ours, None)]
    assert bw7.ratios(cases) == ([100.0], [40.0])


def test_a_fit_above_the_floor_is_no_success() -> None:
    cases = [
        Case(Outcome(1.5, 50, 0.5), Outcome(1.0, 5000, 20.0)),
        Case(Outcome(1.0, 50, 0.5), None),
    ]
    found = {one.name: one for one in bw7.figures_of(cases)}
    assert found["bw7_success_pct"].value == 50.0
    assert found["bw7_success_pct"].is_ok is False
    assert found["bw7_evals_ratio"].is_ok and found["bw7_time_ratio"].is_ok


@pytest.mark.slow
def test_table_states_what_was_compared(cases: list[Case]) -> None:
    text = bw7.table(cases)
    assert "all 3 truths" in text and "scipy DE, the first 1" in text
