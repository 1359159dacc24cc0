"""`./tools/test all` fails on a benchmark's new misses, and never hides a known one."""

import sys
from typing import Any

from conftest import ROOT

sys.path.insert(0, str(ROOT / "tools/check"))

from benchmark import judge, known_misses  # noqa: E402


def figure(name: str, value: float | None, **changes: Any) -> dict[str, Any]:
    is_ok = None if value is None else value <= 1.0
    return {"name": name, "value": value, "goal": 1.0, "better": "lower", "ok": is_ok, **changes}


def test_goals_that_are_met_are_good() -> None:
    assert judge([figure("a", 0.5), figure("b", 7.0, goal=None, ok=None)], {}) == (
        True,
        ["figures: 1 met, 0 known misses, 0 new misses, 0 not judged"],
    )


def test_a_new_miss_fails() -> None:
    is_good, lines = judge([figure("a", 1.5)], {"b": 2.0})
    assert not is_good
    assert lines[0] == "MISSED: a 1.5, goal 1.0"


def test_a_known_miss_is_said_and_may_not_get_worse() -> None:
    is_good, lines = judge([figure("a", 1.5)], {"a": 1.6})
    assert is_good
    assert lines[0] == "known miss: a 1.5, goal 1.0"
    assert lines[-1] == "figures: 0 met, 1 known misses, 0 new misses, 0 not judged"
    is_good, lines = judge([figure("a", 1.7)], {"a": 1.6})
    assert not is_good
    assert lines[0] == "MISSED: a 1.7, goal 1.0, reached 1.6 before"


def test_better_higher_is_read_the_other_way() -> None:
    one = figure("a", 0.8, goal=0.9, better="higher", ok=False)
    assert judge([one], {"a": 0.79})[0]
    assert not judge([one], {"a": 0.81})[0]


def test_what_cannot_be_judged_here_is_said() -> None:
    is_good, lines = judge([figure("a", None)], {})
    assert is_good
    assert lines == [
        "not judged: a",
        "figures: 0 met, 0 known misses, 0 new misses, 1 not judged",
    ]


def test_times_of_a_machine_do_not_fail() -> None:
    assert judge([figure("a", 9.0, gated=False)], {})[0]


def test_a_known_miss_that_is_met_is_said() -> None:
    is_good, lines = judge([figure("a", 0.5)], {"a": 1.6})
    assert is_good
    assert lines[0].startswith("met by now, take it off")


def test_the_committed_list_is_read() -> None:
    assert known_misses("control")["step_5_10_settle_s"] == 0.637
    assert known_misses("none") == {}
