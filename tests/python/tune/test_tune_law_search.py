"""What a law's tuning goes over, and how."""

from dataclasses import replace

import numpy as np
import pytest
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes import RECIPES, find
from quiesce.law.rig import Damper, LawRig
from quiesce.tune.gains.aim import Aim
from quiesce.tune.gains.ranges import range_of
from quiesce.tune.gains.search import search, spread
from quiesce.tune.gains.space import TRACKER_GAIN, space_of

RIG = LawRig(
    "rig", ("body",), (Damper("damper", 0, None, 2000),), frozenset(),
    {"force of damper": 3000.0, "stroke of damper": 0.03, "stroke velocity of damper": 0.5},
    1000, None, 0,
)  # fmt: skip


@pytest.mark.parametrize(
    ("setting", "expected"),
    [
        (Setting("sky_N_s_m", 1.0, 0.0, 1e6, ""), (200.0, 180000.0)),
        (Setting("gain_N_s_m", 1.0, -1e6, 1e6, ""), (-20000.0, 20000.0)),
        (Setting("e3_A_s2_m2", 1.0, -1e6, 1e6, ""), (-2.0 / 0.15**2, 2.0 / 0.15**2)),
        (Setting("on_A", 20.0, 0.0, 20.0, ""), (0.5, 2.0)),
        (Setting("base_A", 0.0, 0.0, 1.5, ""), (0.0, 1.5)),  # no more than the recipe allows
        (Setting("band_m_s", 0.001, 0.0, 10.0, ""), (5e-5, 0.015)),
        (Setting("limit_N", 1e4, 0.0, 1e6, ""), (15.0, 3000.0)),
        (Setting("rate_1_s", 5.0, 0.0, 1e6, ""), (0.05, 500.0)),  # around its default
        (Setting("share", 0.5, 0.0, 1.0, ""), (0.0, 1.0)),
        (Setting("weight_1", 0.0, 0.0, 1e12, ""), (0.0, 0.0)),  # nothing is known of it
        (Setting("weight_1", 0.0, 0.0, 1e12, "", (1, 10)), (1, 10)),
        (Setting("mass_kg", 5.0, 0.0, 10.0, "", is_tuned=False), (5.0, 5.0)),
        (Setting("gain_N_s2_m", 2.0, 0.0, 1e6, ""), (0.02, 200.0)),  # no accelerometer
    ],
)
def test_a_range_comes_from_recipe_sensors_or_default(setting: Setting, expected: tuple) -> None:
    assert range_of(setting, RIG) == pytest.approx(expected)


def test_every_recipe_has_something_to_search_inside_of_what_it_allows() -> None:
    for recipe in RECIPES:
        space = space_of(recipe, RIG, "proportional" if recipe.tracker else "")
        assert space.searched, recipe.name
        for values in (space.values(np.full(len(space.searched), x)) for x in (0.0, 0.5, 1.0)):
            for one in recipe.settings:
                assert one.low <= values[one.name] <= one.high, (recipe.name, one.name)


def test_values_and_points_are_each_others_inverse() -> None:
    space = space_of(find("skyhook"), RIG, "proportional", asked=["limit_N=10:50"])
    by_name = {one.name: one for one in space.searched}
    assert by_name["sky_N_s_m"].is_log and not by_name["limit_N"].is_log
    values = space.values(np.array([0.5, 0.25, 0.5]))
    assert values["limit_N"] == 20.0 and values["sky_N_s_m"] == 6000.0
    assert space.point(values) == pytest.approx([0.5, 0.25, 0.5], abs=1e-3)
    assert space.parameters(values) == {TRACKER_GAIN: round(values[TRACKER_GAIN])}
    assert set(space.settings(values)) == {"sky_N_s_m", "limit_N"}


def test_what_is_fixed_stays_and_parameters_are_searched_when_asked_for() -> None:
    asked = ["velocity_cutoff_mHz=100:900"]
    space = space_of(find("skyhook"), RIG, "compare", ["limit_N=12"], asked)
    assert [one.name for one in space.searched] == ["sky_N_s_m", "velocity_cutoff_mHz"]
    values = space.values(np.array([0.0, 1.0]))
    assert values["limit_N"] == 12.0
    assert space.parameters(values) == {"velocity_cutoff_mHz": 900}


def test_whole_numbers_stay_whole() -> None:
    recipe = replace(find("modulated_friction"))
    space = space_of(recipe, RIG, "compare")
    points = spread(16, len(space.searched), 1)
    assert {space.values(point)["outward"] for point in points} == {0.0, 1.0}


def minimum(point: np.ndarray) -> np.ndarray:
    return np.sum((point - 0.3) ** 2, axis=1)


@pytest.mark.parametrize(("dimensions", "trials"), [(1, 40), (3, 95), (6, 7), (2, 1), (0, 5)])
def test_no_more_trials_than_asked_for_and_better_than_evenly_spread(
    dimensions: int, trials: int
) -> None:
    seen: dict[bytes, float] = {}

    def evaluate(points: np.ndarray) -> np.ndarray:
        costs = minimum(points)
        seen.update({np.round(p, 9).tobytes(): c for p, c in zip(points, costs, strict=True)})
        return costs

    search(evaluate, np.full(dimensions, 0.9), trials, 1)
    most = trials if dimensions else 0
    assert 0.9 * most <= len(seen) <= most  # one that comes twice is one trial
    if trials > 16 and dimensions:
        assert min(seen.values()) < minimum(spread(trials, dimensions, 1)).min()


def test_the_same_seed_asks_for_the_same_and_refused_points_do_no_harm() -> None:
    def asked(seed: int) -> list[np.ndarray]:
        found: list[np.ndarray] = []

        def evaluate(points: np.ndarray) -> np.ndarray:
            found.append(points.copy())
            return np.where(points[:, 0] > 0.5, np.inf, minimum(points))

        search(evaluate, np.array([0.2, 0.2]), 60, seed)
        return found

    one, again, other = asked(1), asked(1), asked(2)
    assert all((a == b).all() for a, b in zip(one, again, strict=True))
    assert (one[0][1:] != other[0][1:]).any()
    assert np.mean(one[-1][:, 0] <= 0.5) > 0.8  # it keeps away


def test_more_points_begin_with_the_same_ones() -> None:
    assert (spread(16, 3, 5)[:5] == spread(5, 3, 5)).all()


def test_the_worst_record_weighs_as_asked() -> None:
    runs = {"a": {"index": 1.0}, "b": {"index": 2.0}}
    assert Aim(worst_weight=0.0).cost(runs) == 1.5
    assert Aim(worst_weight=1.0).cost(runs) == (1.5 + 2.0) / 2


def test_a_recipe_without_settings_is_run_as_it_is() -> None:
    bare = Recipe("bare", "", "", "", (), find("add").make)
    space = space_of(bare, RIG, "")
    assert space.searched == () and space.start == {}
