"""`./tools/benchmark laws`: its figures are what they say."""

import numpy as np
import pytest
from quiesce.base.errors import UsageError
from quiesce.compare.roads import CLASSES_1e6_m3, RATE_Hz, bump, read_road, road
from quiesce_benchmarks.laws.parts import building, integers, unseen
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


def test_the_law_of_a_record_is_chosen_on_the_others() -> None:
    class One:
        def __init__(self, law: str, record: str, index: float) -> None:
            self.law, self.record, self.index = law, record, index

    good, bad = "skyhook on off", "friction"
    cells = [One(law, r, 2.0) for law in unseen.CANDIDATES for r in "abc" if law not in (good, bad)]
    cells += [One(good, r, x) for r, x in zip("abc", (0.1, 1.0, 1.0), strict=True)]
    cells += [One(bad, r, x) for r, x in zip("abc", (1.9, 0.9, 0.9), strict=True)]
    assert unseen.best_without(cells, "a") == bad  # what it does on a is not known
    assert unseen.best_without(cells, "b") == good


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
