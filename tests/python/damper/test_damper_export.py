"""Exported damper models give the library's forces in other programs."""

import ctypes
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from damper_actions import act, dissipative_tanh, kwok_rd1005, refused, two_tones, write
from quiesce.base.errors import UsageError
from quiesce.cli.identify import export
from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.example import EXAMPLE
from quiesce.damper.export.c_names import c_name
from quiesce.damper.library import Scales
from quiesce.damper.model_file import DamperModel, read_model
from quiesce.damper.simulate import simulator_of_file
from scipy.io import loadmat

pytestmark = pytest.mark.usefixtures("build")
FLAGS = ("-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror")
SCALES = Scales(1000.0, 8e-3, 0.1)


def compiled(folder: Path, name: str, compiler: str = "") -> ctypes.CDLL:
    """The exported model as a shared library, built without a warning."""
    source = next(file for file in (folder / f"{name}.cpp", folder / f"{name}.c") if file.exists())
    is_cpp = source.suffix == ".cpp"
    compiler = compiler or ("g++" if is_cpp else "gcc")
    out = folder / f"lib{name}.so"
    standard = "-std=c++17" if is_cpp else "-std=c11"
    command = [compiler, standard, *FLAGS, "-shared", "-fPIC", "-o", str(out), str(source), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return ctypes.CDLL(str(out))


def forces(code: ctypes.CDLL, name: str, record: Record) -> np.ndarray:
    """The exported model along a record, one call a sample."""
    state = ctypes.create_string_buffer(4096)
    reset, step = getattr(code, f"{name}_reset"), getattr(code, f"{name}_step")
    step.restype = ctypes.c_double
    step.argtypes = [ctypes.c_void_p, *[ctypes.c_double] * 5]
    reset(state)
    rows = zip(record.disp_m, record.velocity_m_s, record.accel_m_s2, record.command, strict=True)
    return np.array([step(state, *row, 1.0 / record.rate_Hz) for row in rows])


def exported(folder: Path, damper: DamperModel, record: Record, *options: str) -> np.ndarray:
    file = write(folder / "damper.toml", damper)
    assert act(export, file, "--to", "c", "--out", folder / "one", *options) == 0
    return forces(compiled(folder, "one"), "one", record)


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


def middle_of(one: library.Model) -> DamperModel:
    """A model with every parameter in the middle of its search range."""
    values = {}
    for parameter in one.parameters:
        low, high = parameter.search_range(SCALES)
        is_wide = low > 0.0 and high / low > 8.0
        middle = float(np.sqrt(low * high) if is_wide else 0.5 * (low + high))
        values[parameter.name] = min(max(middle, parameter.min), parameter.max)
    return DamperModel(one.name, one.name, 0.05, 0.2, values)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "kernel" in metafunc.fixturenames:
        try:
            names = sorted(library.models())
        except UsageError:
            names = []
        metafunc.parametrize("kernel", names)


def test_every_kernel_as_c_gives_the_librarys_force(kernel: str, tmp_path: Path) -> None:
    record = two_tones(duration_s=1.0)
    damper = middle_of(library.model(kernel))
    expected = library_force(damper, record)
    found = exported(tmp_path, damper, record)
    assert np.abs(found - expected).max() <= 1e-9 * np.abs(expected).max()


def test_coil_lag_and_current_laws_are_those_of_the_library(tmp_path: Path) -> None:
    record = two_tones(current_A=np.where(np.arange(1000) // 130 % 2, 0.9, 0.1))
    expected = library_force(EXAMPLE, record)
    found = exported(tmp_path, EXAMPLE, record)
    assert np.abs(found - expected).max() <= 1e-9 * np.abs(expected).max()


def test_published_film_as_c_gives_the_librarys_force(tmp_path: Path) -> None:
    record = two_tones(current_A=np.linspace(0.0, 3.0, 1000))
    published = read_model(ROOT / "sim_hil/data/dampers/squeeze_2012_film.toml")
    film = DamperModel("film", published.model, 0.05, 0.2, published.parameters)
    expected = library_force(film, record)
    found = exported(tmp_path, film, record)
    assert np.abs(found - expected).max() <= 1e-9 * np.abs(expected).max()


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


@pytest.mark.skipif(not shutil.which("clang++-14"), reason="clang++-14 is not installed")
def test_second_compiler_has_no_complaint(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    assert act(export, file, "--to", "c", "--out", tmp_path / "one.cpp") == 0
    compiled(tmp_path, "one", "clang++-14")


def test_header_is_c(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    assert act(export, file, "--to", "c", "--out", tmp_path / "one") == 0
    program = '#include "one.h"\nint main(void) { one_state s; one_reset(&s); return 0; }\n'
    (tmp_path / "main.c").write_text(program)
    command = ["gcc", "-std=c11", "-pedantic", *FLAGS, "-c", "main.c"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


def test_two_models_live_in_one_program(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    for name in ("front", "rear"):
        assert act(export, file, "--to", "c", "--out", tmp_path / name) == 0
    sources = [str(tmp_path / f"{name}.cpp") for name in ("front", "rear")]
    command = ["g++", "-std=c++17", "-shared", "-fPIC", "-o", str(tmp_path / "both.so"), *sources]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


# Learned models

LIMITS = {
    "current_A": {"range": [0.0, 1.0]},
    "displacement_m": {"range": [-0.01, 0.01]},
    "velocity_m_s": {"range": [-0.12, 0.12]},
}


def learned(model: str, parameters: dict) -> DamperModel:
    return DamperModel(model, model, 0.02, 0.2, parameters)


def network(units: list[int]) -> DamperModel:
    rng = np.random.default_rng(3)
    layers, before = [], 3
    for count in [*units, 1]:
        layers.append(
            {
                "units": count,
                "weights": rng.normal(size=count * before).tolist(),
                "biases": rng.normal(size=count).tolist(),
            }
        )
        before = count
    return learned("feed_forward_network", {**LIMITS, "force_scale_N": 400.0, "layer": layers})


def support_vectors() -> DamperModel:
    rng = np.random.default_rng(4)
    keys = {"force_scale_N": 300.0, "gamma": 0.7, "intercept": 0.1}
    keys |= {"coefficients": rng.normal(size=20).tolist()}
    keys |= {"support_vectors": rng.uniform(-1, 1, 60).tolist()}
    return learned("support_vector", LIMITS | keys)


LEARNED = [network([]), network([5]), network([7, 4]), network([3, 4, 5]), support_vectors()]


@pytest.mark.parametrize("damper", LEARNED, ids=lambda one: one.model)
def test_learned_model_as_c_gives_the_librarys_force(damper: DamperModel, tmp_path: Path) -> None:
    record = two_tones(current_A=np.linspace(-0.1, 1.1, 1000))
    file = write(tmp_path / "damper.toml", damper)
    expected = simulator_of_file(file)[1](record)
    found = exported(tmp_path, damper, record)
    assert np.abs(found - expected).max() <= 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize("name", ["rd8040_anfis27", "rd8040_anfis9_1.0A"])
def test_published_anfis_as_c_gives_the_librarys_force(name: str, tmp_path: Path) -> None:
    file = ROOT / f"sim_hil/data/dampers/{name}.toml"
    record = two_tones(current_A=0.6)
    expected = simulator_of_file(file)[1](record)
    assert act(export, file, "--to", "c", "--out", tmp_path / "one") == 0
    found = forces(compiled(tmp_path, "one"), "one", record)
    assert np.abs(found - expected).max() <= 1e-9 * np.abs(expected).max()


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
    assert not (tmp_path / "x.h").exists()


def test_missing_file_is_refused(tmp_path: Path) -> None:
    assert "no such file" in refused(
        export, tmp_path / "no.toml", "--to", "c", "--out", tmp_path / "x"
    )


def test_wrong_ending_is_refused(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    assert ".mat" in refused(export, file, "--to", "mat", "--out", tmp_path / "x.c")


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
    parameters = {"base_N_s_m": 20.0, "per_A_N_s_m": 5.0, "stroke_m": 0.02}
    file = write(tmp_path / "v.toml", DamperModel("v", "viscous", 0.02, 0.2, parameters))
    assert "--to mat" in refused(export, file, "--to", "c", "--out", tmp_path / "x")
    assert read_model(file).model == "viscous"


@pytest.mark.parametrize("stem", ["9b", "", "double", "a__b", "ü"])
def test_name_that_c_does_not_allow_is_refused(stem: str) -> None:
    with pytest.raises(UsageError, match="begin it with a letter"):
        c_name(stem)
