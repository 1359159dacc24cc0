"""The tables of `./tools/benchmark fuzzy` for the terminal."""

from collections.abc import Sequence

from quiesce.base.table import format_table

from quiesce_benchmarks.fuzzy.callgrind import HostCount
from quiesce_benchmarks.fuzzy.cost import EngineCost, PeerCost, TableCost
from quiesce_benchmarks.fuzzy.grid import GridResult
from quiesce_benchmarks.fuzzy.reference import CENTROID
from quiesce_benchmarks.fuzzy.suite import PEERS, RandomResult


def grid_table(grid: GridResult) -> str:
    head = [
        f"{grid.side} x {grid.side} points",
        "",
        "",
        "against",
        "worst, A",
        "mean, A",
        "at Hz",
        "m/s2",
    ]
    rows = [
        [
            error.what,
            " ".join(part for part in (error.method, error.format) if part),
            error.of,
            error.against,
            f"{error.worst_A:.3g}",
            f"{error.mean_A:.2g}",
            f"{error.at_freq_Hz:.3f}",
            f"{error.at_accel_m_s2:.3f}",
        ]
        for error in grid.errors
    ]
    return format_table(head, rows, left=(0, 1, 2, 3))


def engine_table(engines: Sequence[EngineCost]) -> str:
    head = [
        "on the Cortex-M4",
        "evaluations",
        "worst",
        "median",
        "mean",
        "code, B",
        "table, B",
        "stack, B",
    ]
    rows = [
        [
            f"{one.kind}, {one.variant.method}, {one.variant.format}",
            f"{one.evaluations:,}",
            f"{one.worst_instr:,}",
            f"{one.median_instr:,}",
            f"{one.mean_instr:,.1f}",
            f"{one.code_bytes:,}",
            f"{one.table_bytes:,}",
            f"{one.stack_bytes:,}",
        ]
        for one in engines
    ]
    return format_table(head, rows)


def peer_table(peers: Sequence[PeerCost], engines: Sequence[EngineCost]) -> str:
    """The ratios are of the peer's mean to the worst of our straight-line code."""
    head = ["libfuzzylite 6, float", "worst", "median", "mean", "mean/ours", "code, B", "stack, B"]
    rows = []
    for one in peers:
        ours = max(
            (
                cost.worst_instr
                for cost in engines
                if cost.kind == "straight"
                and (cost.variant.method == CENTROID) == bool(one.resolution)
            ),
            default=None,
        )
        rows.append(
            [
                f"centroid, {one.resolution} samples" if one.resolution else "singletons, sum",
                f"{one.worst_instr:,}",
                f"{one.median_instr:,}",
                f"{one.mean_instr:,.0f}",
                "-" if ours is None else f"{one.mean_instr / ours:,.0f}",
                f"{one.code_bytes:,}",
                f"{one.stack_bytes:,}",
            ]
        )
    return format_table(head, rows)


def host_table(counts: Sequence[HostCount]) -> str:
    rows = [[one.what, one.method, f"{one.mean_instr:,.1f}"] for one in counts]
    return format_table(["on the host, same inputs", "", "mean"], rows, left=(0, 1))


def random_table(result: RandomResult) -> str:
    """Peers on the random bases, and why they differ from the exact reference."""
    points, reasons = result.peer_points(), result.reasons()
    rows = []
    for peer in PEERS:
        if peer not in points:
            continue
        told = ", ".join(f"{count:,} {reason}" for reason, count in reasons[peer].items())
        rows.append([peer, f"{points[peer]:,}", told or "none"])
    return format_table(["random bases", "points", "points that differ"], rows, left=(0, 2))


def beyond_lines(result: RandomResult) -> list[str]:
    """Bases that miss the bound, and those that were refused, one line each."""
    lines = []
    for outcome in result.outcomes:
        if outcome.is_beyond:
            worst = max((one.worst_lsb for one in outcome.engines), default=0.0)
            random = outcome.case.random
            lines.append(
                f"beyond the bound: base {random.number} ({random.layout}, {random.style}), "
                f"{sum(one.beyond for one in outcome.engines)} points, worst {worst:.2f} LSB"
            )
    return lines + [f"refused: base {number}: {why}" for number, why in result.refused.items()]


def fallback_table(result: RandomResult, costs: dict[int, TableCost]) -> str:
    """Table engine on the bases without straight-line code."""
    rows = []
    for outcome in result.outcomes:
        cost = costs.get(outcome.case.random.number)
        if cost is None:
            continue
        random = outcome.case.random
        rows.append(
            [
                f"{random.number}, {random.layout}, {random.style}",
                outcome.case.base.outputs[0].method,
                str(len(outcome.case.base.rules)),
                f"{cost.worst_instr:,}",
                f"{cost.mean_instr:,.0f}",
                f"{cost.table_bytes:,}",
            ]
        )
    head = ["fallback: base", "method", "rules", "worst", "mean", "table, B"]
    return format_table(head, rows, left=(0, 1))
