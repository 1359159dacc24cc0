"""`quiesce new plant`: five unlike structures run; what contradicts itself is refused."""

import json
import math
import re
import shlex
import tomllib
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, run_quiesce
from quiesce.plant.new.cantilever import Cantilever, frequencies_Hz, norm_and_participation, roots
from quiesce.plant.new.chain import Chain, matrices
from quiesce.plant.new.drive import read_drive, steps_Hz

PAGE = (ROOT / "docs/howto/own-plant.md").read_text()
BLOCK = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)
DAMPER = next(text for _, text in BLOCK.findall(PAGE) if text.startswith("# small.toml"))
OWN_Hz = {
    "press": [2.9],
    "boom": [11.5, 72.07],
    "mount": [25.0],
    "tower": [3.0, 7.85],
    "corner": [1.44, 12.73],
}


def page_lines() -> dict[str, list[str]]:
    """The page's commands for its five structures, as words behind `new plant`, by name."""
    text = next(text for _, text in BLOCK.findall(PAGE) if text.startswith("# a machine of"))
    lines = text.replace("\\\n", " ").splitlines()
    words = [shlex.split(line, comments=True)[3:] for line in lines if line.startswith("../")]
    return {one[0]: one[1:] for one in words}


FIVE = page_lines()
SOME = [name if name == "tower" else pytest.param(name, marks=pytest.mark.slow) for name in OWN_Hz]


@pytest.fixture
def quiesce_here(quiesce, tmp_path: Path):
    """With the damper's file in the folder that commands run in."""
    (tmp_path / "small.toml").write_text(DAMPER)
    return quiesce


# What comes out


def test_the_page_has_five_structures() -> None:
    assert list(FIVE) == list(OWN_Hz)


