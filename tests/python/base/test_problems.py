"""All that is wrong with one file in one message, its place said once."""

import pytest
from quiesce.base.errors import Problems, UsageError


def refused(*messages: str) -> str:
    problems = Problems()
    for message in messages:
        with problems.told():
            raise UsageError(message)
    with pytest.raises(UsageError) as caught:
        problems.refuse()
    return str(caught.value)


def test_nothing_wrong_is_no_refusal() -> None:
    problems = Problems()
    with problems.told():
        pass
    problems.refuse()


def test_one_problem_stands_as_it_is() -> None:
    assert refused("my.csv:1: a: b") == "my.csv:1: a: b"


def test_the_place_is_said_once_and_the_same_problem_once() -> None:
    assert refused("my.csv:1: column a", "my.csv:1: column b") == "my.csv:1: column a | column b"
    assert refused("my.csv:1: same", "my.csv:1: same") == "my.csv:1: same"
    assert refused("'a' is none", "'b' is none") == "'a' is none | 'b' is none"


def test_another_failure_passes() -> None:
    with pytest.raises(ValueError), Problems().told():
        raise ValueError
