"""Inverse damper models: the current gives the wanted force, or the nearest that there is."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from damper_actions import act, dissipative_tanh, kwok_rd1005, refused, two_tones, write
from quiesce.base.errors import UsageError
from quiesce.cli.identify import inverse as cli_inverse
from quiesce.damper.data.record import Record
from quiesce.damper.example import EXAMPLE
from quiesce.damper.force_map import MAGIC
from quiesce.damper.inverse import (
    ClosedForm,
    InverseByInterpolation,
    forces_at,
    interpolated,
    inverse_map,
    monotone_range,
    rising_until,
    steady_forces,
    why_no_closed_form,
)
from quiesce.damper.model_file import DamperModel, read_model
from quiesce.damper.simulate import simulator
from quiesce.table.file import read_words

pytestmark = pytest.mark.usefixtures("build")


def bare(damper: DamperModel) -> DamperModel:
    """Without coil lag."""
    return DamperModel(
        damper.name, damper.model, damper.stroke_m, damper.speed_m_s, damper.parameters
    )


def given(damper: DamperModel, record: Record, current_A: np.ndarray) -> np.ndarray:
    """The model's force when the current follows `current_A`."""
    return simulator(bare(damper))(two_tones(record.rate_Hz, record.duration_s, current_A))


def between(damper: DamperModel, record: Record, part: float, max_A: float) -> np.ndarray:
    """A feasible force: this part of the way from the force at 0 A to that at the largest."""
    low, high = forces_at(damper, record, [0.0, max_A])
    return low + part * (high - low)


@pytest.mark.parametrize("part", [0.1, 0.5, 0.9])
def test_interpolation_tracks_a_feasible_force_of_a_static_model(part: float) -> None:
    damper, record = dissipative_tanh(), two_tones()
    wanted = between(damper, record, part, 2.0)
    current_A = InverseByInterpolation(damper, 2.0, count=81).currents(record, wanted)
    error = given(damper, record, current_A) - wanted
    assert np.linalg.norm(error) <= 1e-3 * np.linalg.norm(wanted)


@pytest.mark.parametrize("part", [0.0, 0.1, 0.5, 0.9, 1.0])
def test_closed_form_is_exact(part: float) -> None:
    damper, record = dissipative_tanh(), two_tones()
    wanted = between(damper, record, part, 2.0)
    current_A = ClosedForm(damper, 2.0).currents(record, wanted)
    assert given(damper, record, current_A) == pytest.approx(wanted, abs=1e-6)


def test_closed_form_at_one_instant_agrees_with_that_along_a_record() -> None:
    damper, record = dissipative_tanh(), two_tones()
    inverse = ClosedForm(damper, 2.0)
    wanted = between(damper, record, 0.4, 2.0)
    along = inverse.currents(record, wanted)
    for n in (17, 230, 700):
        motion = (record.disp_m[n], record.velocity_m_s[n], record.accel_m_s2[n])
        assert inverse.current(*motion, wanted[n]) == pytest.approx(along[n], abs=1e-9)


def test_hysteretic_model_tracks_a_feasible_force() -> None:
    """The one state that a real damper has lags the copies at constant currents a little."""
    damper, record = bare(EXAMPLE), two_tones()
    low, high = np.abs(forces_at(damper, record, [0.0, 1.0]))
    side = np.sign(forces_at(damper, record, [1.0])[0])
    wanted = side * (low + 0.5 * np.maximum(high - low, 0.0))
    current_A = InverseByInterpolation(damper, 1.0).currents(record, wanted)
    error = given(damper, record, current_A) - wanted
    assert np.linalg.norm(error) <= 0.05 * np.linalg.norm(wanted)
    held = given(damper, record, np.full(len(record), 0.5)) - wanted
    assert np.linalg.norm(error) < 0.5 * np.linalg.norm(held)


@pytest.mark.parametrize("inverse", [ClosedForm, InverseByInterpolation])
def test_infeasible_forces_saturate(inverse: type) -> None:
    damper, record = dissipative_tanh(), two_tones()
    fast = np.abs(record.velocity_m_s) > 0.02
    side = np.sign(record.velocity_m_s)
    one = inverse(damper, 2.0)
    too_much = one.currents(record, 1e5 * side)
    assert too_much[fast] == pytest.approx(2.0)
    assert one.currents(record, -300.0 * side)[fast] == pytest.approx(0.0)
    assert one.currents(record, 1.0 * side)[fast] == pytest.approx(0.0)
    assert one.currents(record, np.zeros(len(record)))[fast] == pytest.approx(0.0)


