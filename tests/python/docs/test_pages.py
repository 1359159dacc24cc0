"""README and docs/: links lead somewhere, paths exist, every page is in the index."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import ROOT
from quiesce_benchmarks.house.pages import pages
from quiesce_benchmarks.house.readme import FENCED, readme_numbers, readme_words

LINK = re.compile(r"\]\(([^)\s]+)\)")
NAMED_LINK = re.compile(r"\[([\w-]+\.md)\]\(([^)\s#]+)")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
TOPS = "cmake|docs|examples|firmware|hal|sim_hil|targets|tests|tools"
PATH = re.compile(rf"(?<![\w/.$<-])(?:\./)?((?:{TOPS})/[\w./*-]*[\w*/])(?![\w<])")
PLACEHOLDER = re.compile(r"NAME|RIG|/test_$")


def anchors(text: str) -> set[str]:
    """As the sites that show Markdown make them of headings."""
    kept = (re.sub(r"[^\w\- ]", "", heading.lower()) for heading in HEADING.findall(text))
    return {heading.strip().replace(" ", "-") for heading in kept}


def broken_links(page: Path, root: Path = ROOT) -> Iterator[str]:
    text = FENCED.sub("", page.read_text())
    for link in LINK.findall(text):
        if "://" in link:
            continue
        name, _, anchor = link.partition("#")
        target = page.parent / name if name else page
        if not target.exists():
            yield f"{page.relative_to(root)}: {link}"
        elif anchor and anchor not in anchors(target.read_text()):
            yield f"{page.relative_to(root)}: no heading {link}"


def missing_paths(text: str, root: Path = ROOT) -> Iterator[str]:
    for path in PATH.findall(text):
        if not PLACEHOLDER.search(path) and not any(root.glob(path.rstrip("/"))):
            yield path


def test_links_lead_somewhere() -> None:
    assert [line for page in pages(ROOT) for line in broken_links(page)] == []


def test_links_that_show_a_file_name_show_the_right_one() -> None:
    found = [pair for page in pages(ROOT) for pair in NAMED_LINK.findall(page.read_text())]
    assert [(name, to) for name, to in found if Path(to).name != name] == []
    assert found


def test_a_broken_link_and_a_missing_path_are_found(tmp_path: Path) -> None:
    (tmp_path / "b.md").write_text("# One heading\n")
    page = tmp_path / "a.md"
    page.write_text("[a](b.md) [b](b.md#one-heading) [c](c.md) [d](b.md#two)\n")
    assert list(broken_links(page, tmp_path)) == ["a.md: c.md", "a.md: no heading b.md#two"]
    (tmp_path / "tools").mkdir()
    (tmp_path / "tools/hil").touch()
    text = "`tools/hil`, `./tools/none.py`, `docs/*.md`"
    assert list(missing_paths(text, tmp_path)) == ["tools/none.py", "docs/*.md"]


@pytest.mark.parametrize("page", pages(ROOT), ids=lambda page: str(page.relative_to(ROOT)))
def test_paths_of_the_project_exist(page: Path) -> None:
    assert list(missing_paths(page.read_text())) == []


@pytest.mark.parametrize("page", pages(ROOT), ids=lambda page: str(page.relative_to(ROOT)))
def test_no_line_of_prose_begins_with_a_mark(page: Path) -> None:
    """There Markdown would end the paragraph and take the line for HTML."""
    assert re.findall(r"^ *<!--= (?!table ).*$", page.read_text(), re.MULTILINE) == []


def test_the_index_has_every_page() -> None:
    index = ROOT / "docs/index.md"
    listed = {(index.parent / link).resolve() for link in LINK.findall(index.read_text())}
    assert set(pages(ROOT)) - {index} == listed


def test_what_counts_as_a_word_and_a_number() -> None:
    text = (
        "# Two words\n\nIt is C11 <!-- not 5 -->and [7 Hz](docs/8.md).\n\n```sh\nno 9\n```\n| - |\n"
    )
    assert readme_words(text) == 8
    assert readme_numbers(text) == 2


def test_readme_is_short() -> None:
    text = (ROOT / "README.md").read_text()
    assert readme_words(text) <= 900
    assert readme_numbers(text) <= 25
