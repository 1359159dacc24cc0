"""What `./tools/test all` takes for the inputs of a step: what it reads, and nothing else."""

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import ROOT

Hash = Callable[[str], str]
COPIED = ("tools", "firmware", "tests/python/gates/house", "tests/unit", "hal")


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A repository with what the hashes are of."""
    root = tmp_path_factory.mktemp("stamps") / "tree"
    for name in COPIED:
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
    (root / ".venv").mkdir()
    (root / ".venv/bin").symlink_to(ROOT / ".venv/bin")
    (root / ".venv/.complete").write_text("")
    (root / ".gitignore").write_text(".venv\nbuild\n")
    subprocess.run(["git", "init", "-q"], cwd=root, check=True)
    return root


@pytest.fixture
def hash_of(tree: Path) -> Hash:
    code = 'ROOT="$PWD"; source tools/lib/stamps.sh; inputs_hash "$0"'

    def run(step: str) -> str:
        command = ["bash", "-c", code, step]
        done = subprocess.run(command, cwd=tree, capture_output=True, text=True, check=True)
        assert len(done.stdout.strip()) == 64, done.stderr
        return done.stdout.strip()

    return run


def changed(tree: Path, hash_of: Hash, file: str, *steps: str) -> dict[str, bool]:
    """Of each step whether an edit of the file makes it run again."""
    before = {step: hash_of(step) for step in steps}
    path = tree / file
    text = path.read_text()
    path.write_text(text + "\n")
    after = {step: hash_of(step) for step in steps}
    path.write_text(text)
    return {step: before[step] != after[step] for step in steps}


PACKAGE, BENCHMARKS = "tools/src/quiesce", "tools/benchmarks/quiesce_benchmarks"
# A file, the steps that an edit of it makes run again, and some that are kept.
EDITS = {
    "firmware/chain/controller.c": ("bench-lock bench-fuzzy ctest-host tidy", ""),
    f"{PACKAGE}/rules/formats/t2fis.py": ("bench-fuzzy bench-tables", "bench-signal ctest-host"),
    f"{PACKAGE}/live/viewer.py": ("bench-live", "bench-lock bench-fuzzy bench-sweep"),
    f"{PACKAGE}/base/table.py": ("bench-lock bench-signal bench-fuzzy", "ctest-host"),
    f"{BENCHMARKS}/lock/parts/tones.py": ("bench-lock", "bench-signal bench-tables"),
    f"{BENCHMARKS}/signal/records.py": ("bench-signal bench-lock", "bench-fuzzy"),
    "tools/benchmarks/mps2/fuzzylite/CMakeLists.txt": ("bench-fuzzy", "bench-lock ctest-mps2"),
    "tools/benchmarks/known_misses.toml": ("bench-lock", ""),
    "tools/lib/steps.sh": ("bench-lock ctest-host", ""),
}


@pytest.mark.parametrize("file", EDITS)
def test_an_edit_runs_again_what_reads_the_file(tree: Path, hash_of: Hash, file: str) -> None:
    again, kept = (words.split() for words in EDITS[file])
    expected = dict.fromkeys(again, True) | dict.fromkeys(kept, False)
    assert changed(tree, hash_of, file, *again, *kept) == expected
