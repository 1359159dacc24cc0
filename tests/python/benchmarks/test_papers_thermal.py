"""A damper that warms up in closed loop: stepping from Python, the inverse with temperature, the
benchmark's part."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from quiesce.base.errors import UsageError
from quiesce.base.paths import root
from quiesce.damper.data.split import Segment
from quiesce.damper.inverses.support_vector import Settings, train
from quiesce.damper.library import Scales
from quiesce.plant.library import Plant
from quiesce.plant.stepping import Run
from quiesce_benchmarks.papers import thermal_loop
from quiesce_benchmarks.papers.parts import thermal
from quiesce_benchmarks.part import Effort


@pytest.fixture(scope="module")
def segments():
    rng = np.random.default_rng(3)
    return thermal_loop.whole(thermal_loop.rig_records(rng, [20.0, 50.0, 80.0]))


def test_a_run_goes_on_from_rest_and_warms_up(tmp_path: Path):
    plant = thermal_loop.write_plant(tmp_path, heat_capacity_J_K=5.0)
    motion = Run(plant, 1000)
    assert (motion.now.stroke_m, motion.now.coil_A, motion.now.fluid_C) == (0.0, 0.0, 20.0)
    work_J = heat_J = 0.0
    for tick in range(4000):
        before = (
            motion.now.damper_force_N * motion.now.stroke_velocity_m_s,
            motion.now.coil_A,
            motion.now.fluid_C,
        )
        now = motion.advance(0.5, base_accel_m_s2=1.4 * math.sin(0.012 * (tick + 1)))
        work_J += 0.5e-3 * (before[0] + now.damper_force_N * now.stroke_velocity_m_s)
        coil_J = 0.5e-3 * thermal_loop.COIL_OHM * (before[1] ** 2 + now.coil_A**2)
        loss_J = 1e-3 * thermal_loop.CONDUCTANCE_W_K * (0.5 * (before[2] + now.fluid_C) - 20.0)
        heat_J += coil_J - loss_J
    assert now.coil_A == pytest.approx(0.5, abs=1e-3)
    assert work_J > 20.0
    assert 5.0 * (now.fluid_C - 20.0) == pytest.approx(work_J + heat_J, rel=1e-3)


def test_a_plant_without_temperature_has_none_and_bad_runs_are_refused():
    plant = Plant(root() / "sim_hil/data/plants/frame_3dof.toml")
    assert math.isnan(Run(plant).now.fluid_C)
    with pytest.raises(UsageError, match="ticks a second"):
        Run(plant, 0)
    motion = Run(plant)
    with pytest.raises(UsageError, match="simulation stopped"):
        for _ in range(1000):
            motion.advance(0.0, force_N=1e6)


def test_the_inverse_with_temperature_finds_the_current(segments):
    scales = Scales.of(segments)
    settings = Settings(rows=800)
    models = [train(segments, scales, 1, settings, knows) for knows in (True, False)]
    errors: list[list[float]] = [[], []]
    for one in segments[::7]:
        record = one.record
        for k in np.flatnonzero(np.abs(record.velocity_m_s) > 0.3 * scales.speed_m_s)[::9]:
            seen = record.force_N[k], record.disp_m[k], record.velocity_m_s[k]
            for model, found in zip(models, errors, strict=True):
                found.append(model.current_A(*seen, record.temperature_C[k]) - record.command[k])
    knowing, blind = (float(np.sqrt(np.mean(np.square(found)))) for found in errors)
    assert knowing < 0.15
    assert knowing < 0.7 * blind


def test_the_inverse_holds_releases_and_refuses(segments):
    scales = Scales.of(segments)
    model = train(segments, scales, 1, Settings(rows=300))
    assert model.knows_temperature
    assert model.current_A(100.0, 0.0, 0.0, 20.0, held_A=0.7) == 0.7
    assert model.current_A(-300.0, 0.0, 0.1, 20.0) == 0.0
    warm_A = [model.current_A(0.0, disp_m, 0.1, 80.0) for disp_m in (-0.02, 0.0, 0.02)]
    assert warm_A == [0.0, 0.0, 0.0]  # no force resists nothing
    assert 0.0 <= model.current_A(1e6, 0.0, 0.1, 20.0) <= model.max_current_A
    with pytest.raises(UsageError, match="two currents"):
        train([one for one in segments if one.record.level == 0.0], scales)
    cold = [
        Segment(replace(one.record, temperature_C=None), one.first, one.end) for one in segments
    ]
    with pytest.raises(UsageError, match="needs one in every test"):
        train([*segments, cold[0]], scales)
    assert not train(cold, scales, 1, Settings(rows=300), False).knows_temperature


@pytest.mark.slow  # a closed loop of half a minute, twice
def test_the_part_reports_its_figure(tmp_path: Path):
    found = thermal.measure(Effort(1, True, tmp_path))
    assert found.values["thermal_closed_loop"] == pytest.approx(found.reported["ratio"])
    assert 0.2 < found.values["thermal_closed_loop"] < 1.0
    assert found.reported["end_C"] > 40.0
