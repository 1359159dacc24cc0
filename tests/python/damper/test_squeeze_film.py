"""The squeeze-mode film: the kernel beside the plant's damper, and how it is identified."""

from dataclasses import replace
from pathlib import Path

import conftest  # noqa: F401
import numpy as np
import pytest
from damper_actions import write
from quiesce.base.errors import UsageError
from quiesce.cli.main import main
from quiesce.damper import library
from quiesce.damper.candidates import names_of
from quiesce.damper.force_map import why_no_map
from quiesce.damper.inverse import ClosedForm, InverseByInterpolation, forces_at, monotone_range
from quiesce.damper.model_file import DamperModel, read_model
from quiesce.damper.simulate import simulator, with_rig
from quiesce_benchmarks.damper.synthetic import random_tones, record_of

pytestmark = pytest.mark.usefixtures("build")

GEOMETRY = {"plate_radius_m": 0.02, "gap_m": 0.0015, "coil_turns": 800.0, "coil_radius_m": 0.025}
FLUID = {
    "viscosity_Pa_s": 0.3,
    "viscosity_ratio": 0.02,
    "yield_coefficient": 4e-3,
    "yield_exponent": 1.1,
}
FILM = DamperModel("film", "squeeze_biviscosity", 1e-4, 0.01, {**GEOMETRY, **FLUID})
CURRENTS_A = (0.0, 1.0, 2.0, 3.0)
FIXES = [word for key, value in GEOMETRY.items() for word in ("--fix", f"{key}={value:g}")]


@pytest.mark.parametrize("ratio", [1.0, 0.02, 3e-5])
@pytest.mark.parametrize("current_A", [0.0, 1e-7, 0.1, 3.0])
def test_kernel_is_the_plants_damper(ratio: float, current_A: float, tmp_path: Path) -> None:
    film = DamperModel(
        "film", FILM.model, 1e-4, 0.01, {**FILM.parameters, "viscosity_ratio": ratio}
    )
    record = record_of(random_tones(2, (2.0, 40.0), 2e-4), 1000.0, 2000, current_A)
    plant_N = with_rig(library.DamperFile(write(tmp_path / "film.toml", film)), {})(record)
    assert simulator(film)(record) == pytest.approx(plant_N, rel=1e-9, abs=1e-15)


def test_file_may_leave_out_factor_and_exponent(tmp_path: Path) -> None:
    short = {key: value for key, value in FILM.parameters.items() if key != "yield_exponent"}
    whole = {**short, "yield_exponent": 1.0, "force_scale": 1.0}
    file = write(tmp_path / "film.toml", DamperModel("film", FILM.model, 1e-4, 0.01, short))
    record = record_of(random_tones(2, (2.0, 40.0), 1e-4), 1000.0, 200, 2.0)
    named = DamperModel("film", FILM.model, 1e-4, 0.01, whole)
    assert np.array_equal(simulator(read_model(file))(record), simulator(named)(record))


def write_tests(folder: Path, rows: int = 512) -> list[str]:
    """Files of 0.05 mm at 5 Hz, one a current."""
    files = []
    time_s = np.arange(rows) / 256.0
    angle = 2.0 * np.pi * 5.0 * time_s
    for current_A in CURRENTS_A:
        still = record_of(random_tones(1, (1.0, 2.0), 1e-5), 256.0, rows, current_A)
        speed = 2.0 * np.pi * 5.0 * 5e-5
        for values, wave in (
            (still.disp_m, 5e-5 * np.sin(angle)),
            (still.velocity_m_s, speed * np.cos(angle)),
            (still.accel_m_s2, -speed * 2.0 * np.pi * 5.0 * np.sin(angle)),
        ):
            values[:] = wave
        force_N = simulator(FILM)(still)
        file = folder / f"{current_A:g}A.csv"
        lines = [
            f"{t:.6f},{1e3 * x:.9f},{f:.9f}"
            for t, x, f in zip(time_s, still.disp_m, force_N, strict=True)
        ]
        file.write_text("\n".join(["time_s,disp_mm,force_N", *lines]) + "\n", encoding="utf-8")
        files.append(str(file))
    return files


def identify(folder: Path, *more: str) -> int:
    return main(
        [
            "identify", *write_tests(folder), "--current-a", "0,1,2,3", "--rig", "none",
            "--model", "squeeze_biviscosity", "--accept-values", "--effort", "quick",
            "--out", str(folder / "out"), *more,
        ]
    )  # fmt: skip


def test_identified_from_four_currents_and_read_by_a_plant(tmp_path: Path) -> None:
    assert identify(tmp_path, *FIXES) == 0
    file = tmp_path / "out/models/squeeze_biviscosity.toml"
    found = read_model(file).parameters
    for name, value in GEOMETRY.items():
        assert found[name] == value
    for name in ("viscosity_Pa_s", "viscosity_ratio", "yield_exponent"):
        assert found[name] == pytest.approx(FLUID[name], rel=0.02), name
    assert found["yield_coefficient"] == pytest.approx(FLUID["yield_coefficient"], rel=0.1)
    library.DamperFile(file)


def test_without_its_geometry_it_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert identify(tmp_path, *FIXES[2:]) == 2
    said = capsys.readouterr().err.strip().splitlines()
    assert len(said) == 1
    assert "--fix plate_radius_m=VALUE" in said[0] and "gap_m" not in said[0]


def test_impossible_geometry_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert identify(tmp_path, *FIXES, "--fix", "gap_m=-1") == 2
    assert "gap_m = -1" in capsys.readouterr().err


def test_groups_of_models_leave_it_out() -> None:
    for group in ("parametric", "all"):
        assert FILM.model not in names_of(group)
    assert names_of(FILM.model) == [FILM.model]


def test_its_current_has_no_closed_form() -> None:
    with pytest.raises(UsageError, match="interpolate"):
        ClosedForm(FILM, 3.0)


def test_its_inverse_knows_its_current() -> None:
    record = record_of(random_tones(2, (2.0, 40.0), 1e-4), 1000.0, 500, 0.0)
    forces_N = forces_at(FILM, record, CURRENTS_A)
    for current_A, force_N in zip(CURRENTS_A, forces_N, strict=True):
        alone = record_of(random_tones(2, (2.0, 40.0), 1e-4), 1000.0, 500, current_A)
        np.testing.assert_array_equal(force_N, simulator(FILM)(alone))
    found = monotone_range(FILM, 3.0)
    assert found.is_whole and why_no_map(found) == ""
    wanted_N = 0.5 * (forces_N[0] + forces_N[3])
    asked_A = InverseByInterpolation(FILM, 3.0, 61).currents(record, wanted_N)
    again_N = simulator(FILM)(replace(record, command=asked_A))
    assert again_N == pytest.approx(wanted_N, abs=2e-3 * float(np.abs(wanted_N).max()))
