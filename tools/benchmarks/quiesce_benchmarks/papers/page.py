"""Tables of docs/results/papers.md: of the rows and of the committed results."""

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from quiesce_benchmarks.house.committed import Committed
from quiesce_benchmarks.house.markdown import markdown
from quiesce_benchmarks.papers.rows import KINDS, Paper, Row, papers, positions

KEY = re.compile(r"\{(?P<key>[^{}:]+)(?::(?P<spec>[^{}]*))?\}")
NAMES = {"equation": "eq", "table": "Table", "figure": "Fig"}
UP = "../../"  # from the page's folder to the tree
UNKNOWN = "not recorded yet"
HEAD = ("", "what", "where", "command", "published", "ours (difference)", "note")
SUMMARY_HEAD = ("paper", *KINDS.values(), "rows", "not yet", "without place or reason")


def paper_table(name: str, committed: Committed) -> str:
    """A paper's rows; of the name `summary` a row a paper. KeyError where there is no such one."""
    if name == "summary":
        return markdown(SUMMARY_HEAD, [summary(paper) for paper in papers().values()])
    return markdown(HEAD, [cells(row, committed) for row in papers()[name].rows])


def summary(paper: Paper) -> Sequence[str]:
    counts = [
        sum(len(positions(text, paper.name)) for text in paper.ranges[kind]) for kind in KINDS
    ]
    waiting = sum(bool(row.pending) for row in paper.rows)
    bare = sum(not (row.places or row.reason or row.pending) for row in paper.rows)
    return (paper.title, *map(str, (*counts, len(paper.rows), waiting, bare)))


def cells(row: Row, committed: Committed) -> Sequence[str]:
    number = f"{NAMES[row.kind]} {row.number}"
    typed = f"`{row.typed}`" if row.typed else ""
    published, ours = published_text(row), ours_text(row, committed)
    found = (number, row.what, where(row), typed, published, ours, row.note)
    return [cell.replace("|", "\\|") for cell in found]


def where(row: Row) -> str:
    if row.places:
        return ", ".join(map(link, row.places))
    if row.pending:
        return f"**not yet**: {row.pending}"
    return row.reason or "**no place yet**"


def link(place: str) -> str:
    path, _, symbol = place.partition(":")
    name = path.rstrip("/").rpartition("/")[2]
    return f"[{name}]({UP}{path})" + (f" `{symbol}`" if symbol else "")


def published_text(row: Row) -> str:
    if isinstance(row.published, str):
        return row.published
    return " / ".join(f"{value:g}" for value in as_numbers(row.published))


def as_numbers(published: float | tuple[float, ...]) -> tuple[float, ...]:
    return published if isinstance(published, tuple) else (published,)


def ours_text(row: Row, committed: Committed) -> str:
    """With the committed values in the places of their keys, and what they differ by where as many
    numbers are published."""
    keys = list(KEY.finditer(row.ours))
    if not keys:
        return row.ours or ("" if not row.part or is_recorded(row.part, committed) else UNKNOWN)
    try:
        found = [as_list(looked_up(key["key"], committed)) for key in keys]
    except KeyError:
        return UNKNOWN
    published = () if isinstance(row.published, str) else as_numbers(row.published)
    is_compared = len(published) == sum(map(len, found))
    against = iter(published) if is_compared else None
    filled = iter(
        [
            joined(values, key["spec"] or "", against)
            for key, values in zip(keys, found, strict=True)
        ]
    )
    return KEY.sub(lambda _: next(filled), row.ours)


def is_recorded(part: str, committed: Committed) -> bool:
    context = committed.files.get("papers", {}).get("context", {})
    return bool(context.get("reported", {}).get(part))


def joined(values: Iterable[Any], spec: str, against: Iterator[float] | None) -> str:
    return " / ".join(
        shown(value, spec, None if against is None else next(against)) for value in values
    )


def shown(value: Any, spec: str, published: float | None) -> str:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if value is None or not is_number:
        return "absent" if value is None else str(value)
    spec = spec or ".4g"
    text = format(value, spec)
    return text if published is None else f"{text} ({format(value - published, '+' + spec)})"


def as_list(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list | tuple) else [value]


def looked_up(key: str, committed: Committed) -> Any:
    """A figure, by the name that it has in other pages' marks, or `papers.PART.KEY...` of what the
    parts reported; KeyError where nothing is."""
    if key in committed.figures:
        return committed.figures[key]
    name, *path = key.split(".")
    value = committed.files[name].get("context", {}).get("reported", {})
    try:
        for step in path:
            value = value[int(step)] if isinstance(value, list) else value[step]
    except (IndexError, TypeError, ValueError):
        raise KeyError(key) from None
    return value
