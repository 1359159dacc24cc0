"""The part of `benchmark papers` about inverses: whose damper it is, and what it reports."""

import conftest  # noqa: F401
import numpy as np
import pytest
from quiesce.base.paths import default_plant
from quiesce.damper.inverses.methods import METHODS
from quiesce_benchmarks.papers import parts
from quiesce_benchmarks.papers.parts import inverse
from quiesce_benchmarks.part import Effort, all_parts

pytestmark = pytest.mark.usefixtures("build")


def test_the_damper_is_the_plants_with_its_coil() -> None:
    damper = inverse.plant_damper(default_plant().parent)
    assert damper.name == "rd1005_kwok_tanh_smooth"
    assert damper.rig == {"rise_s": 0.010, "fall_s": 0.010}
    assert inverse.PLANT_MOST_A <= max(damper.valid["current_A"])


def test_every_method_and_both_peers_have_a_figure() -> None:
    assert all_parts(parts)["inverse"] is inverse
    names = [name for name, *_ in inverse.FIGURES]
    for method in (*METHODS, "constant", "ideal"):
        assert f"{inverse.FIGURE}_{method}" in names
    assert all(goal is None for _, _, goal, _ in inverse.FIGURES)


@pytest.mark.slow
def test_methods_lie_between_the_ideal_and_one_current(tmp_path) -> None:
    found = inverse.measure(Effort(1, True, tmp_path))
    assert set(found.values) == {name for name, *_ in inverse.FIGURES}
    ideal, constant = (found.values[f"{inverse.FIGURE}_{one}"] for one in ("ideal", "constant"))
    methods = [found.values[f"{inverse.FIGURE}_{one}"] for one in METHODS]
    assert found.values[inverse.FIGURE] == max(methods)
    assert ideal < min(methods) and max(methods) < 0.5 * constant
    again = inverse.measure(Effort(1, True, tmp_path))
    assert again.values == found.values
    by_task = found.reported["plant"]["by_task_pct"]
    assert all(np.isfinite(list(one.values())).all() for one in by_task.values())
