"""`quiesce tune law` on the bench, with a short shaking and few trials."""

import json
import os
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

RIG = ["--rig", "three_storeys_1996", "--accel-column", "acc_g", "--scale-to", "2"]
TRACKED = ["skyhook", "--tracker", "proportional"]


@pytest.fixture
def quake(tmp_path: Path) -> Path:
    t = np.arange(0, 1, 0.01)
    accel = np.sin(2 * np.pi * 5.0 * t) * np.exp(-t)
    file = tmp_path / "quake.csv"
    file.write_text(
        "t_s,acc_g\n" + "".join(f"{a:.3f},{b:.6f}\n" for a, b in zip(t, accel, strict=True))
    )
    return file


def trial_lines(folder: Path) -> list[dict]:
    _, *rows = (folder / "trials.jsonl").read_text().splitlines()
    return [json.loads(row) for row in rows]


def test_what_is_found_is_in_all_files_and_runs(quiesce, quake: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = [*TRACKED, *RIG, "--record", quake, "--trials", "9", "--fix", "limit_N=800"]
    result = quiesce("tune", "law", *words, "--out", out)
    assert result.returncode == 0, result.stderr
    assert "[9/9] skyhook: " in result.stderr and "best" in result.stderr
    data = json.loads((out / "tune.json").read_text())
    assert data["trials"] == len(trial_lines(out)) == 9
    costs = [one["runs"]["quake"]["index"] for one in trial_lines(out)]
    assert data["tuned"]["cost"] == pytest.approx(min(costs))
    assert data["tuned"]["cost"] < data["start"]["cost"]
    settings = tomllib.loads((out / "skyhook.toml").read_text())
    assert settings["settings"] == {**data["settings"], "limit_N": 800.0}
    assert settings["parameters"]["tracker"] == "proportional"
    page = (out / "tune.html").read_text()
    assert page.count("<figure") == 2 and "sky_N_s_m" in page and data["command"] in page
    # The table that was written is the one that was tried.
    label = f"linear:table={out / 'skyhook.table'},tracker=proportional,as=tuned,"
    label += f"tracker_gain_mA_kN={settings['parameters']['tracker_gain_mA_kN']}"
    told = quiesce("compare", *RIG, "--record", quake, "--law", label, "--json")
    cells = {one["law"]: one for one in json.loads(told.stdout)["cells"]}
    assert cells["tuned"]["index"] == pytest.approx(data["tuned"]["cost"], rel=1e-9)


def test_any_number_of_workers_finds_the_same(quiesce, quake: Path, tmp_path: Path) -> None:
    words = ["tune", "law", "skyhook_on_off", *RIG, "--record", quake, "--trials", "18"]
    found = []
    for jobs in ("1", "3"):
        told = quiesce(*words, "--jobs", jobs, "--out", tmp_path / jobs, "--json")
        assert told.returncode == 0, told.stderr
        found.append(json.loads(told.stdout))
        keys = {json.dumps(one["values"], sort_keys=True) for one in trial_lines(tmp_path / jobs)}
        assert len(keys) == found[-1]["trials"] <= 18
    assert found[0]["tuned"] == found[1]["tuned"]
    again = quiesce(*words, "--seed", "2", "--trials", "3", "--out", tmp_path / "1", "--json")
    assert json.loads(again.stdout)["tuned"]["values"] != found[0]["tuned"]["values"]


def test_an_interrupted_one_keeps_what_it_found_and_goes_on(
    quiesce, quake: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    words = ["tune", "law", "skyhook_on_off", *RIG, "--record", str(quake), "--trials", "24"]
    words += ["--out", str(out)]
    process = subprocess.Popen(
        [sys.executable, "-m", "quiesce", *words],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT / "tools/src")},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    for _ in range(1200):
        if (out / "trials.jsonl").is_file() and len(trial_lines(out)) >= 4:
            break
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    told, progress = process.communicate(timeout=120)
    assert process.returncode == 130, progress
    assert "interrupted; the same command goes on" in told
    before = trial_lines(out)
    assert 4 <= len(before) < 24
    assert (out / "skyhook_on_off.table").is_file()
    # A line that was being written is dropped.
    with (out / "trials.jsonl").open("a") as file:
        file.write('{"values": {"on_A"')
    resumed = quiesce(*words, "--json")
    assert resumed.returncode == 0, resumed.stderr
    assert trial_lines(out)[: len(before)] == before
    fresh = quiesce(*words, "--fresh", "--json")
    keep = ("tuned", "start", "trials", "settings")
    one, other = (json.loads(x.stdout) for x in (resumed, fresh))
    assert {key: one[key] for key in keep} == {key: other[key] for key in keep}


def test_a_store_of_another_kind_is_refused(quiesce, quake: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ["tune", "law", "skyhook_on_off", *RIG, "--record", quake, "--out", out]
    assert quiesce(*words, "--trials", "1").returncode == 0
    for more, message in (
        (["--seeds", "2"], "holds trials of another seeds"),
        (["--scale-to", "1"], "holds trials of another shaking"),
    ):
        result = quiesce(*words, *more)
        assert result.returncode == 2 and message in result.stderr
        assert len(result.stderr.splitlines()) == 1
    lines = (out / "trials.jsonl").read_text().splitlines()
    (out / "trials.jsonl").write_text("\n".join([lines[0], "{}", lines[1], ""]))
    result = quiesce(*words)
    assert result.returncode == 2 and "is damaged" in result.stderr


BAD = [
    (["nothing"], "no recipe 'nothing'; there are: "),
    (["skyhook"], "needs a damper's map, --map FILE"),
    (["skyhook", "--map", "none.table"], "there is no file none.table"),
    (["add", "--tracker", "compare"], "add demands currents; it has no tracker"),
    ([*TRACKED, "--fix", "nothing=1"], "neither a setting of the recipe (sky_N_s_m, limit_N)"),
    ([*TRACKED, "--fix", "sky_N_s_m=-1"], "expected a number in 0 .. 1e+06"),
    ([*TRACKED, "--fix", "tracker=1"], "'tracker' is neither"),
    ([*TRACKED, "--search", "sky_N_s_m=5"], "expected NAME=LOW:HIGH"),
    ([*TRACKED, "--search", "sky_N_s_m=5:5"], "an empty range"),
    ([*TRACKED, "--search", "sky_N_s_m=5:x"], "expected a number in"),
    ([*TRACKED, "--search", "velocity_cutoff_mHz=1.5:9"], "expected an integer in"),
    ([*TRACKED, "--fix", "limit_N=5", "--search", "limit_N=1:9"], "limit_N is named twice"),
    ([*TRACKED, "--figure", "nothing"], "--figure nothing: this structure has index, disp_peak_mm"),
    ([*TRACKED, "--figure", "tyre_share"], "--figure tyre_share: this structure has index"),
    ([*TRACKED, "--trials", "0"], "expected an integer in 1 .. 100000"),
    ([*TRACKED, "--worst", "-1"], "expected a number in"),
    (["modulated_friction", "--fix", "outward=0", "--fix", "back=0"], "never act"),
]


@pytest.mark.parametrize(("words", "message"), BAD)
def test_bad_input_is_one_line(refused, quake: Path, words: list[str], message: str) -> None:
    assert message in refused("tune", "law", *words, *RIG, "--record", quake, "--out", "out")


def test_no_records_and_no_rig_are_one_line(refused, quake: Path, tmp_path: Path) -> None:
    assert "name the structure" in refused("tune", "law", *TRACKED, "--record", quake)
    nothing = ["tune", "law", *TRACKED, *RIG, "--record", tmp_path / "none.csv"]
    assert "none.csv" in refused(*nothing)
    assert "is a file" in refused("tune", "law", *TRACKED, *RIG, "--out", quake)
