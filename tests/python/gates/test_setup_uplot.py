"""Set-up of uPlot refuses what is not the archive, and says how else to get it."""

import shutil
from pathlib import Path

import pytest
from conftest import ROOT
from script_clone import Clone

SETUP = "common packages uplot"
IS_COMPLETE = "uplot_is_complete build/deps/uplot && echo complete"


@pytest.fixture
def scripts(tmp_path: Path) -> Clone:
    return Clone(tmp_path)


def test_wrong_archive_is_refused_and_leaves_nothing(scripts: Clone, tmp_path: Path) -> None:
    archive = tmp_path / "uplot.tgz"
    archive.write_bytes(b"not the archive")
    result = scripts.function(SETUP, "uplot_setup", QUIESCE_UPLOT_ARCHIVE=str(archive))
    assert result.returncode == 2
    assert "refused: its sha256 is" in result.stderr.splitlines()[-1]
    assert list((scripts.root / "build/deps").iterdir()) == []


def test_archive_that_cannot_be_had_is_told(scripts: Clone) -> None:
    result = scripts.function(SETUP, "uplot_setup", QUIESCE_UPLOT_ARCHIVE="/none.tgz")
    assert result.returncode == 2 and "cannot read /none.tgz" in result.stderr.splitlines()[-1]
    scripts.fake("npm", "echo 'npm error network'; exit 1")
    last = scripts.function(SETUP, "uplot_setup").stderr.splitlines()[-1]
    assert "could not fetch uplot-1.6.32.tgz" in last and "QUIESCE_UPLOT_ARCHIVE=" in last
    assert list((scripts.root / "build/deps").iterdir()) == []


def test_complete_is_what_has_the_right_contents(scripts: Clone) -> None:
    folder = scripts.root / "build/deps/uplot"
    shutil.copytree(ROOT / "build/deps/uplot", folder)
    assert scripts.function(SETUP, IS_COMPLETE).stdout == "complete\n"
    (folder / "uPlot.min.css").write_text("another")
    assert scripts.function(SETUP, IS_COMPLETE).stdout == ""
