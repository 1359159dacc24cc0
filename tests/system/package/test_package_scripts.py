"""The scripts behind the packages on a machine that lacks something."""

import os
import shutil
from pathlib import Path

from conftest import ROOT, Result, run


def without_root(folder: Path, code: str) -> Result:
    """Runs code with the scripts' functions, as a user without sudo, in a copy of the scripts."""
    shutil.copytree(ROOT / "tools/lib", folder / "a clone/tools/lib")
    (folder / "id").write_text("#!/bin/sh\necho 1000\n")
    (folder / "sudo").write_text("#!/bin/sh\nexit 1\n")
    for name in ("id", "sudo"):
        (folder / name).chmod(0o755)
    sources = "; ".join(f"source tools/lib/{name}.sh" for name in ("common", "packages", "package"))
    return run(
        "bash", "-c", f"PROGRAM=here; {sources}; {code}",
        cwd=folder / "a clone", env={"PATH": f"{folder}:{os.environ['PATH']}"},
    )  # fmt: skip


def assert_asks_for_root(result: Result) -> None:
    assert result.returncode == 2
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    assert line.startswith("here: ")
    assert "run as root" in line


def test_fetching_a_root_says_that_it_needs_root(tmp_path: Path) -> None:
    assert_asks_for_root(without_root(tmp_path, "root_of amd64"))
    assert not (tmp_path / "a clone/build").exists()


def test_configuring_a_root_says_that_it_needs_root(tmp_path: Path) -> None:
    assert_asks_for_root(without_root(tmp_path, "root_configure amd64"))


def test_roots_that_are_there_need_no_root(tmp_path: Path) -> None:
    made = 'mkdir -p "$CLEAN_ROOTS/root-$name" && root_stamp >"$CLEAN_ROOTS/root-$name/.fetched"'
    both = f"for name in amd64 service; do {made}; done"
    result = without_root(tmp_path, f"{both}; root_of amd64; root_service")
    assert (result.returncode, result.stderr) == (0, "")


def test_folder_to_build_in_has_no_space_and_goes(tmp_path: Path) -> None:
    made = 'source tools/lib/work.sh; work_folder; printf "%s\\n" "$WORK_FOLDER"'
    code = made + '; [ -d "$WORK_FOLDER" ]'
    for parent in (tmp_path, tmp_path / "two words"):
        parent.mkdir(exist_ok=True)
        result = run(
            "bash", "-c", f"PROGRAM=here; source tools/lib/common.sh; {code}",
            cwd=ROOT, env={"PATH": os.environ["PATH"], "TMPDIR": str(parent)},
        )  # fmt: skip
        assert result.returncode == 0, result.stderr
        assert " " not in result.stdout
        assert not Path(result.stdout.strip()).exists()
