"""Bad input: one clear line that says what to do, exit code 2, nothing written."""

import os
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

GOOD_ROWS = ["t_s,acc_g"] + [f"{0.01 * i:.2f},{0.1 * (-1) ** i}" for i in range(300)]


def recording(folder: Path, rows: list[str]) -> Path:
    file = folder / "recording.csv"
    file.write_text("".join(row + "\n" for row in rows))
    return file


def with_row(line: int, row: str) -> list[str]:
    """The good rows, with the one on this line of the file replaced."""
    return [*GOOD_ROWS[: line - 1], row, *GOOD_ROWS[line:]]


# Recordings


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ([], ["empty"]),
        (["", ""], ["empty"]),
        (["t_s,acc_g"], ["0 rows", "at least 3"]),
        (GOOD_ROWS[:3], ["2 rows", "at least 3"]),
        (["t_s,other", *GOOD_ROWS[1:]], ["'acc_g'", "there are: t_s, other"]),
        (["time,acc_g", *GOOD_ROWS[1:]], ["'t_s'", "there are: time, acc_g"]),
        (["t_s,acc_g,acc_g", *GOOD_ROWS[1:]], ["more than one column is named 'acc_g'"]),
        (with_row(7, "0.05,nan"), [":7:", "acc_g", "'nan'; cut these rows"]),
        (with_row(7, "0.05,inf"), [":7:", "cut these rows"]),
        (with_row(7, "0.05,high"), [":7:", "acc_g", "'high' is not a number"]),
        (with_row(7, "0.05,"), [":7:", "acc_g", "empty cell"]),
        (with_row(7, "0.05"), [":7:", "1 cells where the header has 2 columns"]),
        (with_row(7, "0.03,0.1"), [":7:", "goes back in time", "sort"]),
        (with_row(7, "0.04,0.1"), [":7:", "repeats the time before"]),
        (GOOD_ROWS[:100] + GOOD_ROWS[110:], [":101:", "irregular"]),
    ],
)
def test_recording_is_refused(refused, tmp_path: Path, rows, words) -> None:
    file = recording(tmp_path, rows)
    message = refused("replay", file, "--column", "acc_g", "--unit", "g", "--out", "out")
    assert "recording.csv" in message
    for word in words:
        assert word in message


def test_missing_recording_is_refused(refused) -> None:
    assert "none.csv: No such file" in refused("replay", "none.csv", "--column", "a", "--unit", "g")


def test_binary_recording_is_refused(refused, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(b"\xff\xfe\x00\x80" * 50)
    assert "text in UTF-16" in refused("replay", "a.csv", "--column", "a", "--unit", "g")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--unit", "furlong"], ["furlong", "m_s2"]),
        (["--unit", "g", "--set", "law=strong"], ["law=strong", "off, constant, fuzzy"]),
        (["--unit", "g", "--set", "rms_window_ms=1"], ["rms_window_ms", "100 .. 4000"]),
        (["--unit", "g", "--set", "tick_rate_Hz=1500"], ["tick_rate_Hz", "1000"]),
        (["--unit", "g", "--set", "colour=1"], ["colour", "quiesce params"]),
        (["--unit", "g", "--set", "law"], ["NAME=VALUE"]),
        (["--unit", "g", "--set", "safe_current_mA=9000"], ["safe_current_mA"]),
        (["--unit", "g", "--reference-column", "no"], ["'no'", "acc_g"]),
        (
            ["--unit", "g", "--reference-column", "acc_g", "--from-s", "50"],
            ["--from-s 50", "0 .. 2.99"],
        ),
        (["--unit", "g", "--every", "0"], ["--every"]),
        (["--unit", "g", "--out", "recording.csv"], ["recording.csv", "--out"]),
    ],
)
def test_replay_option_is_refused(refused, tmp_path: Path, options, words) -> None:
    file = recording(tmp_path, GOOD_ROWS)
    message = refused("replay", file, "--column", "acc_g", *options)
    for word in words:
        assert word in message


# Closed loop


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--scenario", "sine_6Hz"], ["sine_6Hz", "sine_5Hz", ".toml"]),
        (["--scenario", "none.toml"], ["none.toml", "No such file"]),
        (["--scenario", "empty.toml"], ["empty.toml", "schema"]),
        (["--scenario", "torn.toml"], ["torn.toml", "not a TOML file"]),
        (["--law", "sliding_mode"], ["sliding_mode", "fuzzy_selftune_printed"]),
        (["--set", "slew_mA_s=3"], ["slew_mA_s=3", "1000 .. 100000000"]),
        (["--set", "no_such=3"], ["no_such", "quiesce params"]),
        (["--set", "safe_current_mA=9000"], ["safe_current_mA", "max_current_mA"]),
        (["--noise-mg", "-1"], ["--noise-mg"]),
        (["--seed", "many"], ["--seed"]),
        (["--target", "moon"], ["moon", "mps2"]),
        (["--fast"], ["--fast", "quiesce hil --help"]),
        (["--out", ""], ["an argument is empty"]),
        (["--out="], ["an argument is empty", "--out="]),
        (["--out", "torn.toml"], ["torn.toml", "--out"]),
    ],
)
def test_hil_argument_is_refused(refused, tmp_path: Path, arguments, words) -> None:
    (tmp_path / "empty.toml").touch()
    (tmp_path / "torn.toml").write_text("name = ")
    target = [] if "--target" in arguments else ["--target", "host"]
    message = refused("hil", *target, *arguments)
    for word in words:
        assert word in message


