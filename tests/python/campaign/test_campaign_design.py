"""Designs: which cases there are, the same ones always; sensitivities against known answers."""

import numpy as np
import pytest
from quiesce.campaign.design import METHODS, MORRIS, SALTELLI, Design
from quiesce.campaign.factors import Choices, Factor, Spread, evenly, level_of
from quiesce.campaign.sensitivity import sensitivity


def spreads(*names: str, low: float = 0.0, high: float = 1.0) -> tuple[Factor, ...]:
    return tuple(Spread(name, f"scenario.{name}", low, high) for name in names)


def labels(design: Design) -> list[list[float]]:
    return [design.case(i).labels for i in range(len(design))]


@pytest.mark.parametrize("method", [one for one in METHODS if one != "grid"])
def test_design_is_the_same_each_time_and_another_with_another_seed(method: str) -> None:
    first, again, other = (Design(spreads("a", "b"), method, 16, seed) for seed in (3, 3, 4))
    assert labels(first) == labels(again)
    assert labels(first) != labels(other)
    assert all(0.0 <= value <= 1.0 for row in labels(first) for value in row)


@pytest.mark.parametrize("method", ["latin_hypercube", "sobol"])
def test_design_that_fills_has_one_case_in_each_slice(method: str) -> None:
    design = Design(spreads("a", "b", "c"), method, 64, 1)
    for column in np.array(labels(design)).T:
        assert sorted(np.floor(64 * column)) == list(range(64))


def test_crossed_choices_share_their_samples_values_and_seed() -> None:
    laws = Choices("law", tuple(level_of("law", one, "set") for one in ("off", "fuzzy")), True)
    design = Design(
        (*spreads("a"), laws, evenly(Spread("n", "seed", 1, 3), 3)), "monte_carlo", 5, 1
    )
    assert (design.samples, design.crossings, len(design)) == (5, 6, 30)
    of_sample = [design.case(i) for i in range(6, 12)]
    assert len({(case.seed, case.labels[0]) for case in of_sample}) == 1
    assert [case.labels[1:] for case in of_sample] == [
        [law, n] for law in ("off", "fuzzy") for n in (1, 2, 3)
    ]
    assert len({design.case(i).seed for i in range(0, 30, 6)}) == 5


def test_spreads_have_their_distributions() -> None:
    shares = (np.arange(1000) + 0.5) / 1000.0

    def values(spread: Spread) -> np.ndarray:
        return np.array([spread.at(float(share)).label for share in shares])

    normal = values(Spread("n", "seed", 5.0, 2.0, is_normal=True))
    assert normal.mean() == pytest.approx(5.0)
    assert normal.std() == pytest.approx(2.0, rel=0.01)
    decades = values(Spread("l", "seed", 1.0, 100.0, is_log=True))
    assert np.mean(decades < 10.0) == pytest.approx(0.5)
    whole = values(Spread("w", "seed", 1, 4, is_whole=True))
    assert np.unique(whole, return_counts=True)[1].tolist() == [250, 250, 250, 250]
    ends = Spread("n", "seed", 0.0, 1.0, is_normal=True)
    assert all(np.isfinite(ends.at(share).label) for share in (0.0, 1.0))
    assert Spread("w", "seed", 1, 4, is_whole=True).at(1.0).label == 4


def test_morris_steps_move_one_factor_by_more_than_half() -> None:
    steps = np.diff(Design(spreads("a", "b", "c"), MORRIS, 20, 1).shares.reshape(20, 4, 3), axis=1)
    moved = np.abs(steps)
    assert np.allclose(np.sort(moved, axis=2), [0.0, 0.0, 2.0 / 3.0])
    assert np.allclose(moved.sum(axis=1), 2.0 / 3.0)  # each factor once a path


def test_morris_finds_slopes_and_leaves_failed_paths_out() -> None:
    design = Design(spreads("a", "b", "c"), MORRIS, 50, 1)
    a, b, _ = np.array(labels(design)).T
    values = 3.0 * a - 2.0 * b
    values[[0, 9]] = np.nan
    found = sensitivity(design, values)
    assert found is not None
    assert found.note == "48 of 50 paths"
    wanted = {"a": (3.0, 3.0, 0.0), "b": (2.0, -2.0, 0.0), "c": (0.0, 0.0, 0.0)}
    for name, row in wanted.items():
        assert found.rows[name] == pytest.approx(row, abs=1e-9)
    bent = sensitivity(design, np.where(np.isfinite(values), a * b, np.nan))
    assert bent is not None
    assert bent.rows["a"][2] > 0.1  # sigma: its effect is not the same everywhere


def ishigami(x: np.ndarray) -> np.ndarray:
    a, b, c = x.T
    return np.asarray(np.sin(a) + 7.0 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a))


def test_sobol_indices_are_those_of_ishigamis_function() -> None:
    design = Design(spreads("a", "b", "c", low=-np.pi, high=np.pi), SALTELLI, 2048, 1)
    assert len(design) == 2048 * 5
    values = ishigami(np.array(labels(design)))
    whole = sensitivity(design, values)
    values[7] = np.nan
    broken = sensitivity(design, values)
    assert whole is not None and broken is not None
    assert (whole.note, broken.note) == ("2048 of 2048 bases", "1024 of 2048 bases")
    assert sensitivity(design, values) == broken
    # Known in closed form (Ishigami and Homma 1990).
    known = {"a": (0.3139, 0.5576), "b": (0.4424, 0.4424), "c": (0.0, 0.2437)}
    for found in (whole, broken):
        for name, (first, total) in known.items():
            assert found.rows[name][0] == pytest.approx(first, abs=0.05)
            assert found.rows[name][2] == pytest.approx(total, abs=0.05)
            assert 0.0 < found.rows[name][1] < 0.2


def test_what_does_not_change_and_what_mostly_failed_has_no_sensitivity() -> None:
    for method in (MORRIS, SALTELLI):
        design = Design(spreads("a", "b"), method, 8, 1)
        assert sensitivity(design, np.ones(len(design))) is None
        values = np.full(len(design), np.nan)
        values[:2] = (1.0, 2.0)
        assert sensitivity(design, values) is None
    design = Design(spreads("a"), "sobol", 8, 1)
    assert sensitivity(design, np.arange(8.0)) is None
