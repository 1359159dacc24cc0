"""`quiesce identify`: from a CSV to model files, what it refuses, and going on after Ctrl-C."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import pyuff
from quiesce.base.paths import shown
from quiesce.cli.main import main
from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.simulate import simulator_of_file

TRUTH = {
    "c_N_s_m": 900.0,
    "k_N_m": 2000.0,
    "kw_N": 300.0,
    "rho_1_m": 1500.0,
    "sigma": 0.8,
    "n": 1.5,
    "f0_N": 12.0,
}


def write_example(file: Path, rows: int = 1200, noise_N: float = 1.0) -> None:
    """A normalised Bouc-Wen damper under two sines, 200 Hz, with noise."""
    time_s = np.arange(rows) / 200.0
    angle = 2.0 * np.pi * np.array([[1.3], [2.9]]) * time_s
    sizes = np.array([[6e-3], [2e-3]])
    omega = 2.0 * np.pi * np.array([[1.3], [2.9]])
    disp_m = np.sum(sizes * np.sin(angle), axis=0)
    velocity = np.sum(sizes * omega * np.cos(angle), axis=0)
    accel = -np.sum(sizes * omega**2 * np.sin(angle), axis=0)
    zero = np.zeros(rows)
    record = Record("made", 200.0, time_s, disp_m, velocity, accel, zero, zero, "A")
    one = library.model("normalised_bouc_wen")
    row = np.array([*TRUTH.values(), *np.zeros(len(library.RIG))])
    force_N = library.simulate(one, [1] * 7, row, library.motion(record), 4)[0]
    force_N += np.random.default_rng(1).normal(0.0, noise_N, rows)
    lines = [
        f"{t:.4f},{1e3 * x:.6f},{f:.4f}" for t, x, f in zip(time_s, disp_m, force_N, strict=True)
    ]
    file.write_text("\n".join(["time_s,disp_mm,force_N", *lines]) + "\n", encoding="utf-8")


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("identify") / "rig.csv"
    write_example(file)
    return file


def arguments(example: Path, out: Path, *more: str) -> list[str]:
    base = ["identify", str(example), "--current-a", "0", "--low-pass-hz", "60"]
    return [*base, "--effort", "quick", "--rig", "none", "--out", str(out), *more]


def test_finds_the_truth_and_writes_a_model(
    example: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = arguments(example, tmp_path, "--model", "normalised_bouc_wen,kwok_tanh", "--json")
    assert main(words) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["winners"]["best"] == "normalised_bouc_wen"
    model, simulate = simulator_of_file(tmp_path / "damper.toml")
    for name, value in TRUTH.items():
        assert model.parameters[name] == pytest.approx(value, rel=0.05), name
    assert (tmp_path / "report.html").is_file()
    assert (tmp_path / "models/kwok_tanh.toml").is_file()
    assert simulate is not None


@pytest.mark.slow
def test_fitted_forces_go_to_other_programs(
    example: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = arguments(example, tmp_path, "--model", "bingham", "--test", "time_s=3,6")
    assert main([*words, "--train", "time_s=0,3", "--format", "uff"]) == 0
    assert "02_test_rig.csv.uff" in capsys.readouterr().out
    train, test = (tmp_path / f"runs/{name}_rig.csv.uff" for name in ("01_train", "02_test"))
    sets = {one["id1"].strip(): one for one in pyuff.UFF(str(test)).read_sets()}
    measured, modelled = sets["force"]["data"], sets["bingham_force"]["data"]
    assert len(pyuff.UFF(str(train)).read_sets()) == len(sets) == 5
    report = json.loads((tmp_path / "report.json").read_text())
    error = float(np.linalg.norm(measured - modelled) / np.linalg.norm(measured))
    assert error == pytest.approx(report["models"][0]["test"]["error"], rel=1e-3)


@pytest.mark.slow
def test_files_of_an_earlier_run_do_not_stay(
    example: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """anfis is not passive by construction, nor in trials; what the user has put there stays."""
    words = arguments(example, tmp_path, "--model", "bingham", "--format", "mat", "--json")
    assert main(words) == 0
    written = json.loads(capsys.readouterr().out)["written"]
    assert [Path(one).name for one in written[-2:]] == ["damper.toml", "01_train_rig.csv.mat"]
    assert all((tmp_path / Path(one).relative_to(shown(tmp_path))).exists() for one in written)
    (tmp_path / "runs/mine.mat").write_text("mine")
    assert main(arguments(example, tmp_path, "--model", "anfis", "--json")) == 0
    found = json.loads(capsys.readouterr().out)
    assert "passive" not in found["winners"]
    assert [Path(one).name for one in found["written"]] == ["report.html", "report.json", "models"]
    assert not (tmp_path / "damper.toml").exists()
    assert [one.name for one in (tmp_path / "runs").iterdir()] == ["mine.mat"]


@pytest.mark.slow
def test_a_moment_of_another_current_is_no_level(example: Path, tmp_path: Path) -> None:
    """A glitch of the current's sensor: one level still, and no law against the current."""
    head, *rows = example.read_text().splitlines()[:401]
    rows = [f"{row},{-0.3 if i == 200 else 0.5}" for i, row in enumerate(rows)]
    glitch = tmp_path / "glitch.csv"
    glitch.write_text("\n".join([f"{head},current_A", *rows]) + "\n")
    command = ["identify", str(glitch), "--model", "bingham", "--effort", "quick"]
    assert main([*command, "--out", str(tmp_path / "out")]) == 0