def test_scenario_with_broken_plant_names_file_and_key(refused, tmp_path: Path) -> None:
    plant = (ROOT / "sim_hil/data/plants/squeeze_2012.toml").read_text()
    (tmp_path / "bad_plant.toml").write_text(plant.replace("gap_m = 0.002", "gap_m = -1"))
    scenario = (ROOT / "sim_hil/data/scenarios/sine_5Hz.toml").read_text()
    (tmp_path / "mine.toml").write_text(
        scenario.replace("../plants/squeeze_2012.toml", "bad_plant.toml")
    )
    message = refused("hil", "--scenario", "mine.toml", "--target", "host")
    assert "bad_plant.toml" in message and "gap_m" in message


@pytest.mark.parametrize("target", ["mps2", "all"])
def test_missing_emulator_says_what_to_install(refused, image, tmp_path: Path, target) -> None:
    message = refused("hil", "--target", target, "--out", "out", PATH=str(tmp_path))
    assert "qemu-system-arm" in message and "--target host" in message


def test_missing_image_says_what_to_run(refused, build: Path, tmp_path: Path) -> None:
    (tmp_path / "build").mkdir()
    (tmp_path / "build/host").symlink_to(build / "host")
    message = refused("hil", "--out", "out", QUIESCE_BUILD=str(tmp_path / "build"))
    assert "quiesce_mps2_shm.elf" in message and "./tools/hil" in message


def test_missing_bench_says_what_to_run(refused, tmp_path: Path) -> None:
    message = refused("params", QUIESCE_BUILD=str(tmp_path))
    assert "quiesce_bench" in message and "./tools/hil" in message


# The rest


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], ["COMMAND", "--help"]),
        (["fly"], ["fly", "hil"]),
        (["--fast"], ["unknown option '--fast'"]),
        (["plant", "check", "none.toml"], ["none.toml"]),
        (["params", "warp"], ["warp"]),
        (["record", "sine_5Hz", "--law", "constant_best", "--out", "x.csv"], ["constant_best"]),
        (["record", "sine_5Hz", "--from-s", "9", "--out", "x.csv"], ["--from-s 9", "0 .. 7.999"]),
    ],
)
def test_other_command_is_refused(refused, arguments, words) -> None:
    message = refused(*arguments)
    for word in words:
        assert word in message


@pytest.mark.parametrize(
    "command",
    [
        [],
        ["hil"],
        ["replay"],
        ["record"],
        ["plant"],
        ["plant", "check"],
        ["params"],
        ["rules"],
        ["rules", "convert"],
        ["law"],
        ["law", "make"],
        ["law", "rules"],
    ],
)
def test_help_is_on_stdout(quiesce, command) -> None:
    result = quiesce(*command, "--help")
    assert result.returncode == 0
    assert result.stdout.startswith("usage: quiesce")
    assert result.stderr == ""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupt_ends_in_one_line_without_output(build: Path, tmp_path: Path, number) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "quiesce", "hil", "--target", "host", "--out", "out"],
        cwd=tmp_path,
        env={"PYTHONPATH": str(ROOT / "tools/src"), "QUIESCE_BUILD": str(build), "PATH": "/bin"},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert process.stderr.readline().startswith("[")
    process.send_signal(number)
    out, err = process.communicate(timeout=60)
    with pytest.raises(ProcessLookupError):  # none of its processes stays behind
        os.killpg(process.pid, 0)
    assert process.returncode == 130
    assert out == ""
    assert err.splitlines()[-1] == "quiesce: interrupted; nothing was written"
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("words", [["params"], ["--help"], ["hil", "--help"]])
def test_full_disk_of_standard_output_is_one_line(build: Path, tmp_path: Path, words) -> None:
    with Path("/dev/full").open("w") as full:
        result = subprocess.run(
            [sys.executable, "-m", "quiesce", *words],
            cwd=tmp_path,
            env={
                "PYTHONPATH": str(ROOT / "tools/src"),
                "QUIESCE_BUILD": str(build),
                "PATH": "/bin",
            },
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
        )
    assert result.returncode == 2
    assert "standard output" in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_reader_that_goes_away_leaves_no_trace(build: Path, tmp_path: Path) -> None:
    command = f"{shlex.quote(sys.executable)} -m quiesce params | true"
    result = subprocess.run(
        ["/bin/bash", "-c", command],
        cwd=tmp_path,
        env={"PYTHONPATH": str(ROOT / "tools/src"), "QUIESCE_BUILD": str(build), "PATH": "/bin"},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert result.stderr == ""
