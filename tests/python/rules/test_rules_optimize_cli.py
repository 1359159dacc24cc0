"""`quiesce rules optimize` and `lookup`: the published tables, real searches, bad input."""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, run_quiesce
from quiesce.engine.bench import Bench
from quiesce.hil.rule_surface import rule_surface
from quiesce.rules.formats.files import read_rules
from quiesce.rules.reference import evaluate

FILES = ["best.fcl", "report.html", "report.md", "result.json", "state.json"]
SHORT = ["--scenario", "sine_5Hz", "--scenario", "sine_10Hz", "--population", "6"]


@pytest.fixture(scope="module")
def recipe(build: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The published recipe at the plant's own drive, as a rule file."""
    folder = tmp_path_factory.mktemp("recipe")
    options = ["--drive", "0.1", "--step-mA", "1250", "--write", "recipe.fcl"]
    result = run_quiesce(folder, "rules", "lookup", *options)
    assert result.returncode == 0, result.stderr
    return folder / "recipe.fcl"


@pytest.fixture(scope="module")
def searched(build: Path, recipe: Path, tmp_path_factory: pytest.TempPathFactory):
    """One short search in closed loop: the process and its folder."""
    folder = tmp_path_factory.mktemp("searched")
    options = ["--generations", "4", "--start", recipe, "--tune", "both", "--out", "out"]
    result = run_quiesce(folder, "rules", "optimize", *SHORT, *options)
    assert result.returncode == 0, result.stderr
    return result, folder / "out"


# Lookup


@pytest.mark.slow
def test_lookup_reproduces_the_published_choice_at_every_drive(quiesce) -> None:
    result = quiesce("rules", "lookup", "--json")
    assert result.returncode == 0, result.stderr
    cells = json.loads(result.stdout)
    assert [(c["freq_hz"], c["drive_V"]) for c in cells] == [
        (f, v) for v in (0.09, 0.1, 0.12) for f in (5, 10, 15, 20)
    ]
    assert [c["current_mA"] for c in cells] == [0, 5000, 5000, 5000] * 3
    reductions = {(c["freq_hz"], c["drive_V"]): c["amp_reduction_pct"] for c in cells}
    expected = {0.09: (26.0, 30.6, 31.1), 0.1: (22.9, 26.0, 26.5), 0.12: (18.4, 19.8, 20.0)}
    for drive_V, row in expected.items():
        for freq_Hz, pct in zip((10, 15, 20), row, strict=True):
            assert abs(reductions[freq_Hz, drive_V] - pct) < 0.1


def test_recipe_is_the_rule_base_that_ships(recipe, build) -> None:
    surface = rule_surface(Bench())
    base = read_rules(recipe)
    ours = evaluate(base, [surface.freq_Hz[None, :], surface.rms_m_s2[:, None]]).outputs[0]
    assert np.abs(ours - surface.current_A).max() < 2e-3


def test_lookup_of_another_plant_scales_to_it(quiesce, tmp_path) -> None:
    plant = ROOT / "sim_hil/data/plants/frame_3dof.toml"
    options = ["--plant", plant, "--freq", "3,4.2,9.9", "--drive", "0.5", "--step-mA", "500"]
    result = quiesce("rules", "lookup", *options, "--write", "frame.fcl")
    assert result.returncode == 0, result.stderr
    base = read_rules(tmp_path / "frame.fcl")
    assert base.outputs[0].maximum == 2.0
    assert [len(v.sets) for v in base.inputs] == [3, 4]
    assert re.search(r"^ +4\.2 ", result.stdout, re.MULTILINE)


# A search


def test_search_writes_its_files_and_shows_progress(searched) -> None:
    result, folder = searched
    assert sorted(p.name for p in folder.iterdir()) == FILES
    for words in ("Table VII:", "Table VIII, found", "constant: x %", "cost"):
        assert words in result.stdout
    progress = [line for line in result.stderr.splitlines() if line.startswith("[4/4] best cost")]
    assert len(progress) == 1
    assert "\x1b" not in result.stderr and "\r" not in result.stderr
    page = (folder / "report.html").read_text()
    assert page.count("<svg") == 3
    assert not re.search(r'(src|href)="(?!data:|#)', page)


def test_search_tells_what_it_found(searched) -> None:
    _, folder = searched
    found = json.loads((folder / "result.json").read_text())
    cost = found["cost"]
    assert cost["found"] <= cost["start"]
    assert [p["freq_hz"] for p in found["places"]] == [5.0, 10.0]
    assert found["history"]["best"] == sorted(found["history"]["best"], reverse=True)
    assert found["history"]["evaluations"][-1] <= found["evaluations"]
    at_10Hz = found["places"][1]
    assert at_10Hz["best_constant"]["current_mA"] == 5000
    assert abs(at_10Hz["start"]["amp_reduction_pct"] - 22.9) < 0.1
    assert at_10Hz["bound_pct"] == [26.2, 26.0]


@pytest.mark.slow
def test_rule_file_that_was_written_does_what_the_report_says(searched, quiesce, tmp_path) -> None:
    """Read again as the start of another search, it has the cost of the one that was found."""
    _, folder = searched
    options = ["--generations", "1", "--start", folder / "best.fcl", "--out", "again", "--json"]
    result = quiesce("rules", "optimize", *SHORT, *options)
    assert result.returncode == 0, result.stderr
    again = json.loads(result.stdout)
    found = json.loads((folder / "result.json").read_text())
    for one, other in zip(again["places"], found["places"], strict=True):
        for key, value in other["found"].items():
            assert abs(one["start"][key] - value) < 2e-3


@pytest.mark.slow
def test_jobs_do_not_change_the_result(searched, recipe, quiesce, tmp_path) -> None:
    options = ["--generations", "4", "--start", recipe, "--tune", "both", "--out", "out"]
    result = quiesce("rules", "optimize", *SHORT, *options, "--jobs", "1")
    assert result.returncode == 0, result.stderr
    for name in FILES:
        assert (tmp_path / "out" / name).read_bytes() == (searched[1] / name).read_bytes()


@pytest.mark.slow
def test_step_scenario_counts_both_of_its_steady_states(quiesce) -> None:
    options = ["--scenario", "step_10_20Hz", "--generations", "1", "--population", "4", "--json"]
    result = quiesce("rules", "optimize", *options, "--out", "out")
    assert result.returncode == 0, result.stderr
    places = json.loads(result.stdout)["places"]
    assert [p["freq_hz"] for p in places] == [10.0, 20.0]
    for place, pct in zip(places, (22.9, 26.5), strict=True):
        assert abs(place["start"]["amp_reduction_pct"] - pct) < 0.2
        assert abs(place["start"]["mean_current_A"] - 5.0) < 0.05


@pytest.mark.slow
def test_weights_and_outputs_steer_the_search(quiesce) -> None:
    """With current as the only cost, the rules end at 0 A."""
    options = ["--scenario", "sine_10Hz", "--objective", "thrifty", "--weight", "displacement=0"]
    options += ["--weight", "acceleration=0", "--generations", "12", "--population", "16", "--json"]
    result = quiesce("rules", "optimize", *options, "--out", "out")
    assert result.returncode == 0, result.stderr
    place = json.loads(result.stdout)["places"][0]
    assert place["start"]["mean_current_A"] > 4.9
    assert place["found"]["mean_current_A"] < 0.1
    assert place["best_constant"]["current_mA"] == 0


@pytest.mark.slow
def test_several_objectives_give_a_front_with_a_rule_file_each(quiesce, tmp_path) -> None:
    options = ["--method", "nsga2", "--weight", "current=1", "--generations", "4"]
    options += ["--scenario", "sine_10Hz", "--population", "8", "--json", "--out", "out"]
    result = quiesce("rules", "optimize", *options)
    assert result.returncode == 0, result.stderr
    front = json.loads(result.stdout)["front"]
    costs = np.array([point["costs"] for point in front])
    assert len(front) >= 2 and costs.shape[1] == 3
    for one in costs:
        assert not ((costs <= one).all(axis=1) & (costs < one).any(axis=1)).any()
    for i in range(len(front)):
        assert read_rules(tmp_path / f"out/front_{i + 1:02}.fcl").rules


# Interruption


def interrupt_after(folder: Path, generation: int, arguments: list[str]) -> tuple[int, str]:
    """Runs a search and sends it SIGINT once a generation is done."""
    process = subprocess.Popen(
        [sys.executable, "-m", "quiesce", "rules", "optimize", *arguments],
        cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT / "tools/src")},
    )  # fmt: skip
    assert process.stderr is not None
    lines = []
    for line in process.stderr:
        lines.append(line)
        if re.match(rf"\[ *{generation}/\d+\] best cost", line):
            process.send_signal(signal.SIGINT)
    return process.wait(timeout=60), "".join(lines)


