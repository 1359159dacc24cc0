"""Exported damper models give the library's forces in other programs."""

import ctypes
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from damper_actions import (
    act,
    dissipative_tanh,
    kwok_rd1005,
    middle_of,
    refused,
    two_tones,
    write,
)
from learned_examples import LEARNED, LIMITS, layers, learned, network
from quiesce.base.errors import UsageError
from quiesce.cli.identify import export
from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.example import EXAMPLE
from quiesce.damper.export.c_names import c_name
from quiesce.damper.export.learned_c import TITLES
from quiesce.damper.model_file import DamperModel, read_model
from quiesce.damper.simulate import simulator_of_file
from scipy.io import loadmat

pytestmark = pytest.mark.usefixtures("build")
FLAGS = (
    "-std=c11", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion",
    "-Wshadow", "-Werror",
)  # fmt: skip


def built(folder: Path, *arguments: str, compiler: str = "gcc") -> None:
    """Without a warning."""
    done = subprocess.run(
        [compiler, *FLAGS, *arguments], cwd=folder, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr


def compiled(folder: Path, name: str, compiler: str = "gcc") -> ctypes.CDLL:
    """The exported model as a shared library, with the folder's own program as its main()."""
    sources = (f"{name}.c", "main.c", "-lm")
    built(folder, "-shared", "-fPIC", "-o", f"lib{name}.so", *sources, compiler=compiler)
    return ctypes.CDLL(str(folder / f"lib{name}.so"))


def passes_its_check(folder: Path) -> bool:
    """What main() of a folder that `compiled` has been at says."""
    return ctypes.CDLL(str(folder / f"lib{folder.name}.so")).main() == 0


def forces(code: ctypes.CDLL, name: str, record: Record) -> np.ndarray:
    """The exported model along a record, one call a sample."""
    state = ctypes.create_string_buffer(65536)
    reset, step = getattr(code, f"{name}_reset"), getattr(code, f"{name}_step")
    step.restype = ctypes.c_double
    step.argtypes = [ctypes.c_void_p, *[ctypes.c_double] * 5]
    reset(state)
    rows = zip(record.disp_m, record.velocity_m_s, record.accel_m_s2, record.command, strict=True)
    return np.array([step(state, *row, 1.0 / record.rate_Hz) for row in rows])


def exported(folder: Path, damper: DamperModel, record: Record, *options: str) -> np.ndarray:
    file = write(folder / "damper.toml", damper)
    assert act(export, file, "--to", "c", "--out", folder / "one", *options) == 0
    return forces(compiled(folder / "one", "one"), "one", record)


def library_force(damper: DamperModel, record: Record) -> np.ndarray:
    """With as many integration steps as the exported code takes: by the model's own speed."""
    one, orders, row = damper.kernel_row()
    rate_1_s = max(
        library.module().fastest_rate_1_s(
            one.name, library.values_at(one, orders, row, current_A), damper.speed_m_s
        )
        for current_A in (record.command.min(), record.command.max())
    )
    steps = library.substeps_for(rate_1_s, record.rate_Hz)
    return library.simulate(one, orders, row, library.motion(record), steps)[0]


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "kernel" in metafunc.fixturenames:
        try:
            names = sorted(library.models())
        except UsageError:
            names = []
        metafunc.parametrize("kernel", names)


def test_every_kernel_as_c_has_the_bits_of_the_library(kernel: str, tmp_path: Path) -> None:
    record = two_tones(duration_s=1.0)
    damper = middle_of(library.model(kernel))
    expected = library_force(damper, record)
    assert np.abs(expected).max() > 1.0
    assert exported(tmp_path, damper, record).tolist() == expected.tolist()
    assert passes_its_check(tmp_path / "one")


def test_coil_lag_and_current_laws_have_the_bits_of_the_library(tmp_path: Path) -> None:
    record = two_tones(current_A=np.where(np.arange(1000) // 130 % 2, 0.9, 0.1))
    lagging = replace(EXAMPLE, speed_m_s=0.01)  # one step between two samples at either level
    assert exported(tmp_path, lagging, record).tolist() == library_force(lagging, record).tolist()


def test_folder_builds_and_checks_itself_with_cmake(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    assert act(export, file, "--to", "c", "--out", tmp_path / "my_damper") == 0
    files = {one.name for one in (tmp_path / "my_damper").iterdir()}
    assert files == {"my_damper.h", "my_damper.c", "main.c", "CMakeLists.txt", "README.md"}
    for command in (
        ["cmake", "-S", "my_damper", "-B", "build"],
        ["cmake", "--build", "build"],
        ["ctest", "--test-dir", "build", "--output-on-failure"],
    ):
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stdout + done.stderr
    readme = (tmp_path / "my_damper/README.md").read_text()
    assert "Ikhouane and Rodellar 2005" in readme and "equal to the last bit" in readme


def test_folders_own_program_sees_another_parameter(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    assert act(export, file, "--to", "c", "--out", tmp_path / "one") == 0
    source = tmp_path / "one/one.c"
    text = source.read_text()
    assert "{60.0, 820.0, -180.0}" in text
    source.write_text(text.replace("{60.0, 820.0, -180.0}", "{60.0, 820.0, -180.001}"))
    compiled(tmp_path / "one", "one")
    assert not passes_its_check(tmp_path / "one")


PLAIN = {
    "viscous": {"base_N_s_m": 20.0, "per_A_N_s_m": 5.0, "stroke_m": 0.02},
    "switched_stiffness": {"base_N_s_m": 20.0, "per_A_N_s_m": 5.0, "base_N_m": 900.0,
                           "per_A_N_m": 70.0, "stroke_m": 0.02},
    "elastomer": {"area_m2": 2e-3, "thickness_m": 0.02, "storage_MPa": [1.2, 0.7, -0.4],
                  "loss_factor": 0.2, "loss_freq_Hz": 5.0, "stroke_m": 0.01},
}  # fmt: skip


@pytest.mark.parametrize("model", sorted(PLAIN))
def test_springs_and_dashpots_as_c_have_the_bits_of_the_library(model: str, tmp_path: Path) -> None:
    """The elastomer's modulus is highest at 0.875 A."""
    record = two_tones(current_A=np.linspace(0.0, 1.2, 1000))
    file = write(tmp_path / "damper.toml", DamperModel(model, model, 0.0, 0.0, PLAIN[model]))
    # These know no speed and have their stroke among the parameters.
    file.write_text(re.sub(r"^(stroke_m|speed_m_s) = 0.0\n", "", file.read_text(), flags=re.M))
    expected = simulator_of_file(file)[1](record)
    assert act(export, file, "--to", "c", "--out", tmp_path / "one") == 0
    found = forces(compiled(tmp_path / "one", "one"), "one", record)
    assert found.tolist() == expected.tolist()
    assert passes_its_check(tmp_path / "one")


def test_published_film_as_c_gives_the_librarys_force(tmp_path: Path) -> None:
    record = two_tones(current_A=np.linspace(0.0, 3.0, 1000))
    published = read_model(ROOT / "sim_hil/data/dampers/squeeze_2012_film.toml")
    film = DamperModel("film", published.model, 0.05, 0.2, published.parameters)
    assert exported(tmp_path, film, record).tolist() == library_force(film, record).tolist()


RIG = {"inertia_kg": 3.0, "skew_s": 0.002, "offset_N": 25.0, "drift_N_s": 4.0, "rise_s": 0.01,
       "fall_s": 0.03}  # fmt: skip


def test_rig_is_there_only_when_asked_for(tmp_path: Path) -> None:
    record = two_tones(current_A=np.linspace(0.0, 1.0, 1000))
    damper = kwok_rd1005()
    on_rig = DamperModel(damper.name, damper.model, 0.025, 0.3, damper.parameters, RIG)
    lag_only = {key: RIG[key] for key in ("rise_s", "fall_s")}
    alone = DamperModel(damper.name, damper.model, 0.025, 0.3, damper.parameters, lag_only)
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    with_rig = exported(tmp_path / "a", on_rig, record, "--with-rig")
    assert with_rig == pytest.approx(library_force(on_rig, record), abs=1e-6)
    without = exported(tmp_path / "b", on_rig, record)
    assert without == pytest.approx(library_force(alone, record), abs=1e-6)


def test_field_law_is_part_of_the_code(tmp_path: Path) -> None:
    record = two_tones(current_A=np.linspace(0.0, 1.2, 1000))
    damper = dissipative_tanh()
    field = {"field_exponent": 1.6, "field_saturation": 0.8, "field_ref_A": 1.0}
    bent = DamperModel(damper.name, damper.model, 0.025, 0.3, damper.parameters, field)
    found = exported(tmp_path, bent, record)
    assert found == pytest.approx(library_force(bent, record), abs=1e-6)
    assert np.abs(found - library_force(damper, record)).max() > 10.0


@pytest.mark.skipif(not shutil.which("clang-14"), reason="clang-14 is not installed")
def test_second_compiler_has_no_complaint(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    assert act(export, file, "--to", "c", "--out", tmp_path / "one") == 0
    record = two_tones()
    found = forces(compiled(tmp_path / "one", "one", "clang-14"), "one", record)
    assert found.tolist() == library_force(EXAMPLE, record).tolist()


def test_two_models_live_in_one_program(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    for name in ("front", "rear"):
        assert act(export, file, "--to", "c", "--out", tmp_path / name) == 0
    built(tmp_path, "-shared", "-fPIC", "-o", "both.so", "front/front.c", "rear/rear.c", "-lm")


@pytest.mark.parametrize("name", ["spencer_prototype", "seat_damper"])
def test_damper_in_volts_is_in_volts_everywhere(name: str, tmp_path: Path) -> None:
    file = ROOT / f"sim_hil/data/dampers/{name}.toml"
    assert act(export, file, "--to", "c", "--out", tmp_path / "one") == 0
    texts = {one.name: one.read_text() for one in (tmp_path / "one").iterdir()}
    assert "command_V: the voltage that the driver is asked for" in texts["one.h"]
    assert "command (V)" in texts["main.c"] and "command_V, dt_s" in texts["README.md"]
    for file_name, text in texts.items():
        assert not re.search(r"[a-z]_A\b|current", text), file_name
    record = replace(two_tones(current_A=np.linspace(0.0, 2.25, 1000)), command_unit="V")
    found = forces(compiled(tmp_path / "one", "one"), "one", record)
    expected = library_force(read_model(file), record)
    assert np.abs(found - expected).max() <= 1e-6 * np.abs(expected).max()
    assert passes_its_check(tmp_path / "one")
    # The check goes up to the largest voltage that the file states.
    assert "2.25," in texts["main.c"]


def test_mat_file_of_a_damper_in_volts_says_so(tmp_path: Path) -> None:
    file = ROOT / "sim_hil/data/dampers/seat_damper.toml"
    assert act(export, file, "--to", "mat", "--out", tmp_path / "one.mat") == 0
    found = loadmat(tmp_path / "one.mat", simplify_cells=True)["damper"]
    assert "effective voltage in V" in found["law"]


def test_first_step_has_the_coil_at_its_command_and_says_so(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    assert act(export, file, "--to", "c", "--out", tmp_path / "one") == 0
    for name in ("one.h", "README.md"):
        text = (tmp_path / "one" / name).read_text()
        assert "first step takes its command as the coil's current at once" in text


# Learned models (learned_examples.py)


@pytest.mark.parametrize("name", sorted(LEARNED))
def test_learned_model_as_c_gives_the_librarys_force(name: str, tmp_path: Path) -> None:
    record = two_tones(current_A=np.linspace(-0.1, 1.1, 1000))
    file = write(tmp_path / "damper.toml", LEARNED[name])
    expected = simulator_of_file(file)[1](record)
    assert np.ptp(expected) > 1.0
    found = exported(tmp_path, LEARNED[name], record)
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()
    assert passes_its_check(tmp_path / "one")


def test_every_learned_model_has_an_example() -> None:
    assert {one.model for one in LEARNED.values()} | {"anfis"} == set(TITLES)


@pytest.mark.parametrize("name", ["rd8040_anfis27", "rd8040_anfis9_1.0A"])
def test_published_anfis_as_c_gives_the_librarys_force(name: str, tmp_path: Path) -> None:
    file = ROOT / f"sim_hil/data/dampers/{name}.toml"
    record = two_tones(current_A=0.6)
    expected = simulator_of_file(file)[1](record)
    assert act(export, file, "--to", "c", "--out", tmp_path / "one") == 0
    found = forces(compiled(tmp_path / "one", "one"), "one", record)
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()
    assert passes_its_check(tmp_path / "one")


# MAT


def test_mat_file_holds_parameters_units_and_laws(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    assert act(export, file, "--to", "mat", "--out", tmp_path / "one.mat") == 0
    found = loadmat(tmp_path / "one.mat", simplify_cells=True)["damper"]
    assert found["model"] == "normalised_bouc_wen"
    assert found["parameters"]["kw_N"]["value"] == pytest.approx([60.0, 820.0, -180.0])
    assert found["parameters"]["kw_N"]["unit"] == "N"
    assert found["rig"]["fall_s"] == 0.02
    assert list(found["valid"]["current_A"]) == [0.0, 1.0]
    assert "c2 i^2" in found["law"]


def test_mat_file_of_a_learned_model_holds_its_tables(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", network([7, 4]))
    assert act(export, file, "--to", "mat", "--out", tmp_path / "one") == 0
    found = loadmat(tmp_path / "one.mat", simplify_cells=True)["damper"]["parameters"]
    assert [layer["units"] for layer in found["layer"]] == [7, 4, 1]
    assert found["velocity_m_s"]["range"] == pytest.approx([-0.12, 0.12])


# Refused


def bad(tmp_path: Path, text: str) -> Path:
    file = tmp_path / "bad.toml"
    file.write_text(text, encoding="utf-8")
    return file


def test_unknown_form_is_refused(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    assert "choose from" in refused(export, file, "--to", "fortran", "--out", tmp_path / "x")


def test_file_that_is_no_damper_is_refused(tmp_path: Path) -> None:
    for text in ("", "not toml", 'schema = "quiesce-plant"\n', EXAMPLE.to_toml() + "oops = 1\n"):
        message = refused(export, bad(tmp_path, text), "--to", "c", "--out", tmp_path / "x")
        assert "bad.toml" in message
    assert not (tmp_path / "x").exists()


def test_missing_file_is_refused(tmp_path: Path) -> None:
    assert "no such file" in refused(
        export, tmp_path / "no.toml", "--to", "c", "--out", tmp_path / "x"
    )


def test_wrong_ending_is_refused(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    assert ".mat" in refused(export, file, "--to", "mat", "--out", tmp_path / "x.c")
    assert "writes a folder" in refused(export, file, "--to", "c", "--out", tmp_path / "x.c")
    (tmp_path / "taken").write_text("mine")
    assert "a file of this name" in refused(export, file, "--to", "c", "--out", tmp_path / "taken")
    assert (tmp_path / "taken").read_text() == "mine"


def test_lookup_has_the_models_forces(tmp_path: Path) -> None:
    """Bingham's are functions of velocity and current alone: the table is the equation."""
    parameters = {"fc_N": [50.0, 400.0], "c_N_s_m": 800.0, "f0_N": 0.0, "eps_m_s": 0.005}
    damper = DamperModel("b", "bingham", 0.05, 0.2, parameters)
    file = write(tmp_path / "b.toml", damper)
    options = ("--to", "lookup", "--out", tmp_path / "table.mat", "--max-current-A", 2)
    assert act(export, file, *options) == 0
    data = {key: np.squeeze(value) for key, value in loadmat(tmp_path / "table.mat").items()}
    velocity, current = data["velocity_m_s"][:, None], data["current_A"][None, :]
    assert velocity.min() == -0.2 and velocity.max() == 0.2 and current.max() == 2.0
    assert (np.diff(data["velocity_m_s"]) > 0.0).all() and (np.diff(data["current_A"]) > 0.0).all()
    wanted_N = (50.0 + 400.0 * current) * np.tanh(velocity / 0.005) + 800.0 * velocity
    assert np.allclose(data["force_N"], wanted_N, rtol=1e-6, atol=1e-6 * np.abs(wanted_N).max())
    assert "load('table.mat')" in (tmp_path / "table.m").read_text()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--to", "lookup", "--out", "t"), "--max-current-A A does"),
        (("--to", "lookup", "--out", "2t.mat", "--max-current-A", 1), "name of a MATLAB script"),
        (("--to", "lookup", "--out", "t.c", "--max-current-A", 1), ".mat or .m"),
        (("--to", "mat", "--out", "t", "--max-current-A", 1), "--max-current-A is of --to lookup"),
    ],
)
def test_lookup_that_cannot_be_made_is_refused(tmp_path: Path, options, words: str) -> None:
    damper = DamperModel("m", kwok_rd1005().model, 0.02, 0.2, kwok_rd1005().parameters)
    file = write(tmp_path / "damper.toml", damper)
    assert words in refused(export, file, *options)
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize("form", sorted(export.ENDINGS))
def test_model_marked_unusable_is_refused(tmp_path: Path, form: str) -> None:
    valid = {"usable": False, "reason": "peaks are 5 times those measured"}
    damper = kwok_rd1005()
    marked = DamperModel("m", damper.model, 0.02, 0.2, damper.parameters, valid=valid)
    file = write(tmp_path / "damper.toml", marked)
    assert "5 times" in refused(export, file, "--to", form, "--out", tmp_path / "x")
    assert list(tmp_path.iterdir()) == [file]


def test_model_without_c_form_is_refused_with_a_way_out(tmp_path: Path) -> None:
    keys = {**LIMITS, "temperature_C": {"range": [0.0, 80.0]}, "force_scale_N": 400.0}
    keys["layer"] = layers([5], 4)
    file = write(tmp_path / "v.toml", learned("feed_forward_network", keys))
    assert "--to mat" in refused(export, file, "--to", "c", "--out", tmp_path / "x")
    assert not (tmp_path / "x").exists()


@pytest.mark.parametrize(
    "stem", ["main", "Main", "test", "all", "help", "clean", "install", "math"]
)
def test_name_with_a_meaning_of_its_own_is_refused(stem: str, tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    assert "name it otherwise" in refused(export, file, "--to", "c", "--out", tmp_path / stem)
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize("stem", ["9b", "", "double", "a__b", "ü"])
def test_name_that_c_does_not_allow_is_refused(stem: str) -> None:
    with pytest.raises(UsageError, match="begin it with a letter"):
        c_name(stem)
