"""What is held where a constant current costs acceleration: by hand, and on the published plant."""

import numpy as np
from conftest import ROOT
from quiesce.optimum.goal import reference
from quiesce.optimum.periodic import drive, solve
from quiesce.plant.library import Plant
from quiesce.tune.narrow import NEVER, dearest_run, narrow_parameters
from quiesce.tune.work import figures
from quiesce_benchmarks.lock.rig import NARROW

PUBLISHED = ROOT / "sim_hil/data/plants/squeeze_2012.toml"
LEVELS_A = (0.0, 0.5, 1.0, 2.0)


def rows(*accel_pct: tuple[float, ...]) -> list[dict]:
    """Of each frequency: reductions by level; 60 mm/s2 without current."""
    return [
        {
            "uncontrolled": {"accel_rms_mm_s2": 60.0},
            "constants": [
                {"current_A": level_A, "accel_red_pct": pct}
                for level_A, pct in zip(LEVELS_A, of_one, strict=True)
            ],
        }
        for of_one in accel_pct
    ]


DEAR, FREE = (0.0, -1.0, -3.0, -20.0), (0.0, 5.0, 10.0, 20.0)


def test_below_resonance_it_reaches_below_the_table() -> None:
    found = narrow_parameters((4.0, 5.0, 6.0, 7.0), rows(DEAR, DEAR, FREE, FREE), 2000)
    assert found == {
        "narrow_current_mA": 500,  # 1 % worse than none; 1 A is 3 % worse
        "narrow_low_mHz": 3200,
        "narrow_high_mHz": 5500,
        "narrow_least_um_s2": 20000,
    }


def test_above_it_from_half_way_to_the_table_s_end() -> None:
    found = narrow_parameters((4.0, 5.0, 6.0, 7.0), rows(FREE, FREE, DEAR, DEAR), 2000)
    assert (found["narrow_low_mHz"], found["narrow_high_mHz"]) == (5500, 7000)


def test_where_the_unlock_current_costs_nothing_it_is_never_used() -> None:
    assert narrow_parameters((4.0, 5.0), rows(FREE, FREE), 2000) == NEVER
    assert narrow_parameters((4.0, 5.0), rows(DEAR, DEAR), 0) == NEVER


def test_the_dearest_of_several_runs() -> None:
    assert dearest_run(np.array([2.0, 2.0, 0.0, 9.0, 0.5])) == slice(3, 4)
    assert dearest_run(np.array([0.5, 0.9])) is None
    assert dearest_run(np.array([1.0, 3.0])) == slice(0, 2)


def test_the_benchmark_takes_what_is_found_for_the_published_plant() -> None:
    plant = Plant(PUBLISHED)
    freqs_Hz = np.arange(4.0, 9.1, 0.5)
    found = []
    for freq_Hz in freqs_Hz:
        ref = reference(drive(plant, float(freq_Hz)))
        levels_A = np.linspace(0.0, plant.max_current_A, 21)
        found.append(
            {
                "uncontrolled": {"accel_rms_mm_s2": 1e3 * ref.orbit.accel_rms_m_s2},
                "constants": [
                    {"current_A": float(one), **figures(ref, solve(ref.drive, float(one)))}
                    for one in levels_A
                ],
            }
        )
    made = narrow_parameters(freqs_Hz.tolist(), found, 5000)
    assert [f"{name}={value}" for name, value in made.items()] == NARROW
