"""The building of 1996 beside what was published, and laws of recipes in closed loop on it."""

import json
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT
from quiesce.base.paths import measurements

DATA = ROOT / "sim_hil/data"
BOARD = DATA / "boards/three_storeys_1996.toml"
PLANT = DATA / "plants/three_storeys_1996.toml"
RECORD = measurements("earthquake") / "el_centro_1940_ns.csv"
FLOORS = ("first", "second", "third")
# Dyke, Spencer, Sain and Carlson 1996: peaks of displacement in cm, of the damper's force in N.
PUBLISHED = {
    "off": ([0.211, 0.357, 0.455], 258.0),
    "constant": ([0.076, 0.196, 0.306], 979.0),
}


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """El Centro, its north-south part, at five times its rate and unscaled."""
    if not RECORD.exists():
        pytest.skip("the recorded earthquakes are not beside the project")
    file = tmp_path_factory.mktemp("building") / "el_centro.toml"
    file.write_text(
        'schema = "quiesce-scenario"\nversion = 1\nname = "el_centro"\n'
        f'plant = "{PLANT}"\nboard = "{BOARD}"\nduration_s = 8.0\n'
        f'[[segment]]\nkind = "record"\nfile = "{RECORD}"\n'
        'time_column = "t_s"\naccel_column = "acc_m_s2"\ntime_scale = 5\n'
        "[[window]]\nstart_s = 0.0\nend_s = 8.0\n"
    )
    return file


def run(build: Path, scenario: Path, *options: str | Path) -> dict:
    bench = build / "host/sim_hil/quiesce_bench"
    words = [bench, "run", "--scenario", scenario, *options]
    result = subprocess.run(list(map(str, words)), capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def peaks(result: dict) -> tuple[list[float], float]:
    """Of the floors' displacements in cm, of the force in N."""
    window = result["rig"][0]
    moved = [window["bodies"][name]["peak_disp_um"] / 1e4 for name in FLOORS]
    return moved, window["dampers"]["brace"]["peak_force_N"]


@pytest.mark.parametrize("law", PUBLISHED)
def test_passive_peaks_are_the_published_ones(build: Path, scenario: Path, law: str) -> None:
    moved, force = peaks(run(build, scenario, "--law", law))
    assert moved == pytest.approx(PUBLISHED[law][0], rel=0.05)
    assert force == pytest.approx(PUBLISHED[law][1], rel=0.05)


def made(quiesce, folder: Path, recipe: str, *settings: str) -> Path:
    file = folder / f"{recipe}.table"
    options = [word for one in settings for word in ("--set", one)]
    result = quiesce(
        "law", "make", recipe, "--board", BOARD, "--plant", PLANT, "-o", file, *options
    )
    assert result.returncode == 0, result.stderr
    return file


def test_clipped_optimal_is_better_than_both_currents(
    build: Path, scenario: Path, quiesce, tmp_path: Path
) -> None:
    table = made(quiesce, tmp_path, "clipped_optimal", "force_1_N2=1e-10")
    result = run(
        build, scenario, "--law", "linear", "--law-table", table, "--set", "tracker=compare"
    )
    third, force = peaks(result)[0][2], peaks(result)[1]
    assert third < 0.8 * min(x[2] for x, _ in PUBLISHED.values())
    assert 500 < force < 1000
    assert result["faults"] == 0


def test_a_table_is_refused_at_another_rate(
    build: Path, scenario: Path, quiesce, tmp_path: Path
) -> None:
    file = tmp_path / "half.table"
    words = ["--board", BOARD, "--plant", PLANT, "--rate", "500", "-o", file]
    assert quiesce("law", "make", "clipped_optimal", *words).returncode == 0
    assert "made for 500 ticks" in quiesce("table", "show", file).stdout
    bench = [build / "host/sim_hil/quiesce_bench", "run", "--scenario", scenario]
    bench += ["--law", "linear", "--law-table", file, "--set", "tracker=compare"]
    refused = subprocess.run(list(map(str, bench)), capture_output=True, text=True, check=False)
    assert refused.returncode == 2
    assert "made for another tick_rate_Hz" in refused.stderr
    options = bench[4:] + ["--set", "tick_rate_Hz=500"]
    assert run(build, scenario, *options)["faults"] == 0


@pytest.mark.parametrize(
    ("recipe", "options"),
    [
        ("skyhook_on_off", []),
        ("max_dissipation", []),
        ("modulated_friction", ["--set", "tracker=proportional"]),
        ("sliding_mode", ["--set", "tracker=compare"]),
        ("polynomial", []),
    ],
)
def test_a_recipe_runs_without_a_fault_and_does_something(
    build: Path, scenario: Path, quiesce, tmp_path: Path, recipe: str, options: list[str]
) -> None:
    table = made(quiesce, tmp_path, recipe)
    law = {"modulated_friction": "friction", "sliding_mode": "linear", "polynomial": "polynomial"}
    words = ["--law", law.get(recipe, "signs"), "--law-table", table, *options]
    result = run(build, scenario, *words)
    assert result["faults"] == 0
    assert 0.01 < result["rig"][0]["dampers"]["brace"]["mean_current_A"] < 2.25
    assert peaks(result)[0][2] < PUBLISHED["off"][0][2]
