"""`./tools/benchmark laws`: its figures are what they say."""

import numpy as np
import pytest
from quiesce.base.errors import UsageError
from quiesce.compare.records import Record
from quiesce.compare.roads import CLASSES_1e6_m3, RATE_Hz, bump, read_road, road
from quiesce.law.recipes import RECIPES
from quiesce.tune.gains.defaults import INDEX
from quiesce.tune.gains.trials import Trial
from quiesce_benchmarks.laws import rigs, tuned
from quiesce_benchmarks.laws.parts import building, integers, unseen, unseen_road
from quiesce_benchmarks.laws.tuned import Tried
from quiesce_benchmarks.part import Effort


def test_integers_of_every_recipe_are_close(build, tmp_path) -> None:
    found = integers.measure(Effort(1, True, tmp_path))
    assert found.values["law_float_error_worst_pct"] < 1.0
    assert found.values["law_float_flips_worst_pct"] < 0.1
    assert found.tables[0].count("\n") == 19  # a row a recipe


def test_differences_are_of_what_was_published() -> None:
    ours = ([1.1, 2.0], [0.5, 0.6], [90.0, 100.0], [50.0])
    assert building.difference_pct(ours, ([1.0, 2.0], [], [100, 100], [])) == pytest.approx(10.0)
    assert building.difference_pct(ours, ([1.1, 2.0], [0.5, 0.3], [90, 100], [50])) == (
        pytest.approx(100.0)
    )


def trial(number: int, **index: float) -> Trial:
    """An index by record."""
    return Trial({"x": float(number)}, {name: {INDEX: value} for name, value in index.items()})


@pytest.fixture
def tried() -> Tried:
    """Law one is best where a is left out, but bad on a; settings 1 of two suit a alone."""
    constants = [{name: {INDEX: value} for name in "abc"} for value in (2.0, 1.2, 1.0)]
    return Tried(
        {
            "one": [trial(0, a=1.9, b=0.9, c=0.9), trial(1, a=2.0, b=1.0, c=1.0)],
            "two": [trial(0, a=0.95, b=0.95, c=1.1), trial(1, a=0.1, b=1.5, c=1.5)],
            "three": [Trial({"x": 0.0}, {}, "it does not fit"), Trial({"x": 1.0}, {}, "nor this")],
            "four": [Trial({"x": 0.0}, {}, "too large"), trial(1, a=3.0, b=3.0, c=3.0)],
        },
        constants,
    )


RECORDS = [Record(name, 100.0, np.ones(2)) for name in "abc"]


def test_law_and_settings_of_a_record_are_chosen_on_the_others(tried: Tried) -> None:
    law, chosen = tuned.chosen_law(unseen.AIM, tried.run(), "a")
    assert (law, chosen.values) == ("one", {"x": 0.0})  # what it does on a is not known
    law, chosen = tuned.chosen_law(unseen.AIM, tried.run(), "b")
    assert (law, chosen.values) == ("two", {"x": 1.0})
    assert tried.refused() == {"three": "it does not fit"}


def test_a_laws_row_is_of_what_it_was_not_tuned_on(tried: Tried) -> None:
    found = unseen.law_data("two", tried, RECORDS)
    # Without b: .95 and 1.1 cost 1.05, .1 and 1.5 cost 1.03, so that b gets 1.5.
    assert found["index_tuned"] == pytest.approx(np.mean([0.95, 1.5, 1.1]))
    assert found["index_tuned_worst"] == 1.5
    assert found["index_untuned"] == pytest.approx(1.0)
    assert found["index_passive_off"] == 2.0 and found["index_best_constant"] == 1.0
    assert found["beats_passive_off"] is True and found["beats_best_constant"] is False
    assert found["beats_hindsight_constant_of"] == 1  # a alone: .95 below 1
    started_refused = unseen.law_data("four", tried, RECORDS)
    assert started_refused["index_untuned"] is None
    assert "refused" in unseen.laws_table({"four": started_refused})


def test_a_road_is_judged_by_settings_of_the_others() -> None:
    def runs(**figure: float) -> dict:
        return {n: {"weighted_m_s2": x, "tyre_share": 2 - x} for n, x in figure.items()}

    one = [Trial({"x": 0.0}, runs(u=1.0, v=1.0)), Trial({"x": 1.0}, runs(u=0.1, v=1.2))]
    found = unseen_road.judged(Tried({"one": one}, [runs(u=1.5, v=1.5), runs(u=1.1, v=1.1)]), "u")
    comfort, tyre = (found.reported["laws"]["one"][key] for key in ("comfort", "tyre"))
    assert comfort["tuned"] == 1.0 and comfort["settings"] == {"x": 0.0}  # not the .1 of u itself
    assert comfort["best_constant"] == 1.1 and comfort["passive_off"] == 1.5
    assert comfort["beats_passive_off"] is True and comfort["beats_best_constant"] is True
    assert tyre["settings"] == {"x": 1.0} and tyre["tuned"] == 1.9
    assert tyre["beats_best_constant"] is False
    assert found.values["unseen_road_comfort_m_s2"] == 1.0


def test_every_recipe_gets_as_many_settings(build) -> None:
    own = tuned.candidates(rigs.BUILDING, unseen.START, None)
    assert {one.tunable.recipe.name for one in own} == {one.name for one in RECIPES}
    assert all(one.tunable.tracker != "inverse" for one in own)  # it has no map
    assert {len(one.settings(5, 1)) for one in own if one.tunable.space.searched} == {5}
    start = next(one for one in own if one.label == "lyapunov").settings(5, 1)[0]
    assert start["natural_Hz"] == 5.5


@pytest.mark.parametrize("kind", CLASSES_1e6_m3)
def test_a_road_has_the_density_of_its_class(kind: str) -> None:
    """Acceleration's mean square in a band of 2 to 10 Hz, from the height's density."""
    speed_m_s = 20.0
    accel = road(kind, 3.6 * speed_m_s).accel_m_s2[1000:]
    spectrum = np.abs(np.fft.rfft(accel)) ** 2 * 2 / len(accel) ** 2
    freq = np.fft.rfftfreq(len(accel), 1 / RATE_Hz)
    inside = (freq > 2) & (freq < 10)
    # G(n) = G0 (n / 0.1)^-2, f = n v: the acceleration's density is (2 pi)^4 f^2 G0 0.01 v.
    expected = (
        (2 * np.pi) ** 4 * (10**3 - 2**3) / 3 * 1e-6 * CLASSES_1e6_m3[kind] * 0.01 * speed_m_s
    )
    assert spectrum[inside].sum() == pytest.approx(expected, rel=0.25)
    assert (road(kind, 72.0).accel_m_s2 == road(kind, 72.0).accel_m_s2).all()


def test_a_bump_rises_to_its_height_and_comes_back() -> None:
    accel = bump(0.05, 2.0, 36.0).accel_m_s2
    speed, height = np.zeros(len(accel)), np.zeros(len(accel))
    speed[1:] = np.cumsum(accel[1:] + accel[:-1]) / (2 * RATE_Hz)
    height[1:] = np.cumsum(speed[1:] + speed[:-1]) / (2 * RATE_Hz)
    assert height.max() == pytest.approx(0.05, rel=0.02)
    assert abs(height[-1]) < 0.002


@pytest.mark.parametrize("text", ["", "F:72", "C", "C:x", "C:0", "C:400", "bump:1", "bump:9:1:36"])
def test_what_is_no_road_is_refused(text: str) -> None:
    with pytest.raises(UsageError, match="expected a class A to E"):
        read_road(text)
