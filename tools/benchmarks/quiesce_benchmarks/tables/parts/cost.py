"""What tables on the bus cost a controller's tick: instructions on the Cortex-M4, exact."""

from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.base.table import format_table

from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.tables.counted import order, run_image
from quiesce_benchmarks.tables.largest import largest
from quiesce_benchmarks.tables.line import RUNNING
from quiesce_benchmarks.tables.samples import Sample, all_samples

TITLE = "cost: instructions of a tick while tables come, are used and go"
# instr_added: of a tick in which nothing is transferred, the node's beside one that has no table
# service; mean or median, the larger. commit_*: the worst tick, control step included, from the
# request to use a table of any kind and size until its answer.
FIGURES = (
    ("instr_added", "instr", 30.0, "lower"),
    ("instr_added_worst", "instr", None, "lower"),
    ("commit_instr", "instr", None, "lower"),
    ("commit_tick_pct", "%", None, "lower"),
)
# Parts of tools/benchmarks/mps2/tables/main_table_cost.c.
IDLE, TRANSFER, COMMIT, USED, FETCH, MINUTE = range(6)
SHOWN = {"transfer": TRANSFER, "commit": COMMIT, "used": USED, "fetch": FETCH}
TICKS, QUICK_TICKS = 5000, 1000
# 8 kB and 4 kB of a file, its head included; no table has more than 2048 words.
SIZES = {"8 kB": 2048, "4 kB": 1020}
CLOCKS_MHz = (25, 72, 168)
TICK_us = 1000


def counted(image: str, part: int, ticks: int, sample: Sample, words: list[int]) -> dict[str, Any]:
    """BenchFailure where the table was not taken, or it did not run."""
    found = run_image(image, order(part, ticks, sample, words, {}))
    printed = found["printed"]
    if printed.get("result", 0) or printed["state"] not in RUNNING:
        raise BenchFailure(f"{image}: {sample.name} was not taken, or did not run: {printed}")
    return found


def added(ticks: int) -> dict[str, float]:
    """By the table service, while nothing is transferred: the shipped rules in use."""
    sample = next(one for one in all_samples() if one.name == "rules")
    words = sample.second[0]
    with_it, without = (
        counted(image, IDLE, ticks, sample, words) for image in ("table_cost", "table_cost_without")
    )
    return {f"{key}_instr": with_it[key] - without[key] for key in ("median", "mean", "worst")} | {
        "idle_worst_instr": with_it["worst"],
    }


def measure(effort: Effort) -> Measured:
    ticks = QUICK_TICKS if effort.is_quick else TICKS
    more = added(ticks)
    rows = []
    for sample in all_samples():
        for size, most_words in SIZES.items():
            words = largest(sample, most_words).second[0]
            if rows and rows[-1]["kind"] == sample.name and rows[-1]["words"] == len(words):
                continue
            row = {"kind": sample.name, "size": size, "words": len(words)}
            for name, part in SHOWN.items():
                row[name] = counted("table_cost", part, ticks, sample, words)["worst"]
            rows.append(row)
    learnt = next(one for one in all_samples() if one.name == "learnt")
    minute = counted("table_cost", MINUTE, ticks, learnt, learnt.second[0])["worst"]
    commit = max(row["commit"] for row in rows)
    values: dict[str, float | None] = {
        "instr_added": max(more["median_instr"], more["mean_instr"]),
        "instr_added_worst": more["worst_instr"],
        "commit_instr": commit,
        "commit_tick_pct": share_pct(commit, CLOCKS_MHz[0]),
    }
    reported = {"added": more, "rows": rows, "minute_worst_instr": minute}
    return Measured(values, reported, (table_of(rows), text_of(more, minute)))


def share_pct(instr: float, clock_MHz: int) -> float:
    """Of a tick of 1 kHz, at an instruction a cycle."""
    return 100.0 * instr / (clock_MHz * TICK_us)


def table_of(rows: list[dict[str, Any]]) -> str:
    head = ["kind", "words", *(f"worst, {name}" for name in SHOWN)]
    head += [f"% of a tick at {clock} MHz" for clock in CLOCKS_MHz]
    cells = [
        [
            row["kind"],
            str(row["words"]),
            *(f"{row[name]:.0f}" for name in SHOWN),
            *(
                f"{share_pct(max(row['transfer'], row['commit']), clock):.0f}"
                for clock in CLOCKS_MHz
            ),
        ]
        for row in rows
    ]
    return format_table(head, cells, (0,))


def text_of(more: dict[str, float], minute: float) -> str:
    return (
        f"idle: {more['idle_worst_instr']:.0f} at worst; more than without tables: mean "
        f"{more['mean_instr']:.1f}, median {more['median_instr']:.0f}, worst "
        f"{more['worst_instr']:.0f}; a minute after the start, where what was learnt is stored: "
        f"{minute:.0f}"
    )
