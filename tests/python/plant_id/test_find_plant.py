"""Identification: a simulated plant comes back from its recording, within what is reported."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.plant.library import Plant
from quiesce.plant.variant import Variant, read_plant_data
from quiesce.plant_id.find import FoundPlant, find_plant
from quiesce.plant_id.modes import instantaneous_freq_Hz
from quiesce.plant_id.recording import fit_sine, read_sweep_recording
from quiesce.plant_id.simulate import record
from quiesce.plant_id.sweep import SweepPlan, timeline, write_line
from quiesce_benchmarks.sweep.cases import (
    Case,
    by,
    compare,
    force_on_mode1,
    reduction_errors,
    write_case,
)

pytestmark = pytest.mark.slow  # each finds a plant

NOMINAL = ROOT / "sim_hil/data/plants/squeeze_2012.toml"
SHORT = SweepPlan(
    rate_Hz=1000, sweep_s=16.0, dwell_Hz=(5.0, 12.0), hold_s=0.4, rest_s=1.2, max_current_A=5.0
)


def quiet(_: str) -> None:
    pass


def recorded(file: Path, plan: SweepPlan, plant: Path = NOMINAL, seed: int = 1) -> Path:
    line = timeline(plan)
    write_line(file, line, record(Plant(plant), line, seed))
    return file


@pytest.fixture(scope="module")
def nominal(build, tmp_path_factory) -> FoundPlant:
    folder = tmp_path_factory.mktemp("nominal")
    return find_plant(recorded(folder / "recording.csv", SHORT), folder / "out", tell=quiet)


def z_score(found: FoundPlant, name: str, true: float) -> float:
    """Distance from the truth in standard errors."""
    return math.log(found.fit.values[name] / true) / found.fit.error(name)


def test_modes_come_back(nominal: FoundPlant) -> None:
    true = Plant(NOMINAL).modes
    modes = Plant(nominal.plant_file).modes
    assert len(modes) == 2
    for found, mode in zip(modes, true, strict=True):
        assert found.freq_Hz == pytest.approx(mode.freq_Hz, rel=1e-3)
        assert found.damping_ratio == pytest.approx(mode.damping_ratio, rel=0.02)
    assert nominal.fit.misfit == pytest.approx(1.0, abs=0.05)


def test_truth_is_within_the_reported_errors(nominal: FoundPlant) -> None:
    truth = {
        "mode1_freq_Hz": 11.5,
        "mode1_residue_m_s2_V": 0.1727 * 4.4086 * 2.96,
        "corner_Hz": 5.4,
        "mode2_shape_ratio": 2.5316 / 4.4086,
        "force_scale": 4.74e-5 * 4.4086**2,
        "viscosity_ratio": 3e-5,
        "rise_s": 0.005,
        "fall_s": 0.005,
    }
    scores = {name: z_score(nominal, name, true) for name, true in truth.items()}
    assert max(map(abs, scores.values())) < 4.0, scores
    # And the errors are small enough to say something.
    assert nominal.fit.error("force_scale") < 0.01
    assert nominal.fit.error("rise_s") < 0.05


def test_reductions_agree_with_the_true_plant(nominal: FoundPlant) -> None:
    errors = reduction_errors(Plant(NOMINAL), Plant(nominal.plant_file))
    assert max(errors.values()) < 0.5, errors


def test_report_tells_values_intervals_and_assumptions(nominal: FoundPlant) -> None:
    text = nominal.report_file.read_text()
    for words in ("95 % interval", "modal mass", "tied:", "gap_m", "force_scale"):
        assert words in text
    figures = json.loads((nominal.report_file.parent / "identify.json").read_text())
    by_name = {one["name"]: one for one in figures["parameters"]}
    assert by_name["rise_s"]["low_95"] < 0.005 < by_name["rise_s"]["high_95"] * 1.05
    for name in ("sweep.png", "dwells.png"):
        assert (nominal.report_file.parent / name).stat().st_size > 10000


def test_plant_check_accepts_the_plant(nominal: FoundPlant, quiesce) -> None:
    result = quiesce("plant", "check", nominal.plant_file)
    assert result.returncode == 0, result.stderr
    assert "is valid" in result.stdout


def test_another_plant_comes_back_with_the_first_as_base(build, tmp_path: Path) -> None:
    change = by(Variant(rise_s=0.010, fall_s=0.004, force=1.5, freq=1.1))
    found = compare(Case("variant", change, plan=SHORT), tmp_path, seed=2)
    assert found.freq_pct < 0.1
    assert abs(found.force_pct) < 1.0
    assert abs(found.rise_ms) < 0.8
    assert abs(found.fall_ms) < 0.8
    assert found.worst_points < 1.0, found.points


def test_modal_mass_scales_forces_and_nothing_else(nominal: FoundPlant, tmp_path: Path) -> None:
    heavy = find_plant(nominal.recording.file, tmp_path / "out", modal_mass_kg=4.0, tell=quiet)
    light, found = Plant(nominal.plant_file), Plant(heavy.plant_file)
    assert found.modes[0].at_sensor == pytest.approx(0.5)
    assert found.shaker_per_V(10.0) == pytest.approx(4.0 * light.shaker_per_V(10.0), rel=1e-3)
    tables = [read_plant_data(file) for file in (nominal.plant_file, heavy.plant_file)]
    forces = [
        force_on_mode1(table, mode.at_damper)
        for table, mode in zip(tables, (light.modes[0], found.modes[0]), strict=True)
    ]
    assert forces[1] == pytest.approx(forces[0], rel=1e-3)


def test_without_current_steps_the_damper_is_the_base_plants(build, tmp_path: Path) -> None:
    plan = replace(SHORT, dwell_Hz=(8.0,), max_current_A=1e-9)
    file = recorded(tmp_path / "recording.csv", plan)
    text = file.read_text().splitlines()
    rows = [",".join([*row.split(",")[:2], "0", row.split(",")[3]]) for row in text[1:]]
    file.write_text("\n".join([text[0], *rows]) + "\n")
    found = find_plant(file, tmp_path / "out", tell=quiet)
    assert any("no current steps" in warning for warning in found.warnings)
    assert any("none were measured" in warning for warning in found.warnings)
    tables = [read_plant_data(file) for file in (NOMINAL, found.plant_file)]
    shapes = [Plant(file).modes[0].at_damper for file in (NOMINAL, found.plant_file)]
    true, carried = (force_on_mode1(*pair) for pair in zip(tables, shapes, strict=True))
    assert carried == pytest.approx(true, rel=1e-9)


def test_clipped_and_noisy_recordings_are_told(build, tmp_path: Path) -> None:
    table = read_plant_data(NOMINAL)
    table["sensor"] |= {"full_scale_g": 0.02, "bits": 16, "noise_mg": 3.0}

    def worse(trial: dict) -> None:
        trial.update(table)

    folder = tmp_path / "plant"
    folder.mkdir()
    file = write_case(Case("poor", worse), folder)
    recording = read_sweep_recording(recorded(tmp_path / "recording.csv", SHORT, file))
    assert any("clipped" in warning for warning in recording.warnings)
    assert any("5 Hz" in warning and "noise" in warning for warning in recording.warnings)


def test_sine_is_fitted_to_rounding() -> None:
    time_s = np.arange(3000) / 500.0
    values = 0.3 * np.sin(2.0 * np.pi * (7.123 * time_s + 0.2))
    freq_Hz, sine, cosine, misfit = fit_sine(time_s, values, 500)
    assert freq_Hz == pytest.approx(7.123, abs=1e-7)
    assert math.atan2(cosine, sine) / (2.0 * math.pi) == pytest.approx(0.2, abs=1e-5)
    assert misfit < 1e-4


def test_instantaneous_frequency_follows_a_sweep() -> None:
    plan = SweepPlan(sweep_s=20.0)
    line = timeline(plan)
    start, count = round(plan.rest_s * plan.rate_Hz), round(plan.sweep_s * plan.rate_Hz)
    drive_V = line.drive_V[start : start + count]
    true_Hz = np.gradient(line.phase_cycles[start : start + count]) * plan.rate_Hz
    found_Hz = instantaneous_freq_Hz(drive_V, plan.rate_Hz)
    middle = slice(1000, -1000)
    assert np.max(np.abs(found_Hz[middle] / true_Hz[middle] - 1.0)) < 0.02
