"""What `./tools/benchmark fuzzy` makes of rule files of other projects."""

from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce_benchmarks.fuzzy.foreign import (
    MOST_BYTES,
    Made,
    Tried,
    compiled_pct,
    foreign_table,
    gaussian_bytes,
    judge,
    listed,
    make,
    worst_error_pct,
)

GAUSSIANS = ROOT / "tests/unit/firmware/systems/gaussians.fll"
TRIED = [
    Tried("small", 800, 0.02, "pyfuzzylite", ""),
    Tried("exact", 2000, 0.05, "float64", ""),
    Tried("large", MOST_BYTES + 4, 0.5, "float64", ""),
    Tried("refused", 0, None, "", "no rules"),
]


def test_what_is_refused_or_too_large_does_not_count() -> None:
    assert compiled_pct(TRIED) == 50.0
    assert worst_error_pct(TRIED) == 0.05
    printed = foreign_table(TRIED)
    assert "2 of 4 compile" in printed and "1 compared with pyfuzzylite" in printed
    assert "a table of 8196 bytes" in printed and "no rules" in printed


def test_list_names_each_file_by_its_hash() -> None:
    names = listed()
    assert len(names) == 145
    assert all(len(Path(file).stem) == 16 and int(Path(file).stem, 16) for file in names)


def test_a_file_is_judged_by_what_the_peer_answers() -> None:
    made = make("gaussians", GAUSSIANS)
    assert isinstance(made, Made)
    alone = judge(made, None)
    assert alone.against == "float64" and alone.error_pct < 0.1 and alone.is_compiled
    compiled = made.precise.compiled
    low, high = compiled.system.outputs[0].minimum, compiled.system.outputs[0].maximum
    wrong = judge(made, np.full((made.x.shape[1], 1), low - (high - low)))
    assert wrong.against == "pyfuzzylite" and wrong.error_pct > 100.0
    assert judge(made, "SyntaxError: no").against == "float64"


def test_a_file_that_is_no_system_says_why(tmp_path: Path) -> None:
    file = tmp_path / "bad.fll"
    file.write_text(GAUSSIANS.read_text().replace("range: 0.000 25.000", "range: 0 0"))
    found = make("bad", file)
    assert isinstance(found, Tried) and "minimum < maximum" in found.refused


def test_gaussian_controller_fits() -> None:
    assert 1000 < gaussian_bytes() <= 8192


@pytest.mark.slow
def test_files_of_other_projects_are_those_listed() -> None:
    folder = ROOT / "build/deps/foreign/files"
    if not folder.is_dir():
        pytest.skip("not fetched: tools/benchmarks/fetch_peers foreign")
    assert {one.name for one in folder.iterdir()} == set(listed())
