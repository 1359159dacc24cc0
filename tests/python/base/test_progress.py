"""What is said while a large file is read."""

import pytest
from quiesce.base import progress


def test_a_long_reading_tells_how_far_it_is(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(progress, "READING_EVERY_s", 0.0)
    count = 3 * progress._READING_LOOKS
    assert list(progress.reading("my.csv", range(count), count)) == list(range(count))
    said = capsys.readouterr().err.splitlines()
    assert [line.split(",")[0] for line in said] == [
        "reading my.csv: 33 %",
        "reading my.csv: 66 %",
        "reading my.csv: 100 %",
    ]


def test_a_short_reading_says_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert list(progress.reading("my.csv", "abc", 3)) == ["a", "b", "c"]
    assert capsys.readouterr().err == ""
