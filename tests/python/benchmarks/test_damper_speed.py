"""The measure of evaluation speed: that its contenders do the same and do it well enough.

No test looks at how long anything took."""

from pathlib import Path

import conftest  # noqa: F401
import numpy as np
import pytest
from quiesce.damper import library
from quiesce_benchmarks.damper import speed
from quiesce_benchmarks.damper.rk45 import rk45_force, spline_speed, tuned_speed
from quiesce_benchmarks.damper.synthetic import random_tones, record_of

pytestmark = pytest.mark.usefixtures("build")


@pytest.fixture(scope="module")
def speeds() -> speed.Speeds:
    return speed.measure(speed.Size(32, 4, 3, 1))


def test_motion_is_the_sum_of_its_tones_and_in_its_band() -> None:
    tones = random_tones(4, (0.3, 5.0), 0.01)
    record = record_of(tones, 500.0, 2000)
    assert tones.freq_Hz.min() >= 0.3 and tones.freq_Hz.max() <= 5.0
    slope = np.gradient(record.disp_m, 1.0 / record.rate_Hz)[1:-1]
    np.testing.assert_allclose(record.velocity_m_s[1:-1], slope, atol=2e-3)
    slope = np.gradient(record.velocity_m_s, 1.0 / record.rate_Hz)[1:-1]
    np.testing.assert_allclose(record.accel_m_s2[1:-1], slope, atol=5e-2)


def test_both_speeds_of_scipy_are_the_same_cubic() -> None:
    record = speed.test_record()
    spline, tuned = spline_speed(record), tuned_speed(record)
    for time_s in (0.0, 0.0011, 1.2345, float(record.time_s[-1])):
        assert tuned(time_s) == pytest.approx(float(spline(time_s)), rel=1e-9, abs=1e-12)


def test_rk45_integrates_the_model_of_the_library() -> None:
    record = speed.test_record()
    rows = speed.random_rows(2, 1)
    exact_N = speed.simulate(rows, record, speed.CONVERGED)
    for row, expected_N in zip(rows, exact_N, strict=True):
        force_N, evaluations = rk45_force(row, record, tuned_speed(record))
        assert np.linalg.norm(force_N - expected_N) < 1e-3 * np.linalg.norm(expected_N)
        assert evaluations > len(record)


def test_fewest_substeps_are_enough_and_not_one_more() -> None:
    record = record_of(random_tones(1, (0.3, 5.0), 0.01), 250.0, 500)
    rows = speed.random_rows(16, 1)
    exact_N = speed.simulate(rows, record, speed.CONVERGED)
    substeps = speed.fewest_substeps(rows, record, exact_N)
    assert substeps > 1
    for steps, is_enough in ((substeps, True), (substeps - 1, False)):
        errors = speed.relative_errors(speed.simulate(rows, record, steps), exact_N)
        assert bool(errors.max() <= speed.MOST_ERROR) is is_enough


@pytest.mark.slow
def test_contenders_are_all_there_and_within_the_error(speeds: speed.Speeds) -> None:
    names = [one.name for one in speeds.sets]
    assert names == library.module().instruction_sets()
    assert len({one.worst_error for one in speeds.sets}) == 1  # all sets have the same bits
    assert speeds.fastest.worst_error <= speed.MOST_ERROR
    assert speeds.rk45.median_error <= speed.MOST_ERROR
    assert all(one.candidate_us > 0.0 for one in (speeds.rk45, speeds.rk45_tuned, *speeds.sets))


def test_candidates_depend_on_the_seed_only() -> None:
    first, again, other = (speed.random_rows(4, seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)
    assert np.all(first[:, :7] >= speed.LOW) and np.all(first[:, :7] <= speed.HIGH)


def test_figures_have_the_names_and_goals_of_the_bench(speeds: speed.Speeds) -> None:
    found = {one.name: one for one in speed.figures_of(speeds)}
    assert found["batch_speedup_vs_rk45"].goal == 3000.0
    assert found["batch_speedup_vs_scalar"].goal == 2.0
    assert all(one.value is not None for one in found.values())
    text = speed.table(speeds)
    for one in speeds.sets:
        assert one.name in text


def test_figures_writes_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speed, "QUICK", speed.Size(32, 4, 2, 1))
    figures, tables = speed.figures(True, tmp_path)
    assert figures and tables and not list(tmp_path.iterdir())
