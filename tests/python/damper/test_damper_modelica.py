"""Exported Modelica in a Modelica compiler (rumoca), which parses, flattens and integrates it."""

from pathlib import Path

import numpy as np
import pytest
import rumoca
from conftest import ROOT
from damper_actions import act, dissipative_tanh, kwok_rd1005, middle_of, refused, write
from learned_examples import network
from quiesce.base.errors import UsageError
from quiesce.cli.identify import export
from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.example import EXAMPLE
from quiesce.damper.export.modelica import modelica_name
from quiesce.damper.model_file import DamperModel
from quiesce.damper.simulate import simulator_of_file

pytestmark = pytest.mark.usefixtures("build")
DURATION_s = 0.3
STEP_s = 1e-3
FIELD = {"field_exponent": 1.6, "field_saturation": 0.8, "field_ref_A": 1.0}


def model_in(file: Path, name: str) -> rumoca.Model:
    return rumoca.Session().load(file, model=f"{file.stem}.{name}")


def example_force_N(file: Path) -> tuple[np.ndarray, Record]:
    """The example's force at even times, and its motion as a record, ten times as fine."""
    example = model_in(file, "Example")
    values = {one.name: one.value for one in example.parameters}
    config = rumoca.SimConfig(rtol=1e-10, atol=1e-11)
    force_N = np.array(example.simulate(t=DURATION_s, dt=STEP_s, config=config)["force"])
    time_s = np.arange(10 * (len(force_N) - 1) + 1) * STEP_s / 10
    size_m, w = values["amplitude"], values["w"]
    command = values["level"] * (1.0 + np.sin(0.5 * w * time_s))
    sine, cosine = np.sin(w * time_s), np.cos(w * time_s)
    motion = (size_m * sine, size_m * w * cosine, -size_m * w**2 * sine)
    record = Record("sine", 10 / STEP_s, time_s, *motion, np.zeros(len(time_s)), command, "A")
    return force_N, record


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "kernel" in metafunc.fixturenames:
        try:
            names = sorted(library.models())
        except UsageError:
            names = []
        metafunc.parametrize("kernel", names)


def holds(tmp_path: Path, damper: DamperModel, part: float = 1e-6) -> None:
    """The compiler's force is the bench's, within this part of the largest."""
    file = write(tmp_path / "damper.toml", damper)
    assert act(export, file, "--to", "modelica", "--out", tmp_path / "Own.mo") == 0
    found, record = example_force_N(tmp_path / "Own.mo")
    expected = simulator_of_file(file)[1](record)[::10]
    assert np.ptp(expected) > 1.0
    assert np.abs(found - expected).max() <= part * np.abs(expected).max()
    assert model_in(tmp_path / "Own.mo", "Damper").structure().is_balanced


def test_every_kernel_has_the_bench_force_in_a_modelica_compiler(
    kernel: str, tmp_path: Path
) -> None:
    holds(tmp_path, middle_of(library.model(kernel)))


def test_current_laws_coil_and_field_are_part_of_it(tmp_path: Path) -> None:
    laws = DamperModel("laws", EXAMPLE.model, 0.02, 0.3, EXAMPLE.parameters, EXAMPLE.rig | FIELD)
    holds(tmp_path, laws)
    holds(tmp_path, DamperModel("t", "kwok_tanh", 0.025, 0.3, dissipative_tanh().parameters, FIELD))


@pytest.mark.parametrize("name", ["spencer_prototype", "seat_damper"])
def test_damper_in_volts_is_in_volts_everywhere(name: str, tmp_path: Path) -> None:
    file = ROOT / f"sim_hil/data/dampers/{name}.toml"
    assert act(export, file, "--to", "modelica", "--out", tmp_path / "Own.mo") == 0
    text = (tmp_path / "Own.mo").read_text()
    assert text.count("voltage that the driver is asked for, V") == 2
    assert "parameter Real level = 1.125" in text and "starts there, without a lag" in text
    assert "current" not in text and ', A"' not in text and " a A" not in text
    found, record = example_force_N(tmp_path / "Own.mo")
    expected = simulator_of_file(file)[1](record)[::10]
    assert np.abs(found - expected).max() <= 1e-5 * np.abs(expected).max()


def test_springs_are_part_of_it(tmp_path: Path) -> None:
    keys = {"base_N_s_m": 20.0, "per_A_N_s_m": 5.0, "base_N_m": 900.0, "per_A_N_m": 70.0}
    holds(tmp_path, DamperModel("s", "switched_stiffness", 0.02, 0.2, keys | {"stroke_m": 0.02}))


def test_between_flanges_the_force_resists(tmp_path: Path) -> None:
    """A mass of 2 kg on a viscous damper of 8 N s/m slows down as exp(-4 t)."""
    keys = {"base_N_s_m": 8.0, "per_A_N_s_m": 0.0, "stroke_m": 0.5}
    file = write(tmp_path / "v.toml", DamperModel("v", "viscous", 0.5, 0.2, keys))
    assert act(export, file, "--to", "modelica", "--out", tmp_path / "Own.mo") == 0
    slide = """model Wall
  Own.Flange flange;
equation
  flange.s = 0.0;
end Wall;
model Mass
  Own.Flange flange;
  Real v(start = 1.0, fixed = true);
equation
  v = der(flange.s);
  2.0 * der(v) = flange.f;
end Mass;
model Slide
  Own.Damper damper(command = 0.0);
  Wall wall;
  Mass mass(flange(s(start = 0.0, fixed = true)));
  Real v;
equation
  connect(wall.flange, damper.flange_a);
  connect(damper.flange_b, mass.flange);
  v = mass.v;
end Slide;
"""
    source = (tmp_path / "Own.mo").read_text() + slide
    model = rumoca.Session().loads(source, model="Slide", filename="Slide.mo")
    result = model.simulate(t=0.5, dt=0.01, config=rumoca.SimConfig(rtol=1e-9, atol=1e-10))
    assert np.array(result["v"]) == pytest.approx(np.exp(-4.0 * np.array(result.time)), abs=1e-6)


def test_text_of_a_file_does_not_end_a_string(tmp_path: Path) -> None:
    keys = kwok_rd1005().parameters
    damper = DamperModel('5" \\ damper', "kwok_tanh", 0.025, 0.3, keys, source={"text": '"*/ \n;'})
    file = write(tmp_path / "damper.toml", damper)
    assert act(export, file, "--to", "modelica", "--out", tmp_path / "Own") == 0
    assert model_in(tmp_path / "Own.mo", "Example").structure().is_balanced


def test_learned_model_is_refused_with_a_way_out(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", network([5]))
    assert "--to c" in refused(export, file, "--to", "modelica", "--out", tmp_path / "Own.mo")
    assert list(tmp_path.iterdir()) == [file]


def test_rig_is_not_part_of_it(tmp_path: Path) -> None:
    file = write(tmp_path / "damper.toml", EXAMPLE)
    options = ("--to", "modelica", "--out", tmp_path / "Own.mo", "--with-rig")
    assert "--with-rig is of --to c" in refused(export, file, *options)


@pytest.mark.parametrize("stem", ["9b", "", "model", "a-b", "ü"])
def test_name_that_modelica_does_not_allow_is_refused(stem: str) -> None:
    with pytest.raises(UsageError, match="begin it with a letter"):
        modelica_name(stem)
