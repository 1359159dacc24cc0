"""The figures on pages are those of the committed results: each kind of slip is found."""

import json
import shutil
from pathlib import Path

import pytest
from conftest import ROOT
from quiesce_benchmarks.house.committed import load
from quiesce_benchmarks.house.pages import figures_inconsistent, fill


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A copy of README and docs/."""
    shutil.copy(ROOT / "README.md", tmp_path)
    shutil.copytree(ROOT / "docs", tmp_path / "docs", ignore=shutil.ignore_patterns("*.svg"))
    return tmp_path


def edit(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))


def test_pages_agree_with_the_committed_results(tree: Path) -> None:
    assert figures_inconsistent(ROOT) == []
    assert figures_inconsistent(tree) == []


def test_a_wrong_figure_is_found(tree: Path) -> None:
    edit(tree / "README.md", "hil.tick_worst -->", "hil.tick_worst -->1")
    (found,) = figures_inconsistent(tree)
    assert found.startswith("README.md:") and "hil.tick_worst" in found


def test_a_wrong_table_is_found(tree: Path) -> None:
    edit(tree / "docs/results/closed-loop.md", "| best constant current |", "| best current |")
    (found,) = figures_inconsistent(tree)
    assert found.startswith("docs/results/closed-loop.md:") and "table reductions hil" in found


def test_a_figure_without_a_mark_is_found_in_readme(tree: Path) -> None:
    edit(tree / "README.md", "## Limits\n", "## Limits\n\nIt takes 17.5 % off.\n")
    (found,) = figures_inconsistent(tree)
    assert "17.5 has no mark" in found


def test_another_figure_for_a_tick_is_found_on_any_page(tree: Path) -> None:
    with (tree / "docs/explanation/controller.md").open("a") as page:
        page.write("\nThe worst tick takes 3,921 instructions.\n")
    (found,) = figures_inconsistent(tree)
    assert found.startswith("docs/explanation/controller.md:") and "3,921" in found


def test_a_mark_without_a_result_is_found(tree: Path) -> None:
    edit(tree / "README.md", "hil.tick_worst", "hil.tick_best")
    (found,) = figures_inconsistent(tree)
    assert "no committed result says hil.tick_best" in found


def test_new_results_make_pages_stale_until_they_are_written(tree: Path) -> None:
    file = tree / "docs/results/signal.json"
    result = json.loads(file.read_text())
    next(f for f in result["figures"] if f["name"] == "tick_worst_instr")["value"] = 2999
    file.write_text(json.dumps(result))
    stale = {line.split(":")[0] for line in figures_inconsistent(tree)}
    assert stale == {"docs/results/closed-loop.md", "docs/results/signal.md"}
    for name in stale:
        page = tree / name
        page.write_text(fill(page.read_text(), load(tree)))
    assert figures_inconsistent(tree) == []
