"""Malformed rule files: each is refused with the exact place, in one line, with exit code 2."""

from pathlib import Path

import pytest
from conftest import run_quiesce
from quiesce.cli.main import main
from quiesce.rules.formats.files import read_text
from rule_faults import FCL_CASES, FIS_CASES, FLL_CASES, Edits
from rule_files import FCL, FIS, TEXTS

CASES = [
    pytest.param(format, edits, words, id=f"{format} {number} {words}")
    for format, cases in (("fcl", FCL_CASES), ("fll", FLL_CASES), ("fis", FIS_CASES))
    for number, (edits, words) in enumerate(cases)
]


def edited(format: str, edits: Edits) -> tuple[str, str]:
    """The text without its mark, and `LINE:COLUMN` of it."""
    text = TEXTS[format]
    for old, new in edits:
        assert old in text
        text = text.replace(old, new, 1)
    before, after = text.split("@")
    column = len(before) - (before.rfind("\n") + 1) + 1
    return before + after, f"{before.count(chr(10)) + 1}:{column}"


def compared(capsys, file: Path) -> str:
    """Message of a command that asks for a plain rule base, and must fail."""
    assert main(["rules", "diff", str(file), str(file)]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert len(printed.err.splitlines()) == 1
    return printed.err


@pytest.mark.parametrize(("format", "edits", "words"), CASES)
def test_malformed_file_is_refused(capsys, monkeypatch, tmp_path: Path, format, edits, words):
    text, place = edited(format, edits)
    file = tmp_path / f"bad.{format}"
    file.write_bytes(text.encode())
    monkeypatch.chdir(tmp_path)
    message = compared(capsys, Path(file.name))
    assert message.startswith(f"quiesce: bad.{format}:{place}: "), message
    assert words in message


@pytest.mark.parametrize("format", TEXTS)
def test_good_file_is_not_refused(capsys, tmp_path: Path, format: str) -> None:
    file = tmp_path / f"good.{format}"
    file.write_text(TEXTS[format])
    assert main(["rules", "convert", str(file), "--to", "fcl"]) == 0
    assert read_text(capsys.readouterr().out, "fcl", "x").name == "tank"


@pytest.mark.parametrize("format", TEXTS)
def test_bytes_that_are_no_text_are_placed(capsys, tmp_path: Path, format: str) -> None:
    file = tmp_path / f"bad.{format}"
    file.write_bytes(TEXTS[format].replace("0.125", "\xff", 1).encode("latin-1"))
    before = TEXTS[format].split("0.125")[0]
    column = len(before) - before.rfind("\n")
    assert f"{before.count(chr(10)) + 1}:{column}: not UTF-8" in compared(capsys, file)


@pytest.mark.parametrize("format", TEXTS)
def test_file_beyond_a_mebibyte_is_refused(capsys, tmp_path: Path, format: str) -> None:
    comment = {"fcl": "// ", "fll": "# ", "fis": "% "}[format]
    file = tmp_path / f"big.{format}"
    file.write_text(TEXTS[format] + comment + "x" * (1 << 20) + "\n")
    assert "1:1: the file is larger than 1 MiB" in compared(capsys, file)


def test_too_many_rules_are_refused(capsys, tmp_path: Path) -> None:
    rule = FIS.splitlines()[-1] + "\n"
    file = tmp_path / "many.fis"
    file.write_text(FIS.replace("NumRules=2", "NumRules=1025") + rule * 1023)
    assert "many.fis:1:2: 1025 rules, expected at most 1024" in compared(capsys, file)


def test_expression_that_splits_into_too_many_rules_is_refused(capsys, tmp_path: Path) -> None:
    choice = "(level IS low OR level IS high OR flow IS inward OR flow IS outward)"
    negated = choice.replace("IS ", "IS NOT ")
    text = FCL.replace("SUM", "MAX").replace(
        "RULE 1 : IF", f"RULE 1 : IF {choice} AND {negated} AND"
    )
    file = tmp_path / "split.fcl"
    file.write_text(text)
    assert main(["rules", "convert", str(file), "--to", "fcl"]) == 0
    capsys.readouterr()
    many = " AND ".join(f"({' OR '.join(f'level IS t{i} OR level IS NOT t{i}' for i in range(7))})"
                        for _ in range(5))  # fmt: skip
    terms = "\n".join(f"TERM t{i} := (0, 1) (5, 0);" for i in range(5))
    file.write_text(
        text.replace("TERM low", terms + "\nTERM low").replace(choice, many)
        .replace("t5", "low").replace("t6", "high")
    )  # fmt: skip
    assert ":36:17: more than 1024 rules once split" in compared(capsys, file)


def test_whole_command_ends_in_one_line_and_exit_code_2(tmp_path: Path) -> None:
    for format in TEXTS:
        (tmp_path / f"bad.{format}").write_text(TEXTS[format].replace("0.125", "1e999"))
        result = run_quiesce(tmp_path, "rules", "convert", f"bad.{format}", "--to", "fcl")
        assert (result.returncode, result.stdout) == (2, "")
        assert len(result.stderr.splitlines()) == 1
        assert result.stderr.startswith(f"quiesce: bad.{format}:")
        assert "number '1e999'" in result.stderr
