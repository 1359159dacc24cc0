"""docs/howto/run-your-own-rig.md: its files are good, its commands run, and say what it shows."""

import re
import shlex
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT, run_quiesce

PAGE = (ROOT / "docs/howto/run-your-own-rig.md").read_text()
BLOCK = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)
FILES = {"plant.toml", "board.toml", "scenario.toml"}
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


def blocks(kind: str) -> list[str]:
    return [text for found, text in BLOCK.findall(PAGE) if found == kind]


def commands() -> list[list[str]]:
    """What is typed, as words of `quiesce`; `awk` is none."""
    lines = "\n".join(blocks("sh")).replace("\\\n", " ").splitlines()
    words = [shlex.split(line, comments=True) for line in lines if line.startswith("../tools/")]
    return [["hil", *w[1:]] if w[0] == "../tools/hil" else w[1:] for w in words]


@pytest.fixture(scope="module")
def said(build: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Output of every command of the page, run in order in one folder, by its first word."""
    folder = tmp_path_factory.mktemp("mine")
    for text in blocks("toml"):
        (folder / text.split()[1].rstrip(":")).write_text(text)
    assert {file.name for file in folder.iterdir()} == FILES
    (shake,) = (text for text in blocks("sh") if text.startswith("awk"))
    subprocess.run(["sh", "-c", shake], cwd=folder, check=True, timeout=60)
    out = {}
    for words in commands():
        result = run_quiesce(folder, *words)
        assert result.returncode == 0, result.stderr
        out[words[0]] = result.stdout
    return out


def same_line(shown: str, found: str) -> bool:
    """The same words; numbers within 1 %, or one of their last digit."""
    if NUMBER.sub("#", shown).split() != NUMBER.sub("#", found).split():
        return False
    pairs = zip(NUMBER.findall(shown), NUMBER.findall(found), strict=True)
    return all(
        float(a) == pytest.approx(float(b), rel=0.01, abs=1.01 * 10 ** -len(a.partition(".")[2]))
        for a, b in pairs
    )


def assert_shown(shown: str, found: str) -> None:
    lines = found.strip().splitlines()
    for line in shown.strip().splitlines():
        assert any(same_line(line, one) for one in lines), line


def test_commands_are_those_of_a_user() -> None:
    assert [words[0] for words in commands()] == ["plant", "board", "hil", "record", "replay"]


def test_closed_loop_says_what_the_page_shows(said: dict[str, str]) -> None:
    shown, _ = blocks("text")
    assert "instrument  phase, balanced" in shown
    assert_shown(shown, said["hil"])


def test_replay_says_what_the_page_shows(said: dict[str, str]) -> None:
    _, shown = blocks("text")
    assert "damper     outer" in shown
    assert_shown(shown, said["record"] + said["replay"])


def test_another_word_or_number_would_be_found() -> None:
    assert same_line("a  100.0 um", "a 100.9 um")
    assert not same_line("a  100.0 um", "a 102.0 um")
    assert not same_line("a  100.0 um", "b 100.0 um")
