"""The page of the papers: every row is on it, and its tables follow rows and committed results."""

import json
from pathlib import Path

import pytest
from conftest import ROOT
from quiesce_benchmarks.house.committed import load
from quiesce_benchmarks.house.pages import fill, stale_marks
from quiesce_benchmarks.papers.page import NAMES, paper_table
from quiesce_benchmarks.papers.rows import papers

PAGE = ROOT / "docs/results/papers.md"


@pytest.mark.parametrize("name", papers())
def test_a_paper_has_its_table_with_every_row(name: str) -> None:
    _, _, rest = PAGE.read_text().partition(f"<!--= table paper {name} -->\n")
    lines = rest.partition("<!--/-->")[0].splitlines()[2:]
    rows = papers()[name].rows
    assert [line.split(" | ")[0] for line in lines] == [
        f"| {NAMES[row.kind]} {row.number}" for row in rows
    ]


def test_lines_have_as_many_columns_as_the_head() -> None:
    for name in (*papers(), "summary"):
        head, *lines = paper_table(name, load(ROOT)).splitlines()
        columns = {line.replace("\\|", "").count("|") for line in lines}
        assert columns == {head.count("|")}


def test_new_results_of_a_part_make_the_page_stale_until_it_is_written(tmp_path: Path) -> None:
    (tmp_path / "docs/results").mkdir(parents=True)
    for file in (ROOT / "docs/results").glob("*.json"):
        (tmp_path / "docs/results" / file.name).write_text(file.read_text())
    figure = {"name": "selftune_gated_10Hz_pct", "value": 12.25}
    other = {"name": "selftune_gated_20Hz_pct", "value": 27.0}
    result = {"figures": [figure, other], "context": {"reported": {}}}
    (tmp_path / "docs/results/papers.json").write_text(json.dumps(result))
    text = PAGE.read_text()
    stale = [words for _, words in stale_marks(text, load(tmp_path))]
    assert any("table paper s0_squeeze" in words for words in stale)
    filled = fill(text, load(tmp_path))
    assert "12.2 (-14.1) / 27.0 (-1.0)" in filled
    assert list(stale_marks(filled, load(tmp_path))) == []
