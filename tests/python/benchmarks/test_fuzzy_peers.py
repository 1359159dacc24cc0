"""The peers' programs on a few rule bases. Skipped where no benchmark has fetched them yet
(./tools/benchmarks/fetch_peers)."""

from pathlib import Path

import numpy as np
import pytest
from quiesce.base.errors import UsageError
from quiesce.rules.formats.files import write_text
from quiesce_benchmarks.fuzzy.agreement import UNEXPLAINED, explain, explain_skfuzzy, make_case
from quiesce_benchmarks.fuzzy.peers import (
    COUNT,
    FILES,
    FUZZYLITE,
    PYTHON,
    Job,
    built_peer,
    fuzzylite,
    pyfuzzylite,
    run_program,
    skfuzzy,
    skfuzzy_holds,
)
from quiesce_benchmarks.fuzzy.random import random_base
from quiesce_benchmarks.fuzzy.reference import SUM, reference_base

CASES = [make_case(random_base(5, number), 5, 60) for number in range(6)]


@pytest.fixture
def peer(build: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("QUIESCE_BUILD", str(build))

    def need(name: str) -> None:
        if not (build / FILES[name]).is_file():
            pytest.skip(f"run ./tools/benchmarks/fetch_peers {name} for this test")

    return need


def test_libfuzzylite_agrees_or_is_explained(peer) -> None:
    peer(FUZZYLITE)
    for case in CASES:
        answer = fuzzylite(Job(write_text(case.base, "fll"), case.points, 500))
        assert UNEXPLAINED not in explain(case, "libfuzzylite", answer, 500).differing


def test_pyfuzzylite_agrees_or_is_explained(peer) -> None:
    peer(PYTHON)
    answers = pyfuzzylite([Job(write_text(case.base, "fll"), case.points, 500) for case in CASES])
    for case, answer in zip(CASES, answers, strict=True):
        assert isinstance(answer, np.ndarray), answer
        assert UNEXPLAINED not in explain(case, "pyfuzzylite", answer, 500).differing


def test_scikit_fuzzy_follows_the_exact_centroid(peer) -> None:
    peer(PYTHON)
    case = make_case(random_base(1, 29), 1, 10)
    assert skfuzzy_holds(case.base) == ""
    (answer,) = skfuzzy([Job(case.base, case.points, 1000)])
    assert isinstance(answer, np.ndarray), answer
    assert UNEXPLAINED not in explain_skfuzzy(case, answer).differing


def test_what_a_peer_refuses_is_one_line(peer) -> None:
    peer(FUZZYLITE)
    peer(PYTHON)
    points = np.zeros((1, 2))
    with pytest.raises(UsageError, match="fuzzylite_peer: ") as refused:
        fuzzylite(Job("Engine: e\nInputVariable: x\n  term: a Nothing 1\n", points))
    assert "\n" not in str(refused.value)
    good = Job(write_text(reference_base(SUM), "fll"), points)
    answers = pyfuzzylite([Job("Nonsense: 1\n", points), good])
    assert isinstance(answers[0], str) and isinstance(answers[1], np.ndarray)


def test_counter_refuses_what_is_no_library(peer) -> None:
    peer(COUNT)
    with pytest.raises(UsageError, match="call_points: "):
        run_program([built_peer(COUNT), "/dev/null", "f", "/dev/null", "1"])
