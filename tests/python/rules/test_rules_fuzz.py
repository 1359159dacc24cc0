"""The mutation fuzzer of the rule files: its promises hold, and it would tell if they did not."""

import pytest
from fuzz_rules import Finding, check, fuzz
from quiesce.base.errors import UsageError
from quiesce.rules.formats import fll, scan, write_fll
from quiesce.rules.formats.files import FORMATS, read_text
from rule_files import FLL, TEXTS

MUTANTS = 3000
ENDS = ("read", "refused")


@pytest.mark.slow
@pytest.mark.parametrize("format", FORMATS)
def test_mutants_are_refused_or_read_for_what_they_say(format: str) -> None:
    counts = fuzz(format, MUTANTS, seed=4)
    assert sum(counts.values()) == MUTANTS
    # The mutants reach all outcomes.
    assert min(counts[f"{kind}, {end}"] for kind in ("changed", "mutated") for end in ENDS) > 50


@pytest.mark.parametrize("format", FORMATS)
def test_fuzzer_finds_a_change_without_effect(format: str) -> None:
    text = TEXTS[format]
    with pytest.raises(Finding, match="makes no difference"):
        check(text, format, read_text(text, format, "tank"))


def test_fuzzer_finds_an_exception(monkeypatch) -> None:
    monkeypatch.setattr(scan.Source, "number", lambda *_: 1 / 0)
    with pytest.raises(Finding, match="ZeroDivisionError"):
        check(FLL, "fll")


def test_fuzzer_finds_a_message_without_a_place(monkeypatch) -> None:
    monkeypatch.setattr(scan.Source, "error", lambda self, *words: UsageError("something is wrong"))
    with pytest.raises(Finding, match="without a place"):
        check(FLL[:100], "fll")


def test_fuzzer_finds_what_writing_loses(monkeypatch) -> None:
    monkeypatch.setattr(write_fll, "number_text", lambda value: f"{value:.1f}")
    with pytest.raises(Finding, match="not written and read again"):
        check(FLL, "fll")


def test_fuzzer_finds_a_key_that_is_ignored(monkeypatch) -> None:
    monkeypatch.setattr(fll.FllReader, "default", lambda self, variable, line: None)
    base = read_text(FLL, "fll", "tank")
    with pytest.raises(Finding, match="makes no difference"):
        check(FLL.replace("default: 0.500", "default: 0.250"), "fll", base)