@pytest.mark.parametrize("name", SOME)
def test_files_are_accepted_and_run(quiesce_here, tmp_path: Path, name) -> None:
    made = quiesce_here("new", "plant", name, *FIVE[name], "--json")
    assert made.returncode == 0, made.stderr
    told = json.loads(made.stdout)
    assert told["natural_frequencies_Hz"] == pytest.approx(OWN_Hz[name], rel=0.01)
    assert sorted(told["files"]) == sorted(one.name for one in (tmp_path / name).iterdir())
    assert quiesce_here("plant", "check", f"{name}/plant.toml").returncode == 0
    assert quiesce_here("board", "check", f"{name}/board.toml").returncode == 0
    run = quiesce_here(
        "hil", "--scenario", f"{name}/random.toml", "--law", "fuzzy", "--target", "host", "--quick",
        "--out", "report", "--json",
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    off, ours = json.loads(run.stdout)["rigs"]
    assert (off["law"], ours["law"]) == ("open_loop", "fuzzy")


@pytest.mark.parametrize("name", SOME)
def test_modes_are_those_of_the_bench(quiesce_here, name) -> None:
    """What the writer computes for people is what the simulation has."""
    assert quiesce_here("new", "plant", name, *FIVE[name]).returncode == 0
    said = quiesce_here("plant", "check", f"{name}/plant.toml").stdout
    found = [float(line.split()[2]) for line in said.splitlines() if line.startswith("  mode")]
    assert found == pytest.approx(OWN_Hz[name], rel=0.01)


@pytest.mark.slow
def test_what_it_says_stands_on_the_page(quiesce_here) -> None:
    made = quiesce_here("new", "plant", "press", *FIVE["press"])
    assert f"```text\n{made.stdout}```" in PAGE


def test_files_say_where_their_numbers_are_from(quiesce_here, tmp_path: Path) -> None:
    words = FIVE["press"]
    assert quiesce_here("new", "plant", "press", *words, "-o", "mine").returncode == 0
    plant = (tmp_path / "mine/plant.toml").read_text()
    assert "# Made by: quiesce new plant press --mass 120 --freq 2.9" in plant
    assert tomllib.loads(plant)["driver"]["max_current_A"] == 1.88
    assert "the largest at which it was identified" in plant
    board = tomllib.loads((tmp_path / "mine/board.toml").read_text())
    assert board["damper"][0]["ceiling_mA"] == 1880
    assert board["sensor"][0]["corner_mHz"] == 500
    shipped = ROOT / "sim_hil/data/dampers/rd1005_kwok_tanh_smooth.toml"
    assert (tmp_path / "mine/damper.toml").read_text() == shipped.read_text()
    steps = tomllib.loads((tmp_path / "mine/steps.toml").read_text())
    assert 2.9 in [segment["freq_Hz"] for segment in steps["segment"]]


def test_range_is_at_least_twice_the_peak(quiesce_here) -> None:
    words = FIVE["mount"]
    told = json.loads(quiesce_here("new", "plant", "mount", *words, "--json").stdout)
    rms_g = max(step["accel_mm_s2_at_0_A"] for step in told["steps"]) / 9806.65
    assert told["range_g"] >= 2.0 * math.sqrt(2.0) * rms_g


def test_one_frequency_has_one_step_and_no_band(quiesce_here) -> None:
    words = "--mass 8 --freq 25 --damper small.toml --drive force:25Hz,1N --json"
    told = json.loads(quiesce_here("new", "plant", "one", *shlex.split(words)).stdout)
    assert [step["freq_Hz"] for step in told["steps"]] == [25.0]
    assert "random.toml" not in told["files"]


def test_what_nobody_tested_is_noted(quiesce_here) -> None:
    made = quiesce_here("new", "plant", "corner", *FIVE["corner"])
    assert "note: the damper was identified at 1 to 2.5 Hz only" in made.stderr


@pytest.mark.slow
def test_files_are_overwritten_on_request_only(quiesce_here, tmp_path: Path) -> None:
    words = ["new", "plant", "mount", *FIVE["mount"]]
    assert quiesce_here(*words).returncode == 0
    (tmp_path / "mount/board.toml").write_text("mine")
    again = quiesce_here(*words)
    assert again.returncode == 2
    assert "has plant.toml, board.toml" in again.stderr and "--force" in again.stderr
    assert (tmp_path / "mount/board.toml").read_text() == "mine"
    assert quiesce_here(*words, "--force").returncode == 0
    assert (tmp_path / "mount/board.toml").read_text() != "mine"


@pytest.mark.slow
def test_tools_start_from_the_files(quiesce_here, tmp_path: Path) -> None:
    """Pulses and rules, tuned and searched at frequencies of the structure's own, on its base."""
    words = [*FIVE["mount"], "-o", "mine"]
    assert quiesce_here("new", "plant", "mount", *words).returncode == 0
    tuned = quiesce_here(
        "tune", "mine/plant.toml", "--quick", "--from-Hz", "20", "--to-Hz", "30", "--step-Hz", "5",
        "--robustness", "none", "--no-closed-loop", "--out", "pulses",
    )  # fmt: skip
    assert tuned.returncode == 0, tuned.stderr
    found = quiesce_here(
        "rules", "optimize", "--scenario", "mine/steps.toml", "--population", "4",
        "--generations", "1", "--out", "rules",
    )  # fmt: skip
    assert found.returncode == 0, found.stderr
    steps = tomllib.loads((tmp_path / "mine/steps.toml").read_text())["segment"]
    freqs = ", ".join(f"{step['freq_Hz']:g}" for step in steps)
    assert f"constant currents swept at {freqs} Hz" in found.stderr


# What is refused

GOOD = {"--mass": "8", "--freq": "25", "--damper": "small.toml", "--drive": "force:10..40Hz,1N"}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"--mass": "0"}, "--mass: expected a number in 1e-06"),
        ({"--mass": "nan"}, "--mass: expected a number"),
        ({"--mass": "8,"}, "--mass: expected a number"),
        ({"--mass": "8,8"}, "--freq: of one body"),
        ({"--mass": "1,1,1,1,1", "--freq": None, "--stiffness": "1,1,1,1,1"}, "at most 4"),
        ({"--stiffness": "100"}, "give --stiffness or --freq, one of them"),
        ({"--freq": None}, "give --stiffness or --freq, one of them"),
        ({"--freq": None, "--stiffness": "1,2"}, "--mass has 1 bodies, --stiffness 2 springs"),
        ({"--damping-ratio": "2"}, "--damping-ratio: expected a number in 0 .. 0.9"),
        ({"--bodies": "a,b"}, "2 names for 1 bodies"),
        ({"--bodies": "ground"}, "--bodies ground: expected names that differ"),
        ({"--bodies": "9"}, "--bodies 9: expected a letter"),
        ({"--end-mass": "1"}, "--end-mass goes with --cantilever"),
        ({"--damper": "none"}, "--damper none: no such file, and none ships; there are: mre_2014"),
        ({"--damper": "broken.toml"}, "broken.toml: not a TOML file"),
        ({"--damper": "sensor.toml"}, "expected schema = 'quiesce-damper'"),
        ({"--damper": "squeeze_2012_bouc_wen_1A"}, "its file says that it is not usable"),
        ({"--damper": "rd8040_kwok_tanh_0.0A"}, "no current above 0"),
        ({"--damper": "wrong.toml"}, "damper.toml"),
        ({"--damper-at": "wheel"}, "--damper-at wheel: no such body; there are: mass"),
        ({"--damper-at": "mass:mass"}, "both ends are on mass"),
        ({"--max-current": "3"}, "--max-current 3: the damper was identified up to 2 A only"),
        ({"--lever": "0"}, "--lever: expected a number in 0.01"),
        ({"--drive": "10Hz"}, "--drive 10Hz: expected force:LOW..HIGHHz,LEVELN"),
        ({"--drive": "force:40..10Hz,1N"}, "expected frequencies that rise"),
        ({"--drive": "force:10..40Hz,0N"}, "expected a level above 0"),
        ({"--drive": "force:10..40Hz,1g"}, "a force's level is in N, not g"),
        ({"--drive": "base:10..40Hz,1N"}, "a base's level is in m/s2 or g, not N"),
        ({"--drive": "base:10..40Hz,1g", "--drive-at": "mass"}, "mass: the base has one place"),
        ({"--drive": "force:10..40Hz,5000N"}, "at 0 A the simulation stopped"),
        ({"--drive-at": "wheel"}, "--drive-at wheel: no such body"),
        ({"--accel": "keyence_AH416"}, "measures in nm; an accelerometer's unit is um/s2"),
        ({"--accel-at": "wheel"}, "--accel-at wheel: no such body"),
        ({"--range": "0.01"}, "--range 0.01: without current the accelerometer sees"),
        ({"--bits": "30"}, "--bits: expected an integer in 8 .. 24"),
        ({"--cantilever": "", "--mass": "8,8"}, "--mass is the beam's, one number"),
        ({"--cantilever": "", "--damper-at": "1.2"}, "--damper-at 1.2: on a cantilever expected"),
        ({"--cantilever": "", "--lever": "2"}, "--lever goes with bodies on springs"),
        ({"-o": "small.toml"}, "small.toml is a file; name a folder"),
    ],
)  # fmt: skip
def test_contradictions_are_refused(refused, tmp_path: Path, change, message) -> None:
    (tmp_path / "small.toml").write_text(DAMPER)
    (tmp_path / "wrong.toml").write_text(DAMPER.replace("fc_N", "fc"))
    (tmp_path / "broken.toml").write_text("schema = ")
    sensor = (ROOT / "sim_hil/data/sensors/pcb_333B32.toml").read_text()
    (tmp_path / "sensor.toml").write_text(sensor)
    options = {key: value for key, value in (GOOD | change).items() if value is not None}
    words = [word for option in options.items() for word in option if word]
    assert message in refused("new", "plant", "mine", *words)


