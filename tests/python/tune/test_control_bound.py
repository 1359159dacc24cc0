"""Periodic motion, bounds, pulses: against the published plant's figures and each other."""

import json
import os

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.optimum.bound import bound, first_guesses
from quiesce.optimum.constant import best_constant
from quiesce.optimum.goal import ACCEL, AMP, Goal, reference
from quiesce.optimum.periodic import drive, solve
from quiesce.optimum.store import BoundStore, case_key, plant_hash
from quiesce.plant.library import Plant
from quiesce.plant.variant import Variant, changed, read_plant_data, write_variant
from quiesce.tune.pulse import Pulse, PulseShape, best_pulse, command_of, tracked

PLANT_FILE = ROOT / "sim_hil/data/plants/squeeze_2012.toml"


@pytest.fixture(scope="module")
def plant(build) -> Plant:
    assert os.environ.get("QUIESCE_BUILD") or build == ROOT / "build"
    return Plant(PLANT_FILE)


# docs/howto/describe-a-plant.md: reductions of constant 5 A, from runs in time at a step of 20 us.
@pytest.mark.parametrize(
    ("freq_Hz", "amp_pct", "accel_pct"), [(5.0, 5.211, -30.628), (20.0, 26.535, 19.873)]
)
def test_constant_current_as_in_runs_in_time(plant, freq_Hz, amp_pct, accel_pct):
    ref = reference(drive(plant, freq_Hz))
    orbit = solve(ref.drive, 5.0)
    assert ref.amp_reduction_pct(orbit) == pytest.approx(amp_pct, abs=0.02)
    assert ref.accel_reduction_pct(orbit) == pytest.approx(accel_pct, abs=0.02)


def test_phase_is_that_of_the_fundamental(plant):
    orbit = solve(drive(plant, 10.0), 0.0)
    theta = 2.0 * np.pi * np.arange(len(orbit.disp_m)) / len(orbit.disp_m)
    wave = orbit.disp_fundamental_m * np.cos(theta + np.radians(orbit.disp_phase_deg))
    assert np.abs(orbit.disp_m - wave).max() < 1e-3 * orbit.amp_m
    turned = (orbit.accel_phase_deg - orbit.disp_phase_deg) % 180.0
    assert min(turned, 180.0 - turned) < 0.1


def test_refuses_current_beyond_the_driver(plant):
    with pytest.raises(UsageError, match="allowed are 0 .. 5"):
        solve(drive(plant, 5.0), np.array([1.0, 5.5]))


def test_library_names_what_is_wrong_in_a_file(build, tmp_path):
    file = tmp_path / "plant.toml"
    file.write_text(PLANT_FILE.read_text().replace("gap_m = 0.002", "gap_m = -1"))
    with pytest.raises(UsageError, match="gap_m"):
        Plant(file)


# reference values: amplitude 19.1 % and acceleration 8.3 % at 5 Hz, known to half a point.
@pytest.mark.parametrize(("goal", "least_pct"), [(AMP, 18.6), (ACCEL, 7.8)])
def test_bound_is_reached_from_different_starts(plant, goal, least_pct):
    ref = reference(drive(plant, 5.0))
    found = [bound(ref.drive, goal, starts=1), bound(ref.drive, goal, intervals=30, starts=2)]
    reduction = ref.amp_reduction_pct if goal is AMP else ref.accel_reduction_pct
    assert reduction(found[0].orbit) > least_pct
    assert reduction(found[1].orbit) == pytest.approx(reduction(found[0].orbit), abs=0.3)


def test_bound_keeps_the_limit_of_acceleration(plant):
    ref = reference(drive(plant, 5.0))
    optimum = bound(ref.drive, Goal(accel_limit=0.96), intervals=20, starts=1)
    assert ref.accel_ratio(optimum.orbit) < 0.965
    assert ref.amp_reduction_pct(optimum.orbit) > 14.0


def test_guesses_are_as_many_as_asked_for():
    guesses = list(first_guesses(10, 9, seed=1))
    assert len(guesses) == 9
    assert all(len(guess) == 10 and 0.0 <= guess.min() <= guess.max() <= 1.0 for guess in guesses)


