"""Rows of the papers: complete, placed, typed as they can be; what is malformed gets one line."""

import re
from pathlib import Path

import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce_benchmarks.house.committed import Committed
from quiesce_benchmarks.papers import parts
from quiesce_benchmarks.papers.commands import refused
from quiesce_benchmarks.papers.page import KEY, paper_table, published_text, where
from quiesce_benchmarks.papers.page import ours_text as ours
from quiesce_benchmarks.papers.parts import rows as rows_part
from quiesce_benchmarks.papers.rows import (
    KINDS,
    Paper,
    Row,
    missing,
    papers,
    positions,
    read,
    without_place,
)
from quiesce_benchmarks.part import Effort, all_parts

# Counted in the papers: equations, tables, figures.
COUNTED = {
    "s0_squeeze": (24, 11, 14),
    "s1_self_tuning": (27, 4, 22),
    "s2_review": (41, 1, 7),
    "s3_elastomer": (38, 1, 10),
    "s4_thesis": (43, 18, 33),
}
HEAD = 'paper = "A paper"\nequations = ["1-3"]\n'
GOOD = """
[[row]]
kind = "equation"
number = "1-2"
what = "two of them"
places = ["a.h:force"]

[[row]]
kind = "equation"
number = "3"
what = "another"
reason = "a definition"
"""
NOTHING = Committed({})


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "paper.toml"


@pytest.mark.parametrize("name", COUNTED)
def test_a_row_whose_command_measures_says_what_comes_out(name: str) -> None:
    silent = [
        f"{row.kind} {row.number}: {row.what}"
        for row in papers()[name].rows
        if row.part and not row.ours
    ]
    assert silent == []


@pytest.mark.parametrize("name", COUNTED)
def test_every_number_of_a_paper_has_a_row_and_no_other_has_one(name: str) -> None:
    paper = papers()[name]
    for kind, count in zip(KINDS, COUNTED[name], strict=True):
        declared = [one for text in paper.ranges[kind] for one in positions(text, name)]
        texts = [row.number for row in paper.rows if row.kind == kind]
        held = {one for text in texts for one in positions(text, name)}
        assert len(declared) == len(set(declared)) == count
        assert held == set(declared)


def test_there_are_five_papers() -> None:
    assert list(papers()) == list(COUNTED)


@pytest.mark.parametrize("name", COUNTED)
def test_every_place_that_a_row_names_exists(name: str) -> None:
    places = [place for row in papers()[name].rows for place in row.places]
    assert places
    assert [why for place in places if (why := missing(place, ROOT))] == []


@pytest.mark.parametrize("name", COUNTED)
def test_every_command_is_accepted_where_its_part_is_there(name: str) -> None:
    measured = all_parts(parts)
    rows = [row for row in papers()[name].rows if row.command or row.part in measured]
    assert [why for row in rows if row.typed and (why := refused(row.typed, ROOT))] == []


