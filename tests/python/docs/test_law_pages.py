"""A page for each published law: tools/gen/law_pages.py."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT
from quiesce.law.recipes import RECIPES, find

SCRIPT = ROOT / "tools/gen/law_pages.py"


@pytest.fixture(scope="module")
def pages():
    spec = importlib.util.spec_from_file_location("law_pages", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    sys.modules["law_pages"] = module
    spec.loader.exec_module(module)
    return module


REPORTED = {
    "cost": {
        "costs": {
            "add": {
                "law": "signs", "signals": ["acceleration of body 1"], "rig": "building",
                "tracker": "", "tick_worst_instr": 4000, "own_worst_instr": 200,
                "own_mean_instr": 150.4, "state_bytes": 2, "table_words": 30,
            }
        }
    },
    "unseen": {
        "laws": {
            "add": {"index_tuned": 0.9, "index_best_constant": 0.95, "index_passive_off": 1.4},
            "add, other": {
                "index_tuned": 0.8, "index_best_constant": 0.95, "index_passive_off": 1.4,
            },
        }
    },
    "unseen_road": {
        "laws": {
            "add": {
                "comfort": {"tuned": 1.1, "best_constant": 1.0, "passive_off": 1.2},
                "tyre": {"tuned": 0.3, "best_constant": 0.2, "passive_off": 0.3},
            }
        }
    },
    "cantilever": {
        "rows": {
            "add": {"score_pct": 10.0},
            "best constant, 5 A": {"score_pct": 14.0},
            "fuzzy_selftune_printed": {"score_pct": 15.0},
        }
    },
}  # fmt: skip


def test_committed_pages_are_what_it_writes() -> None:
    result = subprocess.run([sys.executable, SCRIPT, "--check"], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr


def test_every_recipe_has_a_page_that_the_index_names() -> None:
    index = (ROOT / "docs/index.md").read_text()
    for recipe in RECIPES:
        assert (ROOT / f"docs/reference/laws/{recipe.name}.md").exists()
        assert f"(reference/laws/{recipe.name}.md)" in index


def test_a_page_says_what_it_costs_and_where_it_wins(pages) -> None:
    text = pages.page(pages.of_recipe(find("add"), REPORTED), REPORTED)
    assert "4000 instructions" in text and "acceleration of body 1" in text
    assert "| 0.800 | 0.950 | 1.400 |" in text  # with the better of its trackers
    assert "| 1.100 | 1.000 | 1.200 |" in text
    assert text.count("\n- ") == 1 and "\n- building of 1996" in text


def test_a_law_that_wins_nowhere_is_told(pages) -> None:
    lost = {key: REPORTED[key] for key in ("cost", "unseen_road", "cantilever")}
    text = pages.page(pages.of_recipe(find("add"), lost), lost)
    assert "on **none** of these" in text


def test_more_reduction_is_better(pages) -> None:
    cells = pages.on_cantilever("fuzzy_selftune", REPORTED)
    assert [cell.is_won for cell in cells] == [True]
    assert [cell.is_won for cell in pages.on_cantilever("add", REPORTED)] == [False]


def test_without_results_it_says_so(pages) -> None:
    text = pages.page(pages.of_recipe(find("add"), {}), {})
    assert "Not recorded yet." in text and "nothing is claimed of it" in text


def test_a_page_too_many_and_one_that_differs_are_found(pages, tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "tools/gen").mkdir(parents=True)
    (tmp_path / "tools/gen/laws.toml").write_bytes((ROOT / "tools/gen/laws.toml").read_bytes())
    (tmp_path / "docs/index.md").write_text("<!-- laws: here -->\nOLD LINE\n<!-- end -->\n")
    files = pages.written(tmp_path)
    assert len(files) == len(RECIPES) + 6 + 1
    assert "OLD LINE" not in files[pages.INDEX] and "add.md" in files[pages.INDEX]