def test_best_constant_is_between_steps_of_a_quarter(plant):
    at_5_Hz = best_constant(drive(plant, 5.0), ACCEL)
    at_20_Hz = best_constant(drive(plant, 20.0), AMP)
    assert at_5_Hz.current_A == pytest.approx(0.0, abs=0.1)
    assert at_20_Hz.current_A == pytest.approx(5.0, abs=0.01)


@pytest.mark.parametrize("ramp", [0.0, 0.1, 0.3])
@pytest.mark.parametrize("centre", [0.02, 0.5, 0.97])
def test_pulse_covers_what_its_definition_says(centre, ramp):
    count, fine = 20, 2000
    phase = (np.arange(count * fine) + 0.5) / (count * fine)
    away = np.abs((phase - centre + 0.5) % 1.0 - 0.5)
    inside = np.clip((0.2 - away) / max(ramp, 1e-3) + 0.5, 0.0, 1.0)
    expected = 0.1 + 0.6 * inside.reshape(count, fine).mean(axis=1)
    command = PulseShape(count).command(np.array([centre, 0.4, 0.7, 0.1, ramp]))
    assert command == pytest.approx(expected, abs=1e-3)


def test_tracked_pulse_is_the_pulse_that_was_optimised(plant):
    ref = reference(drive(plant, 5.0))
    first = Pulse(120.0 - ref.orbit.disp_phase_deg, 80.0, 5.0, 0.0)
    pulse, optimum = best_pulse(ref, AMP, first, has_ramp=False)
    orbit = tracked(ref.drive, pulse.moved(optimum.orbit.disp_phase_deg))
    assert ref.amp_reduction_pct(orbit) > 19.0
    assert orbit.amp_m == pytest.approx(optimum.orbit.amp_m, rel=1e-4)


def test_wide_pulse_is_a_constant_current(plant):
    command_A = command_of(drive(plant, 5.0), Pulse(33.0, 180.0, 4.0, 1.0))
    assert command_A == pytest.approx(4.0, abs=0.02)


def test_variant_changes_what_it_says_and_nothing_else(build, tmp_path):
    variant = Variant(rise_s=0.002, force=1.5, freq=0.9, drive_V=0.12)
    file = tmp_path / "variant.toml"
    write_variant(PLANT_FILE, variant, file)
    before, after = Plant(PLANT_FILE), Plant(file)
    assert (after.rise_s, after.fall_s, after.drive_V) == (0.002, 0.002, 0.12)
    assert after.modes[1].freq_Hz == pytest.approx(0.9 * before.modes[1].freq_Hz)
    assert after.modes[1].damping_ratio == pytest.approx(before.modes[1].damping_ratio)
    data = read_plant_data(PLANT_FILE)
    assert changed(data, variant)["damper"]["force_scale"] == pytest.approx(1.5 * 4.74e-5)
    assert changed(data, Variant()) == data


def test_variant_scales_frequencies_of_matrices():
    data = read_plant_data(ROOT / "sim_hil/data/plants/frame_3dof.toml")
    scaled = changed(data, Variant(freq=1.1))["structure"]
    stiffness = np.array(scaled["stiffness_N_m"]) / 1.21
    assert stiffness == pytest.approx(np.array(data["structure"]["stiffness_N_m"]))


def test_store_keeps_results_and_refuses_other_files(tmp_path):
    file = tmp_path / "bounds.json"
    key = case_key(PLANT_FILE, 5.0)
    BoundStore(file, "how").put(key, {"amp": {"amp_red_pct": 19.0}})
    again = BoundStore(file)
    assert again.get(key) == {"amp": {"amp_red_pct": 19.0}}
    assert again.has(key, ["amp"]) and not again.has(key, ["amp", "accel"])
    file.write_text(json.dumps({"schema": "other"}))
    with pytest.raises(UsageError, match="quiesce-bounds"):
        BoundStore(file)


def test_hash_tells_plants_apart_but_not_their_drives():
    data = read_plant_data(PLANT_FILE)
    assert plant_hash(changed(data, Variant(drive_V=0.2))) == plant_hash(data)
    assert plant_hash(changed(data, Variant(force=1.01))) != plant_hash(data)


def test_committed_bounds_are_of_the_published_plant():
    store = BoundStore(ROOT / "docs/results/bounds/squeeze_2012.json")
    case = store.get(case_key(PLANT_FILE, 5.0))
    assert case is not None
    assert case["amp"]["amp_red_pct"] > 19.0