def test_a_good_file_is_read(file: Path) -> None:
    file.write_text(HEAD + GOOD)
    paper = read(file)
    assert (paper.name, paper.title) == ("paper", "A paper")
    assert paper.rows[0] == Row("equation", "1-2", "two of them", ("a.h:force",))
    assert paper.rows[1].reason == "a definition"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('kind = "equation"\nnumber = "3"', 'number = "3"', "row 2 (None 3): kind is missing"),
        ('kind = "equation"\nnumber = "3"', 'kind = "song"\nnumber = "3"', "row 2 (song 3): kind:"),
        ('number = "3"', 'number = "three"', "row 2 (equation three): number: 'three'"),
        ('number = "3"', 'number = "3-1"', "row 2 (equation 3-1): number: 3-1"),
        ('number = "3"', 'number = "1-2-3"', "row 2 (equation 1-2-3): number:"),
        ('number = "3"', 'number = "2.1-3.2"', "row 2 (equation 2.1-3.2): number:"),
        ('number = "3"', "number = 3", "row 2 (equation 3): number: expected a text"),
        ('number = "3"', 'number = "4"', "paper.toml: equation 3 has no row"),
        ("1-3", "1-4", "paper.toml: equation 4 has no row"),
        ("1-3", "1-2", "paper.toml: equation 3 is not in the head"),
        ('["1-3"]', '"1-3"', "paper.toml: equations: expected a list of texts"),
        ('"two of them"', '""', "row 1 (equation 1-2): what: expected a text"),
        ('["a.h:force"]', '"a.h"', "row 1 (equation 1-2): places: expected a list"),
        ('["a.h:force"]', "[1]", "row 1 (equation 1-2): places: expected a list"),
        ('reason = "a definition"', "published = true", "row 2 (equation 3): published:"),
        ('reason = "a definition"', "published = []", "row 2 (equation 3): published:"),
        ('reason = "a definition"', 'published = ["1"]', "row 2 (equation 3): published:"),
        ('reason = "a definition"', 'raeson = "x"', "row 2 (equation 3): raeson: no such key"),
        ('paper = "A paper"', "paper = 1", "paper.toml: paper: expected a text"),
        ('paper = "A paper"', 'paper = "A"\nbooks = 1', "paper.toml: unknown key in the head"),
        ("[[row]]", "[[line]]", "paper.toml: unknown key in the head"),
        ("[[row]]", "[row", "paper.toml: "),
    ],
)
def test_what_is_malformed_is_named_on_one_line(file: Path, old: str, new: str, words: str) -> None:
    assert old in HEAD + GOOD
    file.write_text((HEAD + GOOD).replace(old, new))
    with pytest.raises(UsageError) as caught:
        read(file)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_a_file_without_rows_and_a_row_twice_are_named(file: Path) -> None:
    file.write_text(HEAD)
    with pytest.raises(UsageError, match="expected tables"):
        read(file)
    file.write_text(HEAD + GOOD + '[[row]]\nkind = "equation"\nnumber = "3"\nwhat = "another"\n')
    with pytest.raises(UsageError, match="equation 3 is there 2 times"):
        read(file)


def test_a_place_needs_its_file_and_its_symbol_as_a_word(tmp_path: Path) -> None:
    (tmp_path / "a.h").write_text("double force_N(double v);\n")
    (tmp_path / "b").mkdir()
    assert (
        missing("a.h", tmp_path) == missing("a.h:force_N", tmp_path) == missing("b", tmp_path) == ""
    )
    assert "holds no force" in missing("a.h:force", tmp_path)
    assert "no such file" in missing("c.h", tmp_path)
    assert "folder" in missing("b:force_N", tmp_path)


def test_a_row_without_place_counts_unless_it_has_a_reason(file: Path, tmp_path: Path) -> None:
    file.write_text(HEAD + GOOD)
    assert [row.number for row in without_place(read(file), tmp_path)] == ["1-2"]
    (tmp_path / "a.h").write_text("force")
    assert list(without_place(read(file), tmp_path)) == []


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("./tools/hil --scenario sine_5Hz --law fuzzy", ""),
        ("./tools/hil --part fuzzy", "--part: no such option"),
        ("./tools/quiesce identify FILE.csv --model bouc_wen --method ga", ""),
        ("./tools/quiesce identify FILE.csv --method luck", "--method luck: not one of"),
        ("./tools/quiesce identify FILE.csv --rates 1", "--rates: no such option"),
        ("./tools/quiesce identify compare MODEL.toml FILE.csv", ""),
        ("./tools/quiesce identify complain MODEL.toml", "no such command"),
        ("./tools/quiesce dance", "no such command"),
        ("./tools/quiesce plant check sim_hil/data/plants/none.toml", "none.toml: no such file"),
        ("./tools/quiesce sweep --out build/none.csv", ""),
        ("./tools/benchmark papers --part rows", ""),
        ("./tools/benchmark papers --part colours", "--part colours: not one of"),
        ("rm -r build", "rm: no program of the project"),
    ],
)
def test_a_command_is_refused_with_the_word_that_is_wrong(command: str, words: str) -> None:
    why = refused(command, ROOT)
    assert words in why and bool(why) == bool(words)


def results(reported: dict, *figures: tuple[str, float]) -> Committed:
    table = [{"name": name, "value": value} for name, value in figures]
    return Committed({"papers": {"figures": table, "context": {"reported": reported}}})


