"""`quiesce fmu`: what it packs is what the standard asks for, and bad input packs nothing."""

import shutil
import zipfile

import fmpy
import fmu_files
import pytest
from conftest import ROOT, run_quiesce
from fmpy.validation import validate_fmu
from fmu_files import DAMPER, KINDS, PLANT
from quiesce.fmu.slave import Slave

fmu = fmu_files.fmu  # the fixture


@pytest.mark.parametrize("version", ["2", "3"])
@pytest.mark.parametrize("kind", KINDS)
def test_fmpy_finds_nothing_wrong(fmu, kind, version):
    file = fmu(kind, version)
    assert validate_fmu(str(file)) == []
    description = fmpy.read_model_description(str(file))
    assert description.fmiVersion == f"{version}.0"
    assert description.coSimulation.canSerializeFMUstate
    assert {one.causality for one in description.modelVariables} >= {"input", "output"}


def test_same_input_makes_the_same_file(fmu, tmp_path):
    first = fmu("controller", "2")
    result = run_quiesce(tmp_path, "fmu", *KINDS["controller"], "-o", first.name)
    assert result.returncode == 0
    assert (tmp_path / first.name).read_bytes() == first.read_bytes()


def test_files_that_a_plant_names_are_inside(tmp_path):
    """A damper in a file of its own, in another folder: found again where there is nothing else."""
    data, mine = ROOT / "sim_hil/data", tmp_path / "mine"
    for file in ("plants/suspended_mass.toml", "dampers/rd1005_kwok_tanh_smooth.toml"):
        (mine / file).parent.mkdir(parents=True)
        shutil.copyfile(data / file, mine / file)
    plant = mine / "plants/suspended_mass.toml"
    result = run_quiesce(tmp_path, "fmu", "plant", plant, "-o", "mass.fmu")
    assert result.returncode == 0, result.stderr
    shutil.rmtree(mine)
    with zipfile.ZipFile(tmp_path / "mass.fmu") as packed:
        inside = packed.namelist()
        text = packed.read("resources/fmu.toml").decode()
    for file in ("plants/suspended_mass.toml", "dampers/rd1005_kwok_tanh_smooth.toml"):
        assert f"resources/files/{file}" in inside
    assert str(tmp_path) not in text
    with Slave(tmp_path / "mass.fmu", {"damper.current_cmd_A": 1.0}, 1.0) as slave:
        slave.step(0.0, 0.5)
        assert slave.reader(["damper.current_A"])()[0] > 0.5


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["controller", "-o", "x.zip"], "ends with .fmu"),
        (["controller", "--law", "nonsense", "-o", "x.fmu"], "nonsense"),
        (["controller", "--set", "nonsense=1", "-o", "x.fmu"], "nonsense"),
        (["controller", "--law", "phase", "--pulses", "none.table", "-o", "x.fmu"], "none.table"),
        (["controller", "--board", "none.toml", "-o", "x.fmu"], "none.toml: No such file"),
        (["controller", "--rules", "bad.fis", "-o", "x.fmu"], "bad.fis"),
        (["plant", "-o", "x.fmu"], "name a plant"),
        (["plant", "bad.toml", "-o", "x.fmu"], "bad.toml"),
        (["plant", "none.toml", "-o", "x.fmu"], "none.toml: No such file"),
        (["plant", str(PLANT), "--seed", "-1", "-o", "x.fmu"], "--seed"),
        (["plant", str(PLANT), "--set", "tick_rate_Hz=999", "-o", "x.fmu"], "tick_rate_Hz"),
        (["damper", str(PLANT), "-o", "x.fmu"], "squeeze_2012.toml"),
        (["damper", "bad.toml", "-o", "x.fmu"], "bad.toml"),
        (["damper", str(DAMPER), "-o", "none/there/x.fmu"], ""),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(tmp_path, words, said):
    (tmp_path / "bad.toml").write_text('schema = "nonsense"\n[')
    (tmp_path / "bad.fis").write_text("[System]\nName='x'\n")
    result = run_quiesce(tmp_path, "fmu", *words)
    if said:
        assert result.returncode == 2, result.stdout
        lines = result.stderr.strip().splitlines()
        assert said in lines[-1]
        assert "Traceback" not in result.stderr
        assert not (tmp_path / "x.fmu").exists()
    else:
        assert result.returncode == 0  # folders of an output are made


SCENARIO = f'''schema = "quiesce-scenario"
version = 1
name = "mine"
plant = "{PLANT}"
duration_s = 2.0
'''
SINE = '[[segment]]\nkind = "sine"\nfreq_Hz = 10.0\n'
DROPOUT = '[[fault]]\nkind = "dropout"\nt_s = 1.0\nduration_s = 0.1\n'


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (SINE + DROPOUT, "the importer of a plant is to inject"),
        (f"seed = {2**31}\n" + SINE, "seed 2147483648: an FMU takes 0 .. 2147483647"),
    ],
)
def test_scenario_that_no_fmu_can_have_is_refused(tmp_path, lines, said):
    scenario = tmp_path / "mine.toml"
    scenario.write_text(SCENARIO + lines)
    result = run_quiesce(tmp_path, "fmu", "plant", "--scenario", scenario, "-o", "x.fmu")
    assert result.returncode == 2
    assert said in result.stderr
    assert not (tmp_path / "x.fmu").exists()
