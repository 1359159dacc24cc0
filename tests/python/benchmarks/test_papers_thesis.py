"""The thesis' printed sets, the test restored from them, and its part of the benchmark."""

from pathlib import Path

import numpy as np
import pytest
from quiesce_benchmarks.damper.one_set import error_pct
from quiesce_benchmarks.papers import parts, thesis_laws, thesis_spreads, thesis_test
from quiesce_benchmarks.papers import thesis_published as published
from quiesce_benchmarks.papers import thesis_scenarios as scenarios
from quiesce_benchmarks.part import Effort, all_parts

pytestmark = pytest.mark.usefixtures("build")


@pytest.mark.parametrize("column", range(6))
@pytest.mark.parametrize(
    ("name", "law"),
    [("kwok_tanh", published.tanh_at), ("modified_bouc_wen", published.bouc_wen_at)],
)
def test_laws_give_the_files_at_their_own_currents(name: str, law, column: int) -> None:
    at = published.CURRENTS_A[column]
    file, found = published.file_of(f"{name}_{at:.1f}A"), law(column, at)
    assert found.parameters == pytest.approx(dict(file.parameters), rel=1e-5, abs=1e-9)


def test_motion_is_that_of_the_velocities_in_the_tables() -> None:
    record = thesis_test.motion(0.6)
    assert np.abs(record.velocity_m_s).max() == pytest.approx(0.09425, rel=1e-3)
    assert len(record) == 300 and record.level == 0.6


@pytest.mark.parametrize("column", range(6))
def test_restored_force_lies_as_far_from_its_sources_as_they_were_from_the_recording(
    column: int,
) -> None:
    """Nearer to the better ones, never farther than printed and a half."""
    force_N = thesis_test.force_N(column)
    record = thesis_test.motion(published.CURRENTS_A[column])
    for name, source in thesis_test.sources(column).items():
        printed = published.ERRORS_pct[name]["A"][column]
        found = np.linalg.norm(scenarios.simulator(source)(record) - force_N)
        assert 0.02 * printed < 100.0 * found / np.linalg.norm(force_N) < 1.5 * printed + 3.0, name


def test_printed_nine_rules_give_the_printed_errors_at_the_middle_current() -> None:
    found = scenarios.of_anfis9(thesis_test.recordings(1))["B"]
    assert found == pytest.approx(published.ERRORS_pct["anfis9"]["B"], abs=4.0)


def test_recordings_are_of_their_seed() -> None:
    one, again, other = (thesis_test.recorded(3, seed) for seed in (1, 1, 2))
    assert np.array_equal(one.force_N, again.force_N)
    assert error_pct(lambda _record: other.force_N, one) == pytest.approx(1.4, abs=0.2)


def test_start_of_the_grid_covers_its_range_and_crosses_at_half() -> None:
    start = thesis_spreads.start_of(1.5)
    assert start.centres[0] == pytest.approx([-1.5, 0.0, 1.5])
    assert start.widths[0] == pytest.approx(0.637, abs=1e-3)  # 40.0 mm/s beside it: Table 4.10
    assert start.widths[1] == pytest.approx(40.02, abs=0.05)


def test_laws_are_the_librarys_model() -> None:
    keys = ("c_a", "c_b", "k_a", "k_b", "alpha_a", "alpha_b", "alpha_c", "beta", "delta_a",
            "delta_b", "f0_a", "f0_b")  # fmt: skip
    table = published._TANH
    sets = np.array([[table[key][column] for key in keys] for column in range(6)])
    for at in (0, 3, 5):
        record = thesis_test.motion(published.CURRENTS_A[at])
        forces_N = thesis_laws.forces_N(sets, record)
        for column in range(6):
            law = published.tanh_at(column, published.CURRENTS_A[at])
            moving = np.abs(record.disp_m) > 1e-9  # not at the sign's jump
            expected = scenarios.simulator(law)(record)
            assert forces_N[column][moving] == pytest.approx(expected[moving], abs=1e-6)


def test_search_stays_within_the_printed_bounds_and_finds_a_fit() -> None:
    record = thesis_test.recorded(3, 1)
    found = thesis_laws.fitted(record, np.random.default_rng(1))
    assert np.all((thesis_laws.LOW <= found) & (found <= thesis_laws.HIGH))
    assert 100.0 * thesis_laws.errors(found[None], record)[0] < 12.0


def test_part_reports_one_figure_without_a_goal() -> None:
    assert all_parts(parts)["thesis"].FIGURES == (("anfis27_one_set_pct", "%", None, "lower"),)


@pytest.mark.slow
def test_part_fits_every_model_in_every_scenario(tmp_path: Path) -> None:
    found = all_parts(parts)["thesis"].measure(Effort(1, True, tmp_path))
    assert 1.0 < found.values["anfis27_one_set_pct"] < 10.0
    for name, errors in found.reported["fitted"].items():
        assert set(errors) == set("ABCD"), name
        # One current with constants: at its own, A, B, C and D agree.
        assert errors["A"][3] == errors["B"][3] == errors["C"][3]
        assert errors["A"][5] == errors["D"][5]
    assert set(found.reported["one_set"]) == {"anfis27", "kwok_tanh", "modified_bouc_wen"}
    assert set(found.reported["spreads"]) == {"printed", "start +-1.5 mm", "start +-3 mm"}
