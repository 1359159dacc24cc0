"""Tables of pages about the road of a table, of the committed results."""

from typing import Any

from quiesce_benchmarks.house.committed import Committed
from quiesce_benchmarks.house.markdown import count, markdown, number

UNKNOWN = "Not recorded yet: `./tools/benchmark tables` prints it.\n"
CLOCK_MHz = 25


def road_table(part: str, committed: Committed) -> str:
    """Of one part of the benchmark. KeyError where there is no such one."""
    make = {
        "bump": _bump,
        "cost": _cost,
        "cuts": _cuts,
        "load": _load,
        "own_plant": _own_plant,
        "roads": _roads,
    }[part]
    if "tables" not in committed.files:
        return UNKNOWN
    reported = committed.files["tables"]["context"]["reported"].get(part, {})
    return make(reported) if reported.get("rows") else UNKNOWN


def _roads(reported: dict[str, Any]) -> str:
    """A row a kind: each target, by the tools and by messages alone."""
    cells: dict[str, dict[str, str]] = {}
    for row in reported["rows"]:
        both = [row["why"] or "ok", row["foreign_why"] or "ok"]
        cells.setdefault(row["kind"], {})[row["target"]] = ", ".join(both)
    targets = list(dict.fromkeys(row["target"] for row in reported["rows"]))
    rows = [[kind, *(found.get(one, "") for one in targets)] for kind, found in cells.items()]
    return markdown(["kind", *targets], rows)


def _cuts(reported: dict[str, Any]) -> str:
    """A row a fault: trials on each target; what was lost."""
    rows = reported["rows"]
    targets = list(dict.fromkeys(row["target"] for row in rows))
    cells = []
    for what in dict.fromkeys(row["what"] for row in rows):
        trials = {row["target"]: row["trials"] for row in rows if row["what"] == what}
        lost = sum(row["lost"] for row in rows if row["what"] == what)
        cells.append([what, *(str(trials.get(one, "")) for one in targets), str(lost)])
    return markdown(["", *targets, "lost"], cells)


def _load(reported: dict[str, Any]) -> str:
    cells = [
        [
            row["target"], number(row["load_s"], 2), str(row["loads"]), str(row["late"]),
            number(row["bus_pct"], 0),
        ]
        for row in reported["rows"]
    ]  # fmt: skip
    cells.append(
        ["computed", number(reported["model_s"], 2), "", "", number(reported["beside_pct"], 0)]
    )
    return markdown(["", "s", "loads", "ticks late", "of the bus, %"], cells)


def _bump(reported: dict[str, Any]) -> str:
    """A row a kind: changes and the largest step on each target."""
    found: dict[str, list[str]] = {}
    for row in reported["rows"]:
        found.setdefault(row["kind"], []).extend([str(row["changes"]), str(row["largest_step_mA"])])
    targets = dict.fromkeys(row["target"] for row in reported["rows"])
    head = [text for one in targets for text in (f"{one}: changes", "largest step, mA a tick")]
    return markdown(["kind", *head], [[kind, *cells] for kind, cells in found.items()])


def _cost(reported: dict[str, Any]) -> str:
    names = ("transfer", "commit", "used", "fetch")
    cells = [
        [
            row["kind"],
            count(row["words"]),
            *(count(row[name]) for name in names),
            number(100.0 * row["commit"] / (1000 * CLOCK_MHz), 0),
        ]
        for row in reported["rows"]
    ]
    head = ["kind", "words", *names, f"commit, % of a tick at {CLOCK_MHz} MHz"]
    return markdown(head, cells)


def _own_plant(reported: dict[str, Any]) -> str:
    cells = [
        [
            row["structure"],
            row["table"],
            number(row["left_pct"]),
            number(row["worst_pct"]),
            row["why"] or "ok",
        ]
        for row in reported["rows"]
    ]
    return markdown(["", "table", "acceleration left, %", "worst step, %", ""], cells)