def test_models_that_a_limit_cuts_short_are_marked_and_ranked(
    example: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With hardly any time: both kinds of model are there, learned ones trained briefly."""
    words = arguments(example, tmp_path, "--model", "anfis,viscoplastic_2", "--json")
    words[words.index("--effort") + 1] = "full"
    assert main([*words, "--time-limit", "0.05"]) == 0
    out, err = capsys.readouterr()
    models = {one["name"]: one for one in json.loads(out)["models"]}
    assert set(models) == {"anfis", "viscoplastic_2"}
    for one in models.values():
        assert not one["is_complete"] and 0.0 < one["validation_error"] < 1.0
    assert any("trained briefly" in note for note in models["anfis"]["notes"])
    assert "anfis: validation" in err and "not to its end" in err
    assert (tmp_path / "models/anfis.toml").is_file()


def test_same_seed_same_model(example: Path, tmp_path: Path) -> None:
    texts = []
    for folder in ("a", "b"):
        words = arguments(example, tmp_path / folder, "--model", "viscoplastic_1")
        assert main([*words, "--jobs", "2" if folder == "a" else "1"]) == 0
        texts.append((tmp_path / folder / "damper.toml").read_text(encoding="utf-8"))
    assert texts[0] == texts[1]


@pytest.mark.slow
def test_fixed_and_bounded_parameters(example: Path, tmp_path: Path) -> None:
    more = ["--model", "normalised_bouc_wen", "--fix", "n=2", "--bound", "rho_1_m=100:1000"]
    assert main(arguments(example, tmp_path, *more)) == 0
    model, _ = simulator_of_file(tmp_path / "damper.toml")
    assert model.parameters["n"] == 2.0
    assert 100.0 <= model.parameters["rho_1_m"] <= 1000.0


@pytest.mark.slow
def test_resume_keeps_what_is_there(
    example: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments(example, tmp_path, "--model", "kwok_tanh")) == 0
    before = (tmp_path / "models/kwok_tanh.toml").stat().st_mtime_ns
    capsys.readouterr()
    assert main(arguments(example, tmp_path, "--model", "kwok_tanh,bingham", "--resume")) == 0
    assert "[1/1] bingham" in capsys.readouterr().err
    assert (tmp_path / "models/kwok_tanh.toml").stat().st_mtime_ns == before
    # Other options: nothing fits, all is done again.
    words = arguments(example, tmp_path, "--model", "kwok_tanh", "--resume", "--seed", "2")
    assert main(words) == 0
    assert (tmp_path / "models/kwok_tanh.toml").stat().st_mtime_ns > before


@pytest.mark.slow
def test_broken_state_is_done_again(example: Path, tmp_path: Path) -> None:
    assert main(arguments(example, tmp_path, "--model", "bingham")) == 0
    (tmp_path / "models/bingham.state.json").write_text("{", encoding="utf-8")
    assert main(arguments(example, tmp_path, "--model", "bingham", "--resume")) == 0


@pytest.mark.parametrize(
    ("more", "hint"),
    [
        (["--model", "bouc_wenn"], "no model 'bouc_wenn'"),
        (["--model", ""], "an argument is empty: --model ''"),
        (["--fix", "n"], "write NAME=VALUE"),
        (["--fix", "nn=2"], "no model has such a parameter"),
        (["--bound", "n=1"], "write NAME=LOW:HIGH"),
        (["--bound", "n=3:2", "--model", "normalised_bouc_wen"], "first has to be below"),
        (["--bound", "n=30:40", "--model", "normalised_bouc_wen"], "nothing is left"),
        (["--rig", "mass"], "--rig mass"),
        (["--time-limit", "0"], "--time-limit"),
        (["--jobs", "0"], "--jobs"),
        (["--current-order", "5"], "--current-order"),
        (["--method", "simplex"], "--method"),
    ],
)
def test_bad_options_end_in_one_line(
    example: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[str], hint: str
) -> None:
    assert main(arguments(example, tmp_path / "out", *more)) == 2
    text = capsys.readouterr().err.strip()
    assert hint in text and "\n" not in text
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_wrong_sign_is_a_hint(
    example: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = example.read_text(encoding="utf-8").splitlines()
    turned = [lines[0]] + [
        f"{a},{b},{-float(c):.4f}" for a, b, c in (r.split(",") for r in lines[1:])
    ]
    file = tmp_path / "turned.csv"
    file.write_text("\n".join(turned) + "\n", encoding="utf-8")
    assert main(arguments(file, tmp_path / "out", "--model", "bingham")) == 2
    assert "--flip-force" in capsys.readouterr().err
    assert main(arguments(file, tmp_path / "out", "--model", "bingham", "--flip-force")) == 0


def test_models_are_listed(example: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["identify", str(example), "--model", "list"]) == 0
    out = capsys.readouterr().out
    for name in library.models():
        assert f"{name}:" in out
    assert "grey_box" in out


@pytest.mark.slow
def test_ctrl_c_keeps_finished_models(example: Path, tmp_path: Path) -> None:
    """Interrupted while fitting: finished models are there, and are reported without a fit."""
    words = [
        "identify", str(example), "--current-a", "0", "--low-pass-hz", "60", "--rig", "none",
        "--model", "kwok_tanh,viscoplastic_2,viscoplastic_3,viscoplastic_4_free",
        "--jobs", "1", "--out", str(tmp_path),
    ]  # fmt: skip
    process = subprocess.Popen(
        [sys.executable, "-m", "quiesce", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ,
    )
    deadline = time.monotonic() + 120.0
    while not list(tmp_path.glob("models/*.state.json")) and time.monotonic() < deadline:
        assert process.poll() is None
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=300)
    assert process.returncode == 130, err
    assert "Traceback" not in err and out == ""
    told = re.fullmatch(
        r"quiesce: interrupted; (\d) of 4 models are finished and kept: "
        r"--resume goes on, --resume --model (\S+) reports them",
        err.splitlines()[-1],
    )
    assert told and len(told[2].split(",")) == int(told[1])
    assert not list(tmp_path.glob("models/.quiesce-*")) and not (tmp_path / "report.html").exists()
    before = {file: file.read_bytes() for file in tmp_path.glob("models/*.toml")}
    words[words.index("--model") + 1] = told[2]
    assert main([*words, "--resume"]) == 0
    assert (tmp_path / "report.html").is_file()
    assert {file: file.read_bytes() for file in tmp_path.glob("models/*.toml")} == before


def write_sine(file: Path, mean_mm: float, freq_Hz: float) -> None:
    """Ten cycles of the damper TRUTH about mean_mm, 2 kHz."""
    rate_Hz = 2000.0
    time_s = np.arange(round(10.0 / freq_Hz * rate_Hz)) / rate_Hz
    omega = 2.0 * np.pi * freq_Hz
    disp_m = 1e-3 * mean_mm + 5e-3 * np.sin(omega * time_s)
    velocity = 5e-3 * omega * np.cos(omega * time_s)
    zero = np.zeros(len(time_s))
    accel = -5e-3 * omega**2 * np.sin(omega * time_s)
    record = Record("made", rate_Hz, time_s, disp_m, velocity, accel, zero, zero, "A")
    row = np.array([*TRUTH.values(), *np.zeros(len(library.RIG))])
    model = library.model("normalised_bouc_wen")
    force_N = library.simulate(model, [1] * 7, row, library.motion(record), 2)[0]
    rows = zip(time_s, 1e3 * disp_m, force_N, strict=True)
    lines = [f"{t:.5f},{x:.7f},{f:.6f}" for t, x, f in rows]
    file.write_text("\n".join(["time_s,disp_mm,force_N", *lines]) + "\n", encoding="utf-8")


@pytest.mark.slow
def test_least_squares_from_three_sines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files = [tmp_path / name for name in ("still.csv", "shifted.csv", "faster.csv")]
    for file, mean_mm, freq_Hz in zip(files, (0.0, 3.0, 0.0), (1.0, 1.0, 2.0), strict=True):
        write_sine(file, mean_mm, freq_Hz)
    words = ["identify", *map(str, files), "--current-a", "0", "--low-pass-hz", "300"]
    words += ["--keep-offset", "--method", "ls", "--out", str(tmp_path / "out")]
    assert main(words) == 0
    model, _ = simulator_of_file(tmp_path / "out/damper.toml")
    for name in ("c_N_s_m", "k_N_m", "kw_N", "rho_1_m", "n"):
        assert model.parameters[name] == pytest.approx(TRUTH[name], rel=0.03), name
    capsys.readouterr()
    assert main([*words[:3], *words[4:]]) == 2
    assert "three tests" in capsys.readouterr().err
