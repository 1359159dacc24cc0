"""The page of hazards: each says all that it has to, and names tests that exist."""

import re

import pytest
from conftest import ROOT
from quiesce_benchmarks.trust.named_tests import missing

PAGE = "docs/explanation/hazards.md"
PARTS = ("Goal", "Answer", "Shown by", "Yours", "Left")
TEST = re.compile(r"`(tests/[\w/.]+::[\w.]+)`")


def hazards() -> dict[str, str]:
    sections = (ROOT / PAGE).read_text().split("\n## ")[1:]
    return {title: text for title, _, text in (one.partition("\n") for one in sections)}


@pytest.mark.parametrize("title", hazards())
def test_each_hazard_says_all_that_it_has_to(title: str) -> None:
    text = hazards()[title]
    assert re.findall(r"^- \*\*([\w ]+)\*\*: ", text, re.MULTILINE) == list(PARTS)
    assert "Severity: " in " ".join(text.split())


@pytest.mark.parametrize("title", hazards())
def test_each_hazard_has_tests_that_exist(title: str) -> None:
    tests = TEST.findall(hazards()[title])
    assert tests
    assert missing(tests, ROOT) == []


def test_nothing_else_looks_like_a_test() -> None:
    text = (ROOT / PAGE).read_text()
    assert len(TEST.findall(text)) == text.count("::")
