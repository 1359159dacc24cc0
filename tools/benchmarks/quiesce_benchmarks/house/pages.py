"""Figures on pages come from committed results, and from nowhere else.

    <!--= hil.tick_worst -->4,118<!--/-->             a figure (committed.py), as the page shows it
    <!--= hil.step.phase.amp .1f -->26.2<!--/-->      ... with a format of Python's
    <!--= table figures signal -->...<!--/-->         a table

tools/gen/results.py writes what stands between the marks.
"""

import re
from collections.abc import Iterator
from pathlib import Path

from quiesce_benchmarks.house.committed import Committed, load
from quiesce_benchmarks.house.readme import COMMENT, FENCED, LINK_TARGET
from quiesce_benchmarks.house.tables import table

MARK = re.compile(r"<!--= (?P<name>[^>]+?) -->(?P<text>.*?)<!--/-->", re.DOTALL)
CODE = re.compile(r"`[^`\n]*`")
# A number of its own: not part of a name (Cortex-M4, C11, x86-64, 24-bit), nor a step of a list.
BARE_NUMBER = re.compile(r"(?<![\w.,/-])-?\d[\d,]*(?:\.\d+)?(?![\w-]|\.\d)")
# What a number may be beside a measured figure: a setting, a version, an exit code.
NOT_MEASURED = re.compile(r"Debian \d+|\d[\d.]* k?Hz|exits \d")
# Lines of any page that tell what a tick costs; three pages once gave three figures.
TICK_COST = re.compile(r"worst tick|instructions a tick|a tick takes", re.IGNORECASE)
COUNT = re.compile(r"(?<![\w.,-])\d,?\d{3}(?![\w.,]*\d)")


def pages(root: Path) -> list[Path]:
    return [root / "README.md", *sorted((root / "docs").rglob("*.md"))]


def content(name: str, committed: Committed) -> str:
    """What the results say for a mark; KeyError where they say nothing."""
    if name.startswith("table "):
        return "\n" + table(name.removeprefix("table "), committed)
    figure, _, spec = name.partition(" ")
    value = committed.figures[figure]
    if not spec:
        spec = ",.0f" if float(value).is_integer() else ",.4g"
    return format(value, spec)


def fill(text: str, committed: Committed) -> str:
    """The page with what the results say between its marks."""

    def replaced(mark: re.Match[str]) -> str:
        return f"<!--= {mark['name']} -->{content(mark['name'], committed)}<!--/-->"

    return MARK.sub(replaced, text)


def stale_marks(text: str, committed: Committed) -> Iterator[tuple[int, str]]:
    """Where the text of a mark is not what the results say, with the line."""
    for mark in MARK.finditer(text):
        line = text.count("\n", 0, mark.start()) + 1
        try:
            right = content(mark["name"], committed)
        except (KeyError, ValueError):
            yield line, f"no committed result says {mark['name']}"
            continue
        if mark["text"] != right:
            shown = "the table" if mark["name"].startswith("table ") else mark["text"]
            yield line, f"{mark['name']}: {shown} is not what the committed result says"


def blanked(text: str, *patterns: re.Pattern[str]) -> str:
    """The text without what the patterns match; its lines keep their numbers."""
    for pattern in patterns:
        text = pattern.sub(lambda found: "\n" * found[0].count("\n"), text)
    return text


def unmarked_numbers(text: str) -> Iterator[tuple[int, str]]:
    """Numbers of a page that could be measured and have no mark."""
    bare = blanked(text, FENCED, MARK, COMMENT, LINK_TARGET, CODE, NOT_MEASURED)
    for line, words in enumerate(bare.splitlines(), start=1):
        for number in BARE_NUMBER.findall(words):
            yield line, f"{number} has no mark: no committed result holds it"


def unmarked_tick_costs(text: str) -> Iterator[tuple[int, str]]:
    bare = blanked(text, MARK, COMMENT, LINK_TARGET)
    for line, words in enumerate(bare.splitlines(), start=1):
        if TICK_COST.search(words):
            for number in COUNT.findall(words):
                yield line, f"{number} instructions have no mark: no committed result holds them"


def figures_inconsistent(root: Path) -> list[str]:
    """Every place at which README or a page differs from the committed results, one line each."""
    committed = load(root)
    found = []
    for page in pages(root):
        text = page.read_text(encoding="utf-8")
        wrong = [*stale_marks(text, committed), *unmarked_tick_costs(text)]
        if page.name == "README.md" and page.parent == root:
            wrong += unmarked_numbers(text)
        found += [f"{page.relative_to(root)}:{line}: {words}" for line, words in sorted(wrong)]
    return found
