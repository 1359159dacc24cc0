"""Instructions of the fuzzy engines: counted on the image, and what is made of the counts."""

from pathlib import Path

import pytest
from conftest import require
from quiesce.base.errors import UsageError
from quiesce.engine.bench import Bench
from quiesce.rules.integers.compile import compile_base
from quiesce.rules.integers.table import table_words
from quiesce_benchmarks.fuzzy import cost as fuzzy_cost
from quiesce_benchmarks.fuzzy.cost import EngineCost, PeerCost
from quiesce_benchmarks.fuzzy.random import random_base
from quiesce_benchmarks.fuzzy.reference import CENTROID, MAX, Q15, VARIANTS, Variant, compiled
from quiesce_benchmarks.fuzzy.tables import engine_table, peer_table
from quiesce_benchmarks.images import count

STEPS = 40


@pytest.fixture(scope="module")
def bench(build: Path) -> Bench:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("QUIESCE_BUILD", str(build))
        return Bench()


@pytest.fixture(scope="module")
def image(build: Path) -> Path:
    return require(build / "mps2/tools/benchmarks/fuzzy_cost.elf")


@pytest.mark.parametrize("kind", ["table", "straight"])
@pytest.mark.parametrize("variant", VARIANTS, ids=lambda one: one.name)
def test_both_engines_agree_on_the_target_and_repeat_exactly(bench, image, variant, kind) -> None:
    cost = fuzzy_cost.measure_engine(bench, image, variant, kind, STEPS)
    cells = [len(axis) for axis in compiled(variant).cells]
    assert cost.evaluations > (STEPS + 1) ** 2 + 4 * cells[0] * cells[1]
    assert 1 < cost.mean_instr <= cost.worst_instr
    assert cost.median_instr <= cost.worst_instr
    assert cost.code_bytes > 100 and cost.stack_bytes < 4096
    assert (cost.table_bytes == 4 * len(table_words(compiled(variant)))) == (kind == "table")
    assert fuzzy_cost.measure_engine(bench, image, variant, kind, STEPS) == cost


def test_more_points_find_no_less(bench: Bench, image: Path) -> None:
    variant = Variant(MAX, Q15)
    few, many = (
        fuzzy_cost.measure_engine(bench, image, variant, "straight", steps) for steps in (8, 160)
    )
    assert few.evaluations < many.evaluations and few.worst_instr <= many.worst_instr


def test_table_that_is_given_is_evaluated(bench: Bench, image: Path) -> None:
    small, large = (
        fuzzy_cost.measure_table(bench, image, compile_base(random_base(1, number).base), 300)
        for number in (12, 28)  # 12 and 64 rules, no straight-line form
    )
    assert 0 < small.mean_instr <= small.worst_instr < large.worst_instr
    assert small.table_bytes < large.table_bytes and large.stack_bytes < 4096


def test_damaged_table_is_refused(bench: Bench, image: Path) -> None:
    words = list(table_words(compile_base(random_base(1, 12).base)))
    words[20] ^= 1
    with pytest.raises(UsageError, match="refused"):
        count(bench, image, len(VARIANTS), 0, 10, 32768, 32768, len(words), *words)


@pytest.mark.parametrize("order", [(len(VARIANTS) + 1, 0, 10, 1, 1), (0, 0, 0, 1, 1)])
def test_order_that_is_no_good_is_refused(bench: Bench, image: Path, order) -> None:
    with pytest.raises(UsageError, match="refused"):
        count(bench, image, *order)


ENGINES = [
    EngineCost(Variant(MAX, Q15), "straight", 10, 50, 40, 41.5, 1500, 0, 16),
    EngineCost(Variant(CENTROID, Q15), "straight", 10, 100, 80, 81.0, 6000, 0, 24),
    EngineCost(Variant(MAX, Q15), "table", 10, 115, 100, 101.0, 5000, 1100, 24),
]
PEERS = [
    PeerCost(0, 1000, 11000, 9000, 10000.0, 600_000, 1400),
    PeerCost(100, 1000, 70000, 50000, 60000.0, 600_000, 1400),
]


def test_tables_name_every_engine_and_the_ratio_to_ours() -> None:
    text = engine_table(ENGINES)
    assert "straight, max, q15" in text and "table, max, q15" in text and "6,000" in text
    lines = peer_table(PEERS, ENGINES).splitlines()[2:]
    assert [line.split()[-3] for line in lines] == ["200", "600"]
    assert "-" in peer_table(PEERS, []).splitlines()[-1]


def test_row_is_json_of_names() -> None:
    row = ENGINES[0].row()
    assert row["variant"] == "reference_max_q15" and row["worst_instr"] == 50
