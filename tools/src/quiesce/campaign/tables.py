"""The summary's tables, of plain text, for terminal and page."""

from collections.abc import Sequence
from typing import Any

from quiesce.campaign.sensitivity import Sensitivity
from quiesce.campaign.summary import QUANTILES, Summary, names_of

Table = tuple[tuple[str, ...], list[tuple[str, ...]]]
REASONS = 10  # that are told


def told(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def distributions(summary: Summary) -> Table:
    rows = [
        (one.group, one.figure, str(one.count), *map(told, one.quantiles))
        for one in summary.distributions
    ]
    blank = ("-",) * len(QUANTILES)
    return ("group", "figure", "cases", *QUANTILES), [
        (*row, *blank)[: 3 + len(blank)] for row in rows
    ]


def worst(summary: Summary) -> Table:
    rows = [
        (str(one.number), one.figure, told(one.value), *map(told, one.labels))
        for one in summary.worst
    ]
    return ("case", "figure", "value", *names_of(summary)), rows


def sensitivity(found: Sensitivity) -> Table:
    """Most important first."""
    key = found.head.index("total") if "total" in found.head else 0
    ordered = sorted(found.rows.items(), key=lambda item: -item[1][key])
    return ("factor", *found.head), [(name, *map(told, values)) for name, values in ordered]


def failures(summary: Summary) -> Table:
    rows = [(reason, str(count), str(first)) for reason, count, first in summary.reasons[:REASONS]]
    if len(summary.reasons) > REASONS:
        others = sum(count for _, count, _ in summary.reasons[REASONS:])
        rows.append((f"{len(summary.reasons) - REASONS} other reasons", str(others), ""))
    return ("reason", "cases", "first"), rows


def facts(summary: Summary) -> Table:
    """But for the file's text, which stands by itself."""
    rows: Sequence[tuple[str, str]] = [
        ("cases", str(summary.cases)),
        ("rows, SHA-256", summary.digest),
        *((name, value) for name, value in summary.facts.items() if name != "file"),
    ]
    return ("", "value"), list(rows)
