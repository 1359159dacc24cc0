"""Malformed and contradictory board files: exit code 2, one line that names file and key."""

from pathlib import Path

import pytest
from quiesce.cli.main import main
from quiesce.engine.bench import Bench
from quiesce_benchmarks.controller.boards import CASES, GOOD, refused, spoilt


@pytest.fixture(autouse=True)
def bench(build: Path, monkeypatch: pytest.MonkeyPatch) -> Bench:
    monkeypatch.setenv("QUIESCE_BUILD", str(build))
    return Bench()


def test_there_are_enough_cases_with_names_of_their_own() -> None:
    names = [name for name, _, _ in CASES]
    assert len(names) == len(set(names)) >= 120


def test_the_board_that_is_spoilt_is_good(capsys) -> None:
    assert main(["board", "check", str(GOOD)]) == 0
    assert capsys.readouterr().out == f"{GOOD}: ok: every_key, 5 sensors, 2 bodies, 2 dampers\n"


@pytest.mark.parametrize(("edit", "expected"), [case[1:] for case in CASES],
                         ids=[case[0] for case in CASES])  # fmt: skip
def test_mistake_is_answered_in_one_line(capsys, tmp_path: Path, edit, expected) -> None:
    file = tmp_path / "board.toml"
    file.write_bytes(spoilt(GOOD.read_bytes(), edit))
    assert main(["board", "check", str(file)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert err.startswith(f"quiesce: {file}:")
    assert expected in err


def test_all_are_counted_as_refused(bench: Bench) -> None:
    tried, in_one_line = refused(bench)
    assert tried == in_one_line == len(CASES) + 2


def test_an_answer_that_is_not_the_expected_one_is_not_counted(bench: Bench, monkeypatch) -> None:
    edits = [
        ("accepted", ("max_lost_pct = 40", "max_lost_pct = 41"), "max_lost_pct"),
        ("other_words", ("max_lost_pct = 40", "max_lost_pct = 101"), "no such words"),
    ]
    monkeypatch.setattr("quiesce_benchmarks.controller.boards.CASES", edits)
    assert refused(bench) == (4, 2)
