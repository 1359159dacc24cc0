"""What every bench has in common: goals, exit codes, JSON, table."""

import json
import math

import numpy as np
import pytest
from quiesce_benchmarks.report import Figure, Report, rounded


def report(*figures: Figure) -> Report:
    return Report("name", figures, {"trials": 3}, tables=["a table"], absent=["file: not here"])


MET = Figure("met", 1.0, "s", 2.0, "lower")
MISSED = Figure("missed", 1.0, "%", 2.0, "higher")
ABSENT = Figure("absent", None, "1", 2.0, "lower")
SLOW = Figure("slow", 9.0, "s", 2.0, "lower", is_gated=False)
UNTIMED = Figure("untimed", None, "s", 2.0, "lower", is_gated=False)
REPORTED = Figure("reported", 5.0, "1", None, "lower")
REPORTED_ABSENT = Figure("reported_absent", None, "1", None, "lower")


@pytest.mark.parametrize(
    ("value", "goal", "better", "is_ok"),
    [
        (1.0, 1.0, "lower", True),
        (1.0, 1.0, "higher", True),
        (1.1, 1.0, "lower", False),
        (0.9, 1.0, "higher", False),
        (math.nan, 1.0, "lower", False),
        (math.nan, 1.0, "higher", False),
        (None, 1.0, "lower", None),
        (1.0, None, "lower", None),
    ],
)
def test_goal_is_met_on_its_better_side(value, goal, better, is_ok) -> None:
    assert Figure("f", value, "1", goal, better).is_ok is is_ok


@pytest.mark.parametrize(
    ("figures", "code"),
    [
        ([MET, REPORTED, REPORTED_ABSENT], 0),
        ([MET, MISSED], 1),
        ([MET, ABSENT], 3),
        ([ABSENT, MISSED], 1),
        ([MET, SLOW, UNTIMED], 0),
    ],
)
def test_check_fails_on_a_missed_goal_before_an_absent_one(figures, code) -> None:
    assert report(*figures).exit_code(is_checked=True) == code
    assert report(*figures).exit_code(is_checked=False) == 0


def test_json_has_the_convention_s_keys() -> None:
    made = json.loads(json.dumps(report(MET, ABSENT, REPORTED).json_object()))
    assert made["bench"] == "name"
    assert [list(figure) for figure in made["figures"]] == [
        ["name", "value", "unit", "goal", "better", "ok"]
    ] * 3
    assert [figure["ok"] for figure in made["figures"]] == [True, None, None]
    slow = report(SLOW).json_object()["figures"][0]
    assert slow["ok"] is False and slow["gated"] is False
    assert made["context"] == {"trials": 3, "absent": ["file: not here"]}


def test_text_marks_each_goal() -> None:
    lines = report(MET, MISSED, ABSENT, REPORTED).text().splitlines()
    assert lines[2].split() == ["met", "1", "s", "<=", "2", "ok"]
    assert lines[3].split() == ["missed", "1", "%", ">=", "2", "MISSED"]
    assert lines[4].split() == ["absent", "absent", "<=", "2", "not", "judged"]
    assert lines[5].split() == ["reported", "5"]
    assert lines[-3:] == ["a table", "", "file: not here"]


def test_rounding_keeps_integers_and_drops_what_json_cannot_hold() -> None:
    given = {"a": [1, 123456789, 0.123456789, True, "x", None], "b": (math.inf, math.nan)}
    assert rounded(given) == {
        "a": [1, 123456789, 0.123457, True, "x", None],
        "b": [None, None],
    }
    assert json.dumps(rounded([np.float64(1.5), np.int64(7)])) == "[1.5, 7.0]"