def row(**keys: object) -> Row:
    return Row("table", "1", "what", **keys)


def test_ours_stands_with_its_difference_from_as_many_published_numbers() -> None:
    found = results({"anfis": {"errors": [5.5, 4.0], "name": "x"}}, ("gain_pct", 22.9))
    one = row(published=26.4, ours="{papers.gain_pct:.1f} %")
    assert ours(one, found) == "22.9 (-3.5) %"
    many = row(published=(5.0, 4.25), ours="{papers.anfis.errors:.2f}")
    assert ours(many, found) == "5.50 (+0.50) / 4.00 (-0.25)"
    assert ours(row(published=(1.0, 2.0), ours="{papers.gain_pct:.1f}"), found) == "22.9"
    assert ours(row(published="some", ours="{papers.anfis.errors.1:.0f} of 4"), found) == "4 of 4"
    assert ours(row(ours="{papers.anfis.name}"), found) == "x"
    assert published_text(many) == "5 / 4.25" and published_text(one) == "26.4"


def test_what_is_not_recorded_is_told() -> None:
    found = results({"anfis": {"errors": [5.5]}, "left_out": {}})
    for key in ("papers.gain", "papers.anfis.errors.1", "papers.anfis.errors.x", "hil.none"):
        assert ours(row(ours=f"{{{key}}}"), found) == "not recorded yet"
    assert ours(row(part="left_out"), found) == ours(row(part="other"), found) == "not recorded yet"
    assert ours(row(part="anfis"), found) == ours(row(), found) == ""
    assert ours(row(ours="as printed"), NOTHING) == "as printed"


def test_where_is_a_link_a_reason_or_nothing_yet() -> None:
    assert where(row(places=("a/b.h:c", "d"))) == "[b.h](../../a/b.h) `c`, [d](../../d)"
    assert where(row(reason="a photograph")) == "a photograph"
    assert where(row(pending="a law")) == "**not yet**: a law"
    assert where(row()) == "**no place yet**"


def test_an_unknown_paper_is_a_mark_without_a_result() -> None:
    with pytest.raises(KeyError):
        paper_table("s9", NOTHING)


def test_the_part_counts_rows_places_and_commands(tmp_path: Path) -> None:
    found = rows_part.measure(Effort(1, True, tmp_path))
    all_rows = [(paper, one) for paper in papers().values() for one in paper.rows]
    waiting = [one for _, one in all_rows if one.pending]
    bare = [one for paper in papers().values() for one in without_place(paper, ROOT)]
    assert set(found.values) == {name for name, *_ in rows_part.FIGURES}
    assert found.values["rows"] == len(all_rows)
    assert found.values["rows_pending"] == len(waiting)
    assert found.values["rows_without_place"] == len(bare)
    assert found.values["commands_refused"] == 0
    listed = [label for labels in found.reported["without_place"].values() for label in labels]
    assert len(listed) == len(bare)
    assert all(re.fullmatch(r"(equation|table|figure) \S+", label) for label in listed)


def test_the_part_finds_what_is_wrong(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = (
        row(places=("none.h",)),
        row(places=("README.md",), command="./tools/quiesce dance"),
        row(pending="a law"),
        row(reason="a photograph"),
    )
    monkeypatch.setattr(rows_part, "papers", lambda: {"one": Paper("one", "One", {}, rows)})
    found = rows_part.measure(Effort(1, True, tmp_path))
    names = ("rows", "rows_without_place", "rows_pending", "commands_refused")
    assert [found.values[name] for name in names] == [4, 1, 1, 1]
    assert "no such file" in found.tables[0] and "no such command" in found.tables[0]


def test_figures_of_ours_are_named_with_their_result() -> None:
    """Without its file's name in front a figure is never found, however often it is recorded."""
    files = {file.stem for file in (ROOT / "docs/results").glob("*.json")}
    rows = [row for paper in papers().values() for row in paper.rows]
    keys = [key["key"] for row in rows for key in KEY.finditer(row.ours)]
    assert keys
    assert [key for key in keys if key.partition(".")[0] not in files] == []
