"""Plants with damper files, from the command line: checked, simulated, tuned."""

from pathlib import Path

import pytest
import tomli_w
from conftest import ROOT, run_quiesce
from quiesce.base.errors import UsageError
from quiesce.engine.bench import Bench
from quiesce.optimum.periodic import drive, solve
from quiesce.plant.library import Plant
from quiesce.plant.variant import Variant, read_plant_data, write_variant

PUBLISHED = ROOT / "sim_hil/data/plants/squeeze_2012.toml"
SUSPENDED = ROOT / "sim_hil/data/plants/suspended_mass.toml"
TWO_STOREYS = ROOT / "sim_hil/data/plants/two_storeys.toml"
SCENARIO = ROOT / "sim_hil/data/scenarios/suspended_mass_step.toml"
# A damper with memory, as strong as the published plant's own.
BOUC_WEN = """schema = "quiesce-damper"
version = 1
name = "small"
model = "normalised_bouc_wen"
stroke_m = 0.002
speed_m_s = 0.02
[parameters]
c_N_s_m = 0.02
k_N_m = 0.0
kw_N = [0.0, 0.0008]
rho_1_m = 1e5
sigma = 0.5
n = 1.5
f0_N = 0.0
[coil]
rise_s = 0.005
"""


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """The published plant's first mode with that damper, from a file beside it, and its coil."""
    (tmp_path / "small.toml").write_text(BOUC_WEN, encoding="utf-8")
    data = read_plant_data(PUBLISHED)
    data["structure"]["mode"] = data["structure"]["mode"][:1]
    data["damper"] = {"file": "small.toml"}
    del data["coil"]
    file = tmp_path / "plant.toml"
    file.write_text(tomli_w.dumps(data), encoding="utf-8")
    return file


def run_constant(current_mA: int) -> dict:
    return Bench().json(
        "run", "--scenario", str(SCENARIO), "--law", "constant",
        "--set", f"constant_current_mA={current_mA}",
    )  # fmt: skip


def test_check_describes_the_suspended_mass(quiesce) -> None:
    result = quiesce("plant", "check", SUSPENDED)
    assert result.returncode == 0, result.stderr
    assert "mode 1: 1.5 Hz, damping 2 %" in result.stdout


def test_constant_current_reduces_the_motion(build) -> None:
    off, some, much = (run_constant(current_mA) for current_mA in (0, 200, 1000))
    for window in ("amp_um", "amp2_um"):
        assert off[window] > 1.5 * some[window] > 3.0 * much[window] > 0.0
    for figures in (off, some, much):
        assert figures["faults"] == 0
        # Negative: the damper takes energy from the structure.
        assert all(window["damper_work_J"] < 0.0 for window in figures["windows"])


@pytest.mark.slow
def test_damper_file_that_is_missing_or_wrong_is_named(refused, small: Path) -> None:
    damper = small.parent / "small.toml"
    damper.write_text(BOUC_WEN.replace("sigma = 0.5", "sigma = 0.1"), encoding="utf-8")
    message = refused("plant", "check", small)
    assert "small.toml" in message and "parameters.sigma: expected a number in 0.5" in message
    damper.unlink()
    for command in (("plant", "check", small), ("tune", small)):
        assert "small.toml" in refused(*command)


def test_variants_of_a_plant_hold_their_damper(build, small: Path, tmp_path: Path) -> None:
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    for variant in (Variant(), Variant(rise_s=0.02), Variant(force=2.0)):
        write_variant(small, variant, folder / "variant.toml")
        amp_m = solve(drive(Plant(folder / "variant.toml"), 10.0), 5.0).amp_m
        nominal_m = solve(drive(Plant(small), 10.0), 5.0).amp_m
        assert (amp_m == nominal_m) == (variant.force == 1.0), variant.name
    assert read_plant_data(folder / "variant.toml")["damper"]["parameters"]["kw_N"] == [0.0, 0.0016]


def test_a_faster_variant_goes_with_shorter_steps(build, tmp_path: Path) -> None:
    """At the longest step that its own plant takes."""
    data = read_plant_data(PUBLISHED)
    data["integration"] = {"max_step_us": 1e6 * Plant(PUBLISHED).safe_step_s * 0.999}
    file, variant = tmp_path / "plant.toml", tmp_path / "variant.toml"
    file.write_text(tomli_w.dumps(data), encoding="utf-8")
    write_variant(file, Variant(force=1.5), variant)
    assert Plant(variant).max_step_s < Plant(variant).safe_step_s < Plant(file).max_step_s
    write_variant(file, Variant(force=0.7), variant)
    assert Plant(variant).max_step_s == Plant(file).max_step_s


def test_check_describes_places_and_dampers(quiesce) -> None:
    result = quiesce("plant", "check", TWO_STOREYS)
    assert result.returncode == 0, result.stderr
    for words in ("place floor", "place roof", "damper lower: at most", "damper upper: at most"):
        assert words in result.stdout


def test_several_dampers_are_refused_where_one_is_expected(build, refused) -> None:
    with pytest.raises(UsageError, match="plant two_storeys has 2 dampers"):
        Plant(TWO_STOREYS)
    expected = r"two_storeys.toml: its dampers have names and ends \(\[\[damper\]\]\); this works"
    with pytest.raises(UsageError, match=expected):
        read_plant_data(TWO_STOREYS)
    assert "has 2 dampers" in refused("tune", TWO_STOREYS, "--quick", "--out", "out")


def test_learned_model_on_a_base_has_no_factor(build) -> None:
    data = read_plant_data(PUBLISHED)
    data["damper"] = {
        "model": "hysteresis_network",
        "parameters": {"force_scale_N": 1.0, "base": {"model": "bingham"}},
    }
    from quiesce.plant.damper import scale_force

    with pytest.raises(UsageError, match="hysteresis_network cannot be varied"):
        scale_force(data["damper"], 2.0)


@pytest.mark.slow
def test_tune_works_with_a_damper_that_remembers(build, small: Path, tmp_path: Path) -> None:
    result = run_quiesce(
        tmp_path, "tune", small, "--quick", "--from-Hz", "14", "--to-Hz", "16", "--step-Hz", "2",
        "--robustness", "none", "--no-closed-loop", "--out", "out", "--jobs", "1",
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "out/report.html").stat().st_size > 0
