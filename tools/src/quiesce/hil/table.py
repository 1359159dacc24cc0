"""The table that `quiesce hil` prints: published, ours, independent simulation, bound."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from itertools import groupby
from typing import Any, TypeVar

from quiesce.base.table import format_table
from quiesce.engine import laws
from quiesce.hil.metrics import Beside, OpenLoop, Result, Row, excitation_text
from quiesce.hil.published import Published

HEAD = [
    "law", "on",
    *(f"x %\n{one}||z.1f" for one in "publ. ours diff sim. diff bound diff".split()),
    *(f"a %\n{one}||z.1f" for one in "ours sim. diff bound diff".split()),
    "mean\nA||z.2f", "settle\ns||z.3f",
]  # fmt: skip
NOTES = (
    "x: displacement amplitude, a: RMS acceleration, by how much they are reduced against the open "
    "loop.\n"
    "publ.: measured by the paper on the real structure. sim.: an independent simulation of this "
    "plant,\n"
    "sine cases without sensor noise. bound: the best that any current waveform does (best found, "
    "+-0.5).\n"
    "diff: ours less the figure before it; for a range, less its nearer end. on: 'both' where host "
    "and the\n"
    "other target agree to every digit."
)

AnyRow = TypeVar("AnyRow", bound=Any)
Also = TypeVar("Also")


def target_name(target: str) -> str:
    return {"linux": "quiesced"}.get(target, "image")


def difference(ours: float | None, other: float | None) -> float | None:
    return None if ours is None or other is None else ours - other


def published_text(published: Published | None) -> str:
    if published is None:
        return "-"
    if published.low_pct == published.high_pct:
        return f"{published.low_pct:.1f}"
    return f"{published.low_pct:g}-{published.high_pct:g}"


def published_difference(ours: float | None, published: Published | None) -> float | None:
    """Distance from the published figure, or from the nearer end of a range; 0 inside it."""
    if ours is None or published is None:
        return None
    return ours - min(max(ours, published.low_pct), published.high_pct)


def table_row(row: Row, beside: Beside) -> list[Any]:
    amp, accel = row.amp_reduction_pct, row.accel_rms_reduction_pct
    sim_amp = beside.simulated.get("amp_reduction_pct")
    sim_accel = beside.simulated.get("accel_rms_reduction_pct")
    bound_amp, bound_accel = row.bound_amp_pct, row.bound_accel_rms_pct
    published = beside.published
    return [
        laws.find(row.law).label, row.target,
        published_text(published), amp, published_difference(amp, published),
        sim_amp, difference(amp, sim_amp), bound_amp, difference(amp, bound_amp),
        accel, sim_accel, difference(accel, sim_accel), bound_accel, difference(accel, bound_accel),
        row.mean_current_A, row.settle_s,
    ]  # fmt: skip


def figures_of(row: Row) -> Row:
    """The row without what only an emulated target has."""
    return replace(row, target="", instr_median=None, instr_worst=None)


def merge_targets(
    pairs: Iterable[tuple[AnyRow, Also]], compared: Callable[[AnyRow], AnyRow] = figures_of
) -> list[tuple[AnyRow, Also]]:
    """Rows with host and image merged where they agree to every digit."""
    merged: list[tuple[AnyRow, Also]] = []
    for row, beside in pairs:
        for i, (other, _) in enumerate(merged):
            if compared(other) == compared(row):
                merged[i] = (replace(other, target="both"), beside)
                break
        else:
            merged.append((row, beside))
    return merged


def groups(result: Result) -> Iterator[tuple[str, list[tuple[Row, Beside]]]]:
    """Rows by scenario and frequency, each with its heading."""
    pairs = merge_targets(result.plain)
    order = {key: i for i, key in enumerate(dict.fromkeys(group_key(row) for row, _ in pairs))}
    pairs.sort(key=lambda pair: order[group_key(pair[0])])
    for (scenario, freq_hz), members in groupby(pairs, key=lambda pair: group_key(pair[0])):
        group = list(members)
        base = group[0][1].open_loop
        yield f"{scenario}, {excitation_text(freq_hz)}: {open_loop_text(base)}", group


def open_loop_text(base: OpenLoop) -> str:
    sim_amp_um, sim_accel_mm_s2 = (base.simulated.get(k) for k in ("amp_um", "accel_rms_mm_s2"))
    amp = f"{base.amp_um:.1f} um" + (f" (sim. {sim_amp_um})" if sim_amp_um else "")
    accel = f"{base.accel_rms_mm_s2:.1f} mm/s2"
    return f"open loop {amp}, {accel}" + (f" (sim. {sim_accel_mm_s2})" if sim_accel_mm_s2 else "")


def group_key(row: Row) -> tuple[str, float]:
    return row.scenario, row.freq_hz


def comparison_table(result: Result) -> str:
    rows: list[Any] = []
    for heading, members in groups(result):
        rows += [*([""] if rows else []), heading]
        rows += [table_row(row, beside) for row, beside in members if row.law != laws.OPEN_LOOP]
    return f"{format_table(HEAD, rows, (0, 1), gap=1)}\n\n{NOTES}"


def compared_text(telemetry_every: int) -> str:
    if telemetry_every == 1:
        return "every word of every reply"
    return f"every command, state and fault, and all words every {telemetry_every} ticks"


def trace_line(result: Result) -> str:
    equal = result.trace_equal
    if equal is None:
        return "trace equality: not run (host only)"
    if equal["mismatches"] == 0:
        every = equal["telemetry_every"]
        verdict = compared_text(every) + (" is the same" if every == 1 else ": the same\n ")
    else:
        first = equal["first_mismatch"]
        verdict = (
            f"FAILED, {equal['mismatches']} mismatches, first: seed {first['seed']}, tick "
            f"{first['tick']}, {first['field']}"
        )
    faults = ", ".join(map(str, equal["faults_seen"])) or "none"
    # A rig is compared in its own scenario, which is named; the others in one made for it.
    what = equal.get("case", f"a frequency step, faults {faults} and recovery")
    return (
        f"trace equality, {' and '.join(equal['targets'])}: {verdict} "
        f"({equal['ticks']} ticks, {len(equal['seeds'])} seeds,\n"
        f"  {equal['distinct_commands']} distinct commands, {what})"
    )


def differing_line(result: Result) -> str:
    name = target_name(result.trace_equal["targets"][1] if result.trace_equal else "mps2")
    if result.differing:
        return f"FAILED, telemetry differs between host and {name}: {', '.join(result.differing)}"
    if result.trace_equal and result.trace_equal["telemetry_every"] > 1:
        return f"all words that {name} sent in the runs above: the same as the host's"
    return f"telemetry checksums of all runs above: the same on host and {name}"


def speed_lines(result: Result) -> list[str]:
    factors = [
        f"{name} {factor:.{1 if factor < 10.0 else 0}f}x"
        for name, factor in result.realtime_factor.items()
        if factor is not None
    ]
    lines = [f"closed loop against real time: {', '.join(factors)}"]
    if result.uart:
        uart = result.uart
        lines.append(
            f"over the image's UART: {uart['realtime_factor']:.2f}x, "
            f"{uart['protocol_per_s']:.0f} exchanges/s = {uart['ratio']:.2f} of a raw echo of the "
            "same bytes"
        )
    return lines


def instruction_lines(result: Result) -> list[str]:
    counted = {(row.scenario, row.law): row for row in result.rows if row.instr_median is not None}
    if not counted:
        return []
    lines = ["instructions a tick of the image (Cortex-M4), median / worst:"]
    for scenario, rows in groupby(counted.values(), key=lambda row: row.scenario):
        figures = [f"{row.law} {row.instr_median} / {row.instr_worst}" for row in rows]
        lines += [
            f"  {scenario if i == 0 else '':13}{'   '.join(figures[i : i + 3])}"
            for i in range(0, len(figures), 3)
        ]
    return lines


def summary(result: Result) -> str:
    lines = [trace_line(result)]
    if result.trace_equal is not None:
        lines.append(differing_line(result))
    return "\n".join(lines + speed_lines(result) + instruction_lines(result))
