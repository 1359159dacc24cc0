"""Straight-line C of systems on the target: the same answers as on this machine, within the goals,
and orders that are no good."""

from dataclasses import replace
from pathlib import Path

import pytest
from conftest import require
from quiesce.base.errors import BenchFailure, UsageError
from quiesce.engine.bench import Bench
from quiesce_benchmarks.fuzzy import straight
from quiesce_benchmarks.fuzzy.straight import (
    PRODUCT,
    STRAIGHTS,
    SUGENO,
    SUGENO_MIN,
    StraightCost,
    StraightVariant,
    measure_straight,
    straight_table,
    worst_of,
)
from quiesce_benchmarks.images import count

STEPS = 30
GOALS = {PRODUCT: 75, SUGENO: 90, SUGENO_MIN: 90}
COST = StraightCost(SUGENO, "q15", 1234, 45, 40, 39.1, 2276, 12)


@pytest.fixture(scope="module")
def bench(build: Path) -> Bench:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("QUIESCE_BUILD", str(build))
        return Bench()


@pytest.fixture(scope="module")
def image(build: Path) -> Path:
    return require(build / "mps2/tools/benchmarks/straight_cost.elf")


@pytest.mark.parametrize("variant", STRAIGHTS, ids=lambda one: one.name)
def test_target_answers_as_this_machine_within_the_goal(bench, image, variant) -> None:
    cost = measure_straight(bench, image, variant, STEPS)
    assert cost.evaluations > (STEPS + 1) ** 2
    assert 1 < cost.mean_instr <= cost.worst_instr < GOALS.get(variant.kind, 200)
    assert cost.code_bytes > 100 and cost.stack_bytes < 256


def test_an_answer_that_differs_is_told(bench, image, monkeypatch) -> None:
    right = straight.sum_here
    monkeypatch.setattr(straight, "sum_here", lambda *of: right(*of) ^ 1)
    with pytest.raises(BenchFailure, match="answers otherwise than this machine"):
        measure_straight(bench, image, STRAIGHTS[0], 4)


@pytest.mark.parametrize(
    "order", [(len(STRAIGHTS), 4, 1, 1, 0, 0), (0, 0, 1, 1, 0, 0), (0, 3000, 1, 1, 0, 0)]
)
def test_order_that_is_no_good_is_refused(bench, image, order) -> None:
    with pytest.raises(UsageError, match="refused"):
        count(bench, image, *order)


def test_every_kind_is_compiled_from_a_file_of_the_command() -> None:
    for one in STRAIGHTS:
        assert one.compiled.system.name == "reference"
        assert [len(v.terms) for v in one.compiled.system.inputs] == [4, 4]
        assert len(one.compiled.system.rules) == 16


def test_worst_is_over_the_kinds_that_are_asked_for() -> None:
    costs = [COST, replace(COST, kind=SUGENO_MIN, worst_instr=79), replace(COST, kind=PRODUCT)]
    assert worst_of(costs, [SUGENO, SUGENO_MIN]) == 79
    assert worst_of(costs, [PRODUCT]) == 45
    assert worst_of([], [PRODUCT]) is None


def test_table_names_what_was_measured() -> None:
    text = straight_table([COST])
    assert "straight lines, product, q15" in text and "2,276" in text and "39.1" in text
    assert StraightVariant(SUGENO, "q15").name == "straight_sugeno_q15"
