"""Images compiled from the sources: the same in any folder, with a user's tables inside."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT
from quiesce.table.file import read_words
from quiesce.table.words import crc_of

BOARD = "nucleo_f446re"
pytestmark = pytest.mark.slow


def copied(folder: Path) -> Path:
    """The project's files, without what is built of them."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    )  # fmt: skip
    for name in listed.stdout.split("\0"):
        if name and not name.startswith(("docs/", "tests/python/")) and (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / name)
    return folder


def quiesce(root: Path, *words: str | Path) -> str:
    environment = {
        **os.environ, "QUIESCE_ROOT": str(root), "QUIESCE_BUILD": str(root / "build"),
        "PYTHONPATH": str(root / "tools/src"), "CCACHE_DISABLE": "1",
    }  # fmt: skip
    done = subprocess.run(
        [sys.executable, "-m", "quiesce", *map(str, words)],
        env=environment, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_two_folders_give_the_same_files(tmp_path: Path) -> None:
    sums = []
    for name in ("one", "another_place/of_the_same"):
        root = copied(tmp_path / name)
        quiesce(root, "firmware", "build", BOARD)
        sums.append((root / f"build/firmware/{BOARD}/SHA256SUMS").read_text())
    assert sums[0] == sums[1]
    assert len(sums[0].splitlines()) == 12


def test_a_user_s_rules_are_linked_in(tmp_path: Path) -> None:
    root, made = copied(tmp_path / "project"), tmp_path / "made"
    rules = ROOT / "firmware/plants/squeeze_2012/rules.fcl"
    quiesce(root, "rules", "compile", rules, "--controller", "--out", made)
    (table,) = made.glob("*.table")
    said = quiesce(root, "firmware", "build", BOARD, "--table", table)
    assert "rules" in said
    image = root / f"build/firmware/{BOARD}/quiesce_{BOARD}-0.1.0.bin"
    (linked,) = json.loads(quiesce(root, "firmware", "info", image, "--json"))["tables"]
    words = read_words(table)
    assert linked == {"kind": "rules", "words": len(words), "crc": crc_of(words)}
