"""Candidates alone and in company: whatever the evaluator chooses, the bits are the same."""

import conftest  # noqa: F401
import numpy as np
import pytest
from quiesce.damper import library
from quiesce_benchmarks.damper import speed
from quiesce_benchmarks.damper.synthetic import random_tones, record_of

pytestmark = pytest.mark.usefixtures("build")

RECORD = record_of(random_tones(1, (0.5, 5.0), 0.01), 200.0, 203)


@pytest.mark.parametrize("count", [1, 2, 7, 9, 17, 33, 70])
def test_forces_have_the_same_bits_whatever_the_number_of_candidates(count: int) -> None:
    rows = speed.random_rows(count, 2)
    expected_N = speed.simulate(rows, RECORD, 2, "scalar")
    np.testing.assert_array_equal(speed.simulate(rows, RECORD, 2), expected_N)


@pytest.mark.parametrize("average", [1, 5])
@pytest.mark.parametrize("count", [1, 9, 40])
def test_squared_errors_are_those_of_the_forces(count: int, average: int) -> None:
    one, motion = library.model(speed.MODEL), library.motion(RECORD)
    rows = speed.random_rows(count, 3)
    rng = np.random.default_rng(1)
    force_N, weight = rng.normal(0.0, 500.0, len(RECORD)), rng.random(len(RECORD))
    found = {
        name: library.squared_error(
            one, speed.ORDERS, rows, motion, 2, force_N, weight, average, name
        )
        for name in ("", *library.module().instruction_sets())
    }
    for errors in found.values():
        np.testing.assert_array_equal(errors, found["scalar"])
    if average == 1:
        simulated_N = speed.simulate(rows, RECORD, 2)
        expected = np.sum(weight * (simulated_N - force_N) ** 2, axis=1)
        np.testing.assert_allclose(found[""], expected, rtol=1e-12)


def test_a_motion_gives_the_same_forces_again_with_other_steps_in_between() -> None:
    one, motion = library.model(speed.MODEL), library.motion(RECORD)
    rows = speed.random_rows(3, 4)
    found = [
        library.simulate(one, speed.ORDERS, rows, motion, substeps)
        for substeps in (1, 40, 3, 1, 40)
    ]
    np.testing.assert_array_equal(found[0], found[3])
    np.testing.assert_array_equal(found[1], found[4])
    assert not np.array_equal(found[0], found[2])
