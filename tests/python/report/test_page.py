"""Pages and the pictures in them."""

import ast
import re
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import ROOT
from jinja2 import UndefinedError, meta
from quiesce.report.page import PAPER, environment, in_the_dark, inline, render
from quiesce.report.plot_style import COLORS, pyplot, svg_of

HOSTILE = '"><script>alert(1)</script>'


def picture(title: str = "", rasterized: bool = False) -> str:
    figure, axis = pyplot().subplots()
    axis.plot([1, 2], [3, 4], "o-", color=COLORS["main"], rasterized=rasterized)
    axis.set_title(title)
    return svg_of(figure)


def diff(name: str, *svgs: str) -> str:
    found = SimpleNamespace(one=SimpleNamespace(name=name), other=SimpleNamespace(name="b.fcl"))
    pictures = [(f"{name}{i}", svg) for i, svg in enumerate(svgs)]
    return render("rules/views/diff.html.j2", found=found, report=name, pictures=pictures)


def test_hostile_names_are_text() -> None:
    page = diff(HOSTILE, picture(HOSTILE))
    assert "<script" not in page and 'label="Output &#34;&gt;&lt;script' in page
    # Title, heading, report and, in text and label, two of a section.
    assert page.count("&lt;script&gt;alert(") >= 5


def test_what_a_template_wants_is_given_or_an_error() -> None:
    with pytest.raises(UndefinedError, match="'found' is undefined"):
        render("rules/views/diff.html.j2", report="", pictures=[])


def given(file: Path) -> dict[str, set[str]]:
    """By template, the names of what a module gives it."""
    calls = [node for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.Call)]
    return {
        call.args[0].value: {one.arg for one in call.keywords}
        for call in calls
        if getattr(call.func, "id", "") == "render"
    }


def test_each_page_is_given_what_its_template_wants_and_no_more() -> None:
    templates = environment()
    found = {}
    for file in (ROOT / "tools/src/quiesce").rglob("*.py"):
        found |= given(file)
    pages = [one for one in templates.list_templates(["j2"]) if not one.startswith("report/")]
    assert sorted(found) == sorted(pages) and len(pages) > 8
    for page in pages:
        source = templates.loader.get_source(templates, page)[0]
        wanted = meta.find_undeclared_variables(templates.parse(source))
        assert found[page] == wanted - set(templates.globals), page


def test_no_id_stands_twice_and_each_reference_has_its_own() -> None:
    page = diff("a", picture("one"), picture("two"), picture("three", rasterized=True))
    ids = re.findall(r' id="(.*?)"', page)
    assert len(ids) == len(set(ids))
    references = re.findall(r'url\(#(.*?)\)|href="#(.*?)"', page)
    assert len(references) >= 6 and {one or other for one, other in references} == set(ids)


def test_page_and_curves_know_dark_mode() -> None:
    page = diff("a", picture())
    assert "color-scheme: light dark" in page
    assert f"@media (prefers-color-scheme: dark) {{\n  :root {{ --paper: {PAPER}" in page
    blue = COLORS["main"][1:]
    assert f"var(--c{blue},#{blue})" in page and f"--c{blue}:{in_the_dark(blue)}" in page


def test_picture_with_an_image_keeps_its_colours() -> None:
    svg = inline(picture(rasterized=True))
    assert "<image" in svg and "var(" not in svg
    assert '<figure class="plot fixed">' in diff("a", picture(rasterized=True))


def test_greys_turn_round_in_the_dark_and_pale_colours_stay() -> None:
    assert in_the_dark("ffffff") == PAPER
    assert in_the_dark("000000") > in_the_dark("8a94a0") > in_the_dark("e3e6ea") > PAPER
    assert in_the_dark(COLORS["reference"][1:]) == COLORS["reference"]
