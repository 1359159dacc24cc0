"""What the command line says of itself, and of names that there are not."""

import pytest
from quiesce.cli.main import COMMANDS, GROUPS, main


def said(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    code = main(list(words))
    out, err = capsys.readouterr()
    return code, out, err


def test_help_has_every_command_in_its_group(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = said(capsys, "--help")
    assert code == 0
    assert said(capsys, "help") == (0, out, "")
    lines = out.splitlines()
    for title, group in GROUPS.items():
        first = lines.index(title) + 1
        assert [line.split()[0] for line in lines[first : first + len(group)]] == [
            name for name, _, _ in group
        ]
    assert len({name for name, _, _ in COMMANDS}) == 23


def test_help_of_a_command_is_its_own(capsys: pytest.CaptureFixture[str]) -> None:
    assert said(capsys, "help", "table", "check") == said(capsys, "table", "check", "--help")


def test_both_ways_to_ask_for_the_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert said(capsys, "-v") == said(capsys, "--version")


@pytest.mark.parametrize(
    ("words", "near"),
    [
        ("ruels check x", "rules"),
        ("rules chek x", "check"),
        ("params --jsno", "--json"),
        ("replay x --column a --unit mps2", "m_s2"),
        ("replay x --column a --unti g", "--unit"),
        ("law make skyhok --board x -o y", "skyhook"),
        ("new plant p --mass 1 --freq 2 --damper rd1005_kwok_tan --drive base:1Hz,1g", "rd1005"),
        ("compare --rig quarter_cra --road C:72", "quarter_car"),
    ],
)
def test_names_that_are_nearly_right_are_told(
    words: str, near: str, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, err = said(capsys, *words.split())
    assert (code, out) == (2, "")
    assert len(err.splitlines()) == 1
    assert f"did you mean '{near}" in err


def test_what_is_like_nothing_is_refused_without_a_guess(
    capsys: pytest.CaptureFixture[str],
) -> None:
    code, _, err = said(capsys, "xyzzy")
    assert code == 2
    assert "did you mean" not in err