def test_interpolation_takes_the_sign_from_the_force() -> None:
    currents_A = np.array([0.0, 1.0, 2.0])
    forces = np.array([[100.0, -100.0, 100.0, -50.0], [200, -200, 200, 50], [300, -300, 300, 150]])
    found = interpolated(currents_A, forces, np.array([150.0, -250.0, -150.0, 100.0]))
    assert found == pytest.approx([0.5, 1.5, 0.0, 1.5])


def test_interpolation_takes_the_least_of_two_currents() -> None:
    currents_A = np.array([0.0, 1.0, 2.0])
    forces = np.array([[0.0], [200.0], [100.0]])
    assert interpolated(currents_A, forces, np.array([150.0])) == pytest.approx(0.75)
    assert interpolated(currents_A, forces, np.array([900.0])) == pytest.approx(1.0)


# Monotone range


def test_kwoks_model_is_monotone_to_1_88_A_where_its_size_alone_follows_the_current() -> None:
    damper = kwok_rd1005(c_N_s_m=1232.0, delta=0.58, f0_N=57.0, k_N_m=5100.0)
    assert monotone_range(damper, 3.0).limit_A == pytest.approx(918.0 / 488.0, abs=1e-4)


def test_kwoks_published_set_is_not_monotone_to_3_A() -> None:
    found = monotone_range(kwok_rd1005(), 3.0)
    assert not found.is_whole
    assert found.limit_A == pytest.approx(1.88, abs=0.1)
    assert monotone_range(kwok_rd1005(), 1.5).is_whole


def test_steady_force_is_that_of_the_equations() -> None:
    damper = dissipative_tanh()
    found = steady_forces(damper, [-0.2, 0.1], [0.0, 1.0])
    for row, speed in zip(found.force_N, (0.2, 0.1), strict=True):
        for force, i in zip(row, (0.0, 1.0), strict=True):
            size = 40.0 + 900.0 * i - 150.0 * i**2
            expected = (600.0 + 700.0 * i) * speed + size * np.tanh(60.0 * speed)
            assert force == pytest.approx(expected, rel=1e-9)


def test_rising_until_finds_the_first_peak() -> None:
    currents_A = np.linspace(0.0, 2.0, 21)
    assert rising_until(currents_A, currents_A) == 2.0
    assert rising_until(currents_A, -currents_A) == 0.0
    assert rising_until(currents_A, 3.0 * currents_A - currents_A**2) == pytest.approx(1.5)


def test_map_gives_the_wanted_forces_back() -> None:
    found = steady_forces(dissipative_tanh(), [-0.1, 0.2], np.linspace(0.0, 2.0, 101))
    wanted = np.linspace(0.0, 2000.0, 21)
    currents, feasible = inverse_map(found, wanted)
    assert feasible.any() and not feasible.all()
    for row, current, ok in zip(found.force_N, currents, feasible, strict=True):
        back = np.interp(current[ok], found.currents_A, row)
        assert back == pytest.approx(wanted[ok], abs=1e-6)


# Refused, and why there is no closed form


@pytest.mark.parametrize(
    ("damper", "why"),
    [
        (EXAMPLE, "remembers"),
        (kwok_rd1005(), "delta follows the current"),
        (dissipative_tanh(), ""),
    ],
)
def test_reason_why_there_is_no_closed_form(damper: DamperModel, why: str) -> None:
    assert why in why_no_closed_form(damper)
    if why:
        with pytest.raises(UsageError, match="interpolate instead"):
            ClosedForm(damper, 1.0)


@pytest.mark.parametrize("current_A", [0.0, -1.0, float("nan"), float("inf")])
def test_largest_current_has_to_be_above_zero(current_A: float) -> None:
    for make in (ClosedForm, InverseByInterpolation, monotone_range):
        with pytest.raises(UsageError, match="above 0"):
            make(dissipative_tanh(), current_A)


