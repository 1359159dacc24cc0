"""The engine for any system on the target: what a table costs, and tables that are refused."""

from pathlib import Path

import pytest
from conftest import require
from quiesce.base.errors import UsageError
from quiesce.engine.bench import Bench
from quiesce.rules.system.compile import CompiledSystem, compile_system
from quiesce_benchmarks.fuzzy import systems
from quiesce_benchmarks.fuzzy.systems import (
    GAUSSIAN,
    MAMDANI,
    SUGENO,
    SystemCost,
    figure_names,
    mamdani,
    measure_system,
    system_table,
    worst_of_system,
)
from quiesce_benchmarks.images import count


@pytest.fixture(scope="module")
def bench(build: Path) -> Bench:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("QUIESCE_BUILD", str(build))
        return Bench()


@pytest.fixture(scope="module")
def image(build: Path) -> Path:
    return require(build / "mps2/tools/benchmarks/system_cost.elf")


@pytest.fixture(scope="module")
def compiled() -> dict[str, CompiledSystem]:
    return {name: compile_system(system) for name, (_, system) in systems.systems().items()}


def test_a_centroid_costs_by_its_places(bench, image, compiled, monkeypatch) -> None:
    monkeypatch.setattr(systems, "EVALUATIONS", 20)
    few, more = (
        measure_system(bench, image, "m", "", compile_system(mamdani(n))) for n in (50, 100)
    )
    assert 1.5 * few.mean_instr < more.mean_instr < 2.5 * few.mean_instr
    assert few.worst_instr >= few.mean_instr and few.table_bytes == more.table_bytes
    assert few.code_bytes > 1000 and 1000 < few.stack_bytes < 2048


def test_counts_repeat_exactly(bench, image, compiled, monkeypatch) -> None:
    monkeypatch.setattr(systems, "EVALUATIONS", 50)
    first, again = (measure_system(bench, image, SUGENO, "", compiled[SUGENO]) for _ in range(2))
    assert first == again and first.worst_instr > 1000


def test_a_damaged_table_is_refused(bench, image, compiled) -> None:
    words = list(compiled[GAUSSIAN].words)
    words[20] ^= 1
    with pytest.raises(UsageError, match="refused"):
        count(bench, image, 10, len(words), *words)
    with pytest.raises(UsageError, match="refused"):
        count(bench, image, 0, len(words), *compiled[GAUSSIAN].words)


def test_figures_are_of_the_systems_that_are_measured(compiled) -> None:
    assert list(figure_names()) == list(compiled)
    assert figure_names()[f"{MAMDANI}_100"] == "system_mamdani_100_instr"
    cost = SystemCost(SUGENO, "straight lines", 5068, 4806.0, 4224, 1364, 1544)
    assert worst_of_system([cost], SUGENO) == 5068 and worst_of_system([], SUGENO) is None
    assert "5,068" in system_table([cost]) and "1,544" in system_table([cost])
