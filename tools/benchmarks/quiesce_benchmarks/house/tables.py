"""Tables for pages, of the committed results."""

from collections.abc import Callable
from typing import Any

from quiesce.engine.laws import published_law

from quiesce_benchmarks.board.page import board_table
from quiesce_benchmarks.house.committed import Committed
from quiesce_benchmarks.house.fuzzy_tables import engine_table, host_table, ratio_table
from quiesce_benchmarks.house.markdown import count, markdown, number
from quiesce_benchmarks.house.signal_tables import (
    accuracy_table,
    cost_table,
    module_table,
    peer_table,
    step_table,
)
from quiesce_benchmarks.install.page import install_table
from quiesce_benchmarks.laws.page import law_table
from quiesce_benchmarks.papers.page import paper_table
from quiesce_benchmarks.tables.page import road_table

# What a page's table shows of ./tools/hil, in this order.
SHOWN_LAWS = {
    "constant_best": "best constant current",
    "fuzzy": "fuzzy",
    "fuzzy_selftune_printed_gated": "fuzzy + self-tuning below 7.5 Hz, as printed",
    "fuzzy_selftune_printed": "fuzzy + self-tuning at all frequencies, as printed",
    "fuzzy_selftune_reversed": "fuzzy + self-tuning below 7.5 Hz, reversed",
    "fuzzy_selftune_reversed_ungated": "fuzzy + self-tuning at all frequencies, reversed",
    "phase": "**phase**, `balanced`",
    "phase_displacement": "**phase**, `displacement`",
}
UNITS = {"1": "", "instr": " instructions", "byte": " bytes"}


def value_text(figure: dict[str, Any]) -> str:
    value = figure["value"]
    if value is None:
        return "absent"
    unit = UNITS.get(figure["unit"], f" {figure['unit']}")
    is_count = figure["unit"] in ("instr", "byte")
    return (count(value) if is_count else f"{value:.4g}") + unit


def goal_text(figure: dict[str, Any]) -> str:
    if figure["goal"] is None:
        return ""
    return f"{'<=' if figure['better'] == 'lower' else '>='} {figure['goal']:g}"


def figure_table(result: dict[str, Any]) -> str:
    """Every figure of a benchmark beside its goal."""
    rows = [
        [
            f"`{figure['name']}`",
            value_text(figure),
            goal_text(figure),
            "**missed**" if figure["ok"] is False else "",
        ]
        for figure in result["figures"]
    ]
    return markdown(["figure", "measured", "goal", ""], rows)


def published_text(hil: dict[str, Any], row: dict[str, Any]) -> str:
    """Of the paper's case; what it has for self-tuning stands beside every reading of it."""
    place = (row["scenario"], published_law(row["law"]), row["freq_hz"])
    found = [
        case["amp_reduction_pct"]
        for case in hil["published"]
        if (case["case"].partition(",")[0], case["law"], case["freq_hz"]) == place
    ]
    ends = sorted({f"{value:g}" for value in found}, key=float)
    return "-".join(ends)


def host_rows(hil: dict[str, Any]) -> list[dict[str, Any]]:
    return [row for row in hil["runs"] if row["target"] == "host"]


def reduction_table(hil: dict[str, Any]) -> str:
    """Reductions by scenario and law: published, ours, the bound."""
    rows = []
    shown = [row for row in host_rows(hil) if row["law"] in SHOWN_LAWS]
    order = list(SHOWN_LAWS)
    places = list(dict.fromkeys((row["scenario"], row["freq_hz"]) for row in shown))
    shown.sort(key=lambda r: (places.index((r["scenario"], r["freq_hz"])), order.index(r["law"])))
    for row in shown:
        place = f"{row['scenario']}, {row['freq_hz']:g} Hz"
        is_new = not rows or place not in (line[0] for line in rows)
        rows.append(
            [
                place if is_new else "",
                SHOWN_LAWS[row["law"]],
                published_text(hil, row),
                f"{number(row['amp_reduction_pct'])} / {number(row['accel_rms_reduction_pct'])}",
                f"{number(row['bound_amp_pct'])} / {number(row['bound_accel_rms_pct'])}"
                if is_new
                else "",
                number(row["mean_current_A"], 2),
            ]
        )
    return markdown(["", "law", "published", "ours", "bound", "mean A"], rows)


def instruction_table(hil: dict[str, Any]) -> str:
    """Instructions of a control tick on the image, by scenario and law."""
    counted = [row for row in hil["runs"] if row["instr_worst"] is not None]
    rows: dict[tuple[str, str], list[str]] = {}
    for row in counted:
        cells = [row["scenario"], f"`{row['law']}`"]
        cells += [f"{row['instr_median']:,}", f"{row['instr_worst']:,}"]
        rows.setdefault((row["scenario"], row["law"]), cells)
    return markdown(["scenario", "law", "median", "worst"], list(rows.values()))


def excerpt(hil: dict[str, Any]) -> str:
    """Of what `./tools/hil` prints: the columns' names, the step's first half, the comparison."""
    lines = hil["table"].splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("step_"))
    end = lines.index("", start)
    equal = next(i for i, line in enumerate(lines) if line.startswith("trace equality"))
    shown = [*lines[:3], *lines[start:end], "...", *lines[equal : equal + 2]]
    return "```text\n" + "\n".join(line.rstrip() for line in shown) + "\n```\n"


TABLES: dict[str, Callable[[dict[str, Any]], str]] = {
    "figures": figure_table,
    "reductions": reduction_table,
    "instructions": instruction_table,
    "excerpt": excerpt,
    "accuracy": accuracy_table,
    "steps": step_table,
    "costs": cost_table,
    "modules": module_table,
    "peers": peer_table,
    "engines": engine_table,
    "hosts": host_table,
    "ratios": ratio_table,
}


def table(name: str, committed: Committed) -> str:
    """Lines of a page, of a table's name and a file's; KeyError where there is no such table."""
    kind, _, file = name.partition(" ")
    if kind == "board":
        return board_table(file, committed)
    if kind == "install":
        return install_table(file, committed)
    if kind == "paper":
        return paper_table(file, committed)
    if kind == "law":
        return law_table(file, committed)
    if kind == "road":
        return road_table(file, committed)
    return TABLES[kind](committed.files[file])