def test_published_file_of_kwoks_model_is_monotone_to_about_1_88_A() -> None:
    """With its sign of the displacement: mid-stroke is neither side."""
    damper = read_model(ROOT / "sim_hil/data/dampers/rd1005_kwok_tanh.toml")
    assert monotone_range(damper, 3.0).limit_A == pytest.approx(1.88, abs=0.1)


# Command line


def test_command_writes_map_forces_and_plot(tmp_path: Path, capsys) -> None:
    file = write(tmp_path / "damper.toml", kwok_rd1005())
    assert act(cli_inverse, file, "--max-current-A", "3", "--out", tmp_path / "out") == 0
    assert "A only" in capsys.readouterr().out
    with (tmp_path / "out/inverse.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert {row["feasible"] for row in rows} == {"0", "1"}
    assert max(float(row["current_A"]) for row in rows) < 2.1
    assert (tmp_path / "out/forces.csv").stat().st_size > 1000
    assert (tmp_path / "out/inverse.svg").read_text(encoding="utf-8").lstrip().startswith("<?xml")
    words = read_words(tmp_path / "out/map.table")
    assert words[0] == MAGIC and words[2] == len(words)


def test_command_without_a_map_says_why_and_leaves_none(tmp_path: Path, capsys) -> None:
    constant = write(tmp_path / "damper.toml", dissipative_tanh(c_N_s_m=600.0, alpha_N=300.0))
    (tmp_path / "out").mkdir()
    (tmp_path / "out/map.table").write_text("of another damper")
    assert act(cli_inverse, constant, "--max-current-A", "1", "--out", tmp_path / "out") == 0
    told = capsys.readouterr().out
    assert "no map for a controller: the current changes the force by 0 mN" in told
    assert "map.table" not in told
    assert not (tmp_path / "out/map.table").exists()


def test_command_tells_the_range_as_json(tmp_path: Path, capsys) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    assert act(cli_inverse, file, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["is_monotone"] is True and found["monotone_to_A"] == 1.0


def test_model_that_is_no_kernel_has_an_inverse_as_well(capsys) -> None:
    file = ROOT / "sim_hil/data/dampers/rd8040_anfis27.toml"
    assert act(cli_inverse, file, "--max-current-A", "1", "--max-speed-m-s", "0.09") == 0
    assert "velocity" in capsys.readouterr().out


def test_force_that_does_not_follow_the_current_is_told(tmp_path: Path, capsys) -> None:
    constant = dissipative_tanh(c_N_s_m=600.0, alpha_N=300.0)
    file = write(tmp_path / "damper.toml", constant)
    assert act(cli_inverse, file, "--max-current-A", "1") == 0
    assert "no inverse" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "what"),
    [
        ((), "--max-current-A"),
        (("--max-current-A", "-1"), "expected a current"),
        (("--max-current-A", "nan"), "expected a current"),
        (("--max-current-A", "1", "--max-speed-m-s", "0"), "expected a speed"),
        (("--max-current-A", "1", "--amplitude-mm", "x"), "expected a length"),
    ],
)
def test_bad_options_are_refused(options: tuple[str, ...], what: str, tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", dissipative_tanh())
    assert what in refused(cli_inverse, file, *options)


def test_bad_model_files_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "bad.toml"
    file.write_text("schema = 3\n", encoding="utf-8")
    assert "bad.toml" in refused(cli_inverse, file, "--max-current-A", "1")
    assert "no such file" in refused(cli_inverse, tmp_path / "no.toml", "--max-current-A", "1")


def test_a_force_that_is_not_finite_is_refused() -> None:
    with pytest.raises(UsageError, match="its force is not finite; a lower --max-speed-m-s"):
        monotone_range(replace(EXAMPLE, speed_m_s=1e3, stroke_m=1e3), 1.0)


def test_model_without_a_speed_says_which_options_state_it() -> None:
    file = ROOT / "sim_hil/data/dampers/squeeze_2012_film.toml"
    assert "--amplitude-mm" in refused(cli_inverse, file, "--max-current-A", "3")
    options = ("--max-current-A", "3", "--amplitude-mm", "0.05", "--max-speed-m-s", "0.01")
    assert act(cli_inverse, file, *options) == 0
