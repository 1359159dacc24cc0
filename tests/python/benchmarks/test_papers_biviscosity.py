"""The squeeze-mode paper's identification: its rig, its protocol, and what is concluded."""

import json
from pathlib import Path

import conftest  # noqa: F401
import numpy as np
import pytest
from quiesce.damper.fit.small import fit_small
from quiesce_benchmarks.papers import biviscosity_fit as fit
from quiesce_benchmarks.papers import parts
from quiesce_benchmarks.papers.biviscosity_fit import Judged
from quiesce_benchmarks.papers.parts import biviscosity
from quiesce_benchmarks.papers.parts.biviscosity import Trial, determined_by, worst_error_pct
from quiesce_benchmarks.papers.squeeze_rig import (
    CELLS,
    CURRENTS_A,
    PUBLISHED_N,
    TABLE_III,
    Film,
    Sensors,
    films,
    recorded,
    rms,
    sine,
    without_noise,
)
from quiesce_benchmarks.part import Effort, all_parts

pytestmark = pytest.mark.usefixtures("build")

SHORT = Sensors(samples=512)


def test_spring_of_table_iii_is_more_than_table_v_leaves() -> None:
    elastic_N = [one.rms_N(*CELLS[0])[0] for one in TABLE_III]
    assert elastic_N == pytest.approx([0.1096, 0.1202, 0.1203, 0.1447], abs=1e-4)
    assert all(own > row[0] for own, row in zip(elastic_N, PUBLISHED_N, strict=True))


def test_no_film_comes_below_that_spring() -> None:
    for row in biviscosity.exclusion():
        assert row["best_film_rmse_N"] > 0.99 * row["elastic_rms_N"] > row["published_rmse_N"]


def test_films_have_table_iiis_force_with_the_largest_current() -> None:
    wanted_N = np.hypot(*TABLE_III[-1].rms_N(*CELLS[0]))
    still = sine(*CELLS[0], CURRENTS_A[-1], SHORT)
    for film in films():
        assert rms(film.force_N(still)) == pytest.approx(wanted_N, rel=2e-3)


def test_recordings_have_the_noise_that_is_stated() -> None:
    film = films()[0]
    cell = CELLS[3]
    exact = recorded(film, cell, 2.0, 1, without_noise(SHORT))
    noisy = recorded(film, cell, 2.0, 1, SHORT)
    assert rms(noisy.force_N - exact.force_N) == pytest.approx(SHORT.force_noise_N, rel=0.1)
    # White over 128 Hz, of which the low-pass keeps 25.
    kept_m = SHORT.disp_noise_m * np.sqrt(SHORT.low_pass_Hz / (0.5 * SHORT.rate_Hz))
    assert rms(noisy.disp_m - exact.disp_m) == pytest.approx(kept_m, rel=0.25)
    other = recorded(film, cell, 2.0, 2, SHORT)
    assert not np.array_equal(other.force_N, noisy.force_N)
    still = sine(*cell, 2.0, SHORT)
    inside = slice(50, -50)
    off = exact.velocity_m_s[inside] - still.velocity_m_s[inside]
    assert rms(off) < 0.01 * rms(still.velocity_m_s)


def test_without_noise_every_parameter_comes_back() -> None:
    film = films()[1]
    made = fit.recordings(film, 1, without_noise(SHORT))
    problem = fit.film_problem(film, made)
    found = fit.judged(problem, fit_small(problem, 1), made)
    for name, error_pct in fit.errors_pct(film, found.values).items():
        assert error_pct < 3.0, name
    assert found.within == [3, 3, 3, 3]
    assert max(map(max, found.rmse_N)) < 0.01


def trial(film: Film, error: float, width_pct: float, rmse_N: float = 0.02) -> Trial:
    values = {"viscosity_Pa_s": 0.042 * (1.0 + error), "viscosity_ratio": 1.0}
    judged = Judged(values, [[rmse_N] * 4] * 4)
    widths = {"viscosity_Pa_s": width_pct, "viscosity_ratio": 200.0}
    return Trial(film, 1, dict.fromkeys(biviscosity.METHODS, judged), widths)


def test_worst_error_is_of_what_the_recordings_determine() -> None:
    one, two = films()
    trials = [trial(one, 0.01, 2.0), trial(one, -0.03, 4.0), trial(two, 0.5, 6.0)]
    determined = determined_by(trials)
    assert determined == {one.name: ["viscosity_Pa_s"], two.name: []}
    assert worst_error_pct(trials, determined, "search") == pytest.approx(3.0)


def test_cells_count_up_to_the_published_error_and_without_the_fitted_one() -> None:
    rows = [list(row) for row in PUBLISHED_N]
    rows[1][0] = 9.0
    rows[2][3] += 1e-6
    assert Judged({}, rows).within == [3, 3, 2, 3]


@pytest.mark.slow
def test_part_has_its_figures_and_can_be_written(tmp_path: Path) -> None:
    part = all_parts(parts)["biviscosity"]
    found = part.measure(Effort(1, True, tmp_path))
    assert set(found.values) == {name for name, *_ in part.FIGURES}
    assert found.values["biviscosity_search_cells_within"] == 3.0
    text = json.dumps(found.reported)
    assert "not_determined" in text and len(found.tables) == 2
