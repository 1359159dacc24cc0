"""Set-up takes the headers of FMI from fmpy, and no others."""

import shutil
from pathlib import Path

import pytest
from conftest import ROOT
from script_clone import Clone

SETUP = "common python fmi"
IS_COMPLETE = "fmi_is_complete build/deps/fmi && echo complete"


@pytest.fixture
def scripts(tmp_path: Path) -> Clone:
    clone = Clone(tmp_path)
    python = clone.root / ".venv/bin/python"
    python.parent.mkdir(parents=True)
    python.write_text("#!/bin/bash\necho site\n")
    python.chmod(0o755)
    return clone


def test_headers_are_copied_once_whole(scripts: Clone) -> None:
    shutil.copytree(ROOT / "build/deps/fmi", scripts.root / "site/fmpy/c-code")
    assert scripts.function(SETUP, "fmi_setup").returncode == 0
    assert scripts.function(SETUP, IS_COMPLETE).stdout == "complete\n"
    shutil.rmtree(scripts.root / "site")
    assert scripts.function(SETUP, "fmi_setup").returncode == 0


def test_other_headers_are_refused(scripts: Clone) -> None:
    shutil.copytree(ROOT / "build/deps/fmi", scripts.root / "site/fmpy/c-code")
    (scripts.root / "site/fmpy/c-code/fmi2Functions.h").write_text("another")
    result = scripts.function(SETUP, "fmi_setup")
    assert result.returncode == 2
    assert "are not the expected ones" in result.stderr.splitlines()[-1]


def test_missing_headers_are_told(scripts: Clone) -> None:
    result = scripts.function(SETUP, "fmi_setup")
    assert result.returncode == 2
    assert "remove .venv and run again" in result.stderr.splitlines()[-1]