@pytest.mark.slow
def test_interrupted_search_resumes_to_the_same_files(recipe, quiesce, tmp_path) -> None:
    options = [*SHORT, "--method", "de", "--generations", "40", "--start", str(recipe)]
    status, text = interrupt_after(tmp_path, 2, [*options, "--out", "parts"])
    assert status == 130, text
    assert "--resume go on" in text.splitlines()[-1] and "Traceback" not in text
    assert [p.name for p in (tmp_path / "parts").iterdir()] == ["state.json"]
    before = json.loads((tmp_path / "parts/state.json").read_text())
    assert 2 <= len(before["digests"]) < 40 and not before["is_finished"]

    refused = quiesce("rules", "optimize", *options, "--out", "parts")
    assert refused.returncode == 2 and "--resume" in refused.stderr
    other = quiesce("rules", "optimize", *options, "--seed", "2", "--out", "parts", "--resume")
    assert other.returncode == 2 and "seed: 1, not 2" in other.stderr

    resumed = quiesce("rules", "optimize", *options, "--out", "parts", "--resume")
    whole = quiesce("rules", "optimize", *options, "--out", "whole")
    assert (resumed.returncode, whole.returncode) == (0, 0), resumed.stderr + whole.stderr
    for name in FILES:
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_damaged_state_is_refused_and_kept(recipe, quiesce, tmp_path) -> None:
    (tmp_path / "out").mkdir()
    file = tmp_path / "out/state.json"
    file.write_text('{"schema": "quiesce-rules-optimize", "version": 1, "settings"')
    result = quiesce("rules", "optimize", *SHORT, "--start", recipe, "--resume", "--out", "out")
    assert result.returncode == 2 and result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    assert "state.json is damaged" in result.stderr and "--anew" in result.stderr
    assert [p.name for p in file.parent.iterdir()] == ["state.json"]


