"""`quiesce rules check`: the walk over a rule base's integers, built where it lies."""

from pathlib import Path

import pytest
from conftest import ROOT
from quiesce.cli.main import main

PUBLISHED = ROOT / "firmware/plants/squeeze_2012/rules.fcl"


def test_the_shipped_rules_are_walked(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["rules", "check", str(PUBLISHED), "--quick"]) == 0
    out = capsys.readouterr().out
    assert "the sanitizer saw none" in out
    assert out.splitlines()[-1].split() == ["result", "ok"]


def test_a_folder_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["rules", "check", str(tmp_path)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