def test_a_bad_name_is_refused(refused, tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(DAMPER)
    words = [word for option in GOOD.items() for word in option]
    assert "NAME ../up: expected a letter" in refused("new", "plant", "../up", *words)


@pytest.mark.slow
def test_too_high_a_level_is_refused_with_one_that_runs(refused, tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(DAMPER)
    words = [
        word for option in (GOOD | {"--drive": "force:10..40Hz,5000N"}).items() for word in option
    ]
    message = refused("new", "plant", "mine", *words)
    level = message.rpartition("; at ")[2].split()[0]
    words[-1] = f"force:10..40Hz,{level}N"
    assert run_quiesce(tmp_path, "new", "plant", "mine", *words).returncode == 0


# Its parts


def test_springs_from_the_top_down() -> None:
    _, damping, stiffness, freqs_Hz = matrices(Chain([2.0, 3.0], [100.0, 50.0], 0.05, ["a", "b"]))
    assert stiffness == pytest.approx(np.array([[100.0, -100.0], [-100.0, 150.0]]))
    assert np.all(np.diff(freqs_Hz) > 0.0)
    assert damping == pytest.approx(damping.T)


def test_every_mode_has_the_damping_ratio() -> None:
    mass, damping, stiffness, freqs_Hz = matrices(
        Chain([2.0, 3.0, 1.0], [100.0, 50.0, 80.0], 0.05, ["a", "b", "c"])
    )
    root = np.diag(1.0 / np.sqrt(np.diag(mass)))
    _, turns = np.linalg.eigh(root @ stiffness @ root)
    modal = turns.T @ root @ damping @ root @ turns
    assert np.diag(modal) == pytest.approx(2.0 * 0.05 * 2.0 * np.pi * freqs_Hz)
    assert modal - np.diag(np.diag(modal)) == pytest.approx(np.zeros((3, 3)), abs=1e-9)


def test_a_beam_has_the_frequencies_of_the_text_books() -> None:
    assert roots(0.0) == pytest.approx([1.87510407, 4.69409113], rel=1e-8)
    assert roots(1.0) == pytest.approx([1.24791741, 4.03113944], rel=1e-8)
    # With all the mass at its end it is a mass on a spring.
    heavy = frequencies_Hz(Cantilever(1e-4, 1.0, 100.0, 0.0))[0]
    assert heavy == pytest.approx(math.sqrt(100.0) / (2.0 * math.pi), rel=1e-4)
    _, participation = norm_and_participation(Cantilever(1.0, 0.0, 100.0, 0.0), roots(0.0)[0])
    assert participation**2 == pytest.approx(0.6131, abs=1e-4)  # modal mass of the first mode


def test_steps_include_natural_frequencies() -> None:
    drive = read_drive("force: 2..8Hz, 3N")
    assert steps_Hz(drive, [2.9, 30.0]) == [2.0, 2.9, 6.0, 8.0]
    assert steps_Hz(read_drive("base:7Hz,1g"), [2.9]) == [7.0]