# Bad input


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--scenario", "sine_6Hz"], ["sine_6Hz", "sine_5Hz"]),
        (["--scenario", "none.toml"], ["none.toml", "No such file"]),
        (["--start", "none.fcl"], ["none.fcl"]),
        (["--start", "torn.fcl"], ["torn.fcl"]),
        (["--generations", "-1"], ["--generations", "1 .. 100000, found '-1'"]),
        (["--generations", "0"], ["--generations"]),
        (["--generations", "many"], ["--generations", "many"]),
        (["--evaluations", "0"], ["--evaluations"]),
        (["--population", "3"], ["--population", "4 .. 1000"]),
        (["--seed", "-1"], ["--seed"]),
        (["--jobs", "0"], ["--jobs"]),
        (["--method", "luck"], ["luck", "nsga2"]),
        (["--objective", "peace"], ["peace", "thrifty"]),
        (["--tune", "colours"], ["--tune colours", "rules, sets, outputs"]),
        (["--tune", ""], ["--tune"]),
        (["--weight", "noise=1"], ["--weight noise=1", "displacement"]),
        (["--weight", "current=-1"], ["current=-1", "0 .. 1000000"]),
        (["--weight", "current=nan"], ["current=nan"]),
        (["--weight", "displacement=0", "--weight", "acceleration=0"], ["all weights are 0"]),
        (["--freq", "5;10"], ["--freq 5;10", "commas"]),
        (["--freq", "5,500"], ["--freq", "0.1 .. 100"]),
        (["--freq", "5,nan"], ["--freq"]),
        (["--drive", "0.1"], ["--drive", "--freq"]),
        (["--freq", "5", "--drive", "-1"], ["--drive -1"]),
        (["--freq", "5", "--settle", "0"], ["--settle", "1 .. 600"]),
        (["--freq", "5", "--plant", "none.toml"], ["--plant", "none.toml"]),
        (["--freq", "5", "--plant", "torn.fcl"], ["--plant", "torn.fcl"]),
        (["--set", "no_such=3"], ["no_such", "quiesce params"]),
        (["--resume"], ["state.json does not exist", "nothing to resume"]),
        (["--resume", "--anew"], ["exclude each other"]),
        (["--fast"], ["--fast", "--help"]),
    ],
)
def test_optimize_argument_is_refused(refused, tmp_path, arguments, words) -> None:
    (tmp_path / "torn.fcl").write_text("FUNCTION_BLOCK a\nVAR_INPUT")
    message = refused("rules", "optimize", "--out", "out", *arguments)
    for word in words:
        assert word in message


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--freq", ""], ["--freq"]),
        (["--drive", "x"], ["--drive x"]),
        (["--step-mA", "0"], ["--step-mA", "1 .. 20000"]),
        (["--plant", "none.toml"], ["--plant", "none.toml"]),
        (["--write", "none/rules.fcl"], ["--write none/rules.fcl", "folder"]),
        (["--set", "law"], ["NAME=VALUE"]),
    ],
)
def test_lookup_argument_is_refused(refused, arguments, words) -> None:
    message = refused("rules", "lookup", *arguments)
    for word in words:
        assert word in message


ONE_INPUT = """FUNCTION_BLOCK one
VAR_INPUT
    f : REAL;
END_VAR
VAR_OUTPUT
    I : REAL;
END_VAR
FUZZIFY f
    TERM S := (0, 1) (10, 0);
    TERM H := (0, 0) (10, 1);
    RANGE := (0 .. 10);
END_FUZZIFY
DEFUZZIFY I
    TERM Z := 0;
    TERM L := 5;
    METHOD : COGS;
    DEFAULT := 0;
    RANGE := (0 .. 5);
END_DEFUZZIFY
RULEBLOCK rules
    AND : MIN;
    RULE 1 : IF f IS S THEN I IS Z;
    RULE 2 : IF f IS H THEN I IS L;
END_RULEBLOCK
END_FUNCTION_BLOCK
"""


def test_rules_of_another_shape_are_refused(refused, tmp_path) -> None:
    (tmp_path / "one.fcl").write_text(ONE_INPUT)
    message = refused("rules", "optimize", *SHORT, "--start", "one.fcl")
    assert "one has 1 inputs and 1 outputs" in message and "two inputs" in message
