"""The controller does what it did: golden traces, and the command that compares them."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT, Result, require

GOLDEN = ROOT / "tests/golden"


def call_golden(build: Path, recorded: Path) -> Result:
    scenarios = ROOT / "sim_hil/data/scenarios"
    call = [
        *(sys.executable, GOLDEN / "golden.py", "check", "--json", "--recorded", recorded),
        *("--bench", require(next((build / "host").rglob("quiesce_bench")))),
        *("--streams", require(build / "host/tests/golden/golden_streams")),
        *("--scenarios", scenarios if scenarios.is_dir() else ROOT / "sim_hil/scenarios"),
    ]
    return subprocess.run(list(map(str, call)), capture_output=True, text=True)


def changed(recorded: str, start: str, word: int) -> str:
    """The recording with another word in the line that starts so."""
    lines = recorded.splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith(start))
    words = lines[at].split()
    words[word] = f"{int(words[word], 16) ^ 1:08X}"
    lines[at] = " ".join(words)
    return "\n".join(lines)


def test_nothing_differs(build: Path) -> None:
    result = call_golden(build, GOLDEN / "golden.txt")
    found = json.loads(result.stdout)
    assert (found["differing"], found["differing_by_plant"], found["first"]) == (0, 0, None)
    assert found["words"] > 10_000
    assert result.returncode == 0


@pytest.mark.slow
@pytest.mark.parametrize("case", ["streams/storm_07", "loops/sine_10Hz/fuzzy"])
def test_a_block_that_differs_is_named(build: Path, tmp_path: Path, case: str) -> None:
    columns = (GOLDEN / "golden.txt").read_text().splitlines()[1].split()[1:]
    if case.startswith("loops/"):
        columns = columns[2:]  # the reply's own are not in a trace
    text = changed((GOLDEN / "golden.txt").read_text(), f"{case} out", 2 + 3)
    recorded = tmp_path / "golden.txt"
    recorded.write_text(changed(text, f"{case} col", 2 + columns.index("fault_count")))
    result = call_golden(build, recorded)
    found = json.loads(result.stdout)
    assert result.returncode == 1
    assert found["differing"] == 2
    assert found["first"] == {"case": case, "ticks": [3000, 3999], "columns": ["fault_count"]}


@pytest.mark.slow
def test_a_plant_that_differs_is_told_apart(build: Path, tmp_path: Path) -> None:
    recorded = tmp_path / "golden.txt"
    recorded.write_text(
        changed((GOLDEN / "golden.txt").read_text(), "loops/sine_10Hz/constant in", 2)
    )
    result = call_golden(build, recorded)
    found = json.loads(result.stdout)
    assert result.returncode == 1
    assert (found["differing"], found["differing_by_plant"]) == (0, 1)
    assert found["plants"] == ["sine_10Hz"]


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["check", "no_such_commit"], "no commit 'no_such_commit'"),
        (["check", "--output=x"], "unknown option"),
        (["record"], "record needs a commit"),
        (["compare"], "check or record"),
        ([], "check or record"),
        (["check", "HEAD", "HEAD"], "one commit at most"),
    ],
)
def test_bad_input_is_one_line(arguments: list[str], reason: str) -> None:
    result = subprocess.run(
        [str(ROOT / "tools/golden"), *arguments], capture_output=True, text=True
    )
    assert result.returncode == 2
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    assert reason in result.stderr


def test_a_recording_that_cannot_be_read_is_one_line(build: Path, tmp_path: Path) -> None:
    result = call_golden(build, tmp_path / "none.txt")
    assert result.returncode == 2
    assert result.stderr.startswith("golden: ")
    assert len(result.stderr.splitlines()) == 1
