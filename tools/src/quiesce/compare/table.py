"""What was compared, as text, as data and as CSV."""

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from quiesce.base.table import format_table
from quiesce.compare.clairvoyant import CLAIRVOYANT
from quiesce.compare.figures import ALL_FIGURES, zone_of
from quiesce.compare.run import Cell

SHOWN = (
    "disp_peak_mm", "drift_peak_mm", "accel_peak_m_s2", "accel_rms_m_s2", "force_peak_N",
    "current_mean_A", "chatter_A_s", "weighted_m_s2", "tyre_share", "rattle_mm",
)  # fmt: skip


def rigs_of(cells: Sequence[Cell]) -> list[str]:
    return list(dict.fromkeys(cell.rig for cell in cells))


def laws_of(cells: Sequence[Cell]) -> list[str]:
    return list(dict.fromkeys(cell.law for cell in cells))


def means(cells: Sequence[Cell], law: str) -> dict[str, float]:
    """Of a law over all records and seeds; with `index` and `index_worst`, and `share` where the
    clairvoyant's optimum is known."""
    own = [cell for cell in cells if cell.law == law]
    out = {name: float(np.mean([cell.figures[name] for cell in own])) for name in own[0].figures}
    indices = [cell.index for cell in own]
    shares = [cell.share for cell in own if cell.share is not None]
    if shares:
        out["share"] = float(np.mean(shares))
    return {**out, "index": float(np.mean(indices)), "index_worst": max(indices)}


def rows(cells: Sequence[Cell]) -> tuple[list[str], list[list[str]]]:
    """A row a law, means over records and seeds, the best index first."""
    units = {name: unit for name, unit, _ in ALL_FIGURES}
    shown = [name for name in SHOWN if name in cells[0].figures]
    has_share = any(cell.share is not None for cell in cells)
    share_head = ["share"] if has_share else []
    head = ["law", "index", "worst", *share_head]
    head += [f"{_short(name)} {units[name]}" for name in shown]
    found = sorted(
        ((law, means(cells, law)) for law in laws_of(cells)), key=lambda x: x[1]["index"]
    )
    body = [
        [
            law, f"{m['index']:.3f}", f"{m['index_worst']:.3f}",
            *([f"{m['share']:.2f}" if "share" in m else "-"] if has_share else []),
            *(f"{m[name]:.4g}" for name in shown),
        ]
        for law, m in found
    ]  # fmt: skip
    return head, body


def _short(name: str) -> str:
    for unit in ("_m_s2", "_mm", "_N", "_A_s", "_A", "_share"):
        name = name.removesuffix(unit)
    return name.replace("_", " ")


def text(cells: Sequence[Cell]) -> str:
    """A table for each structure."""
    rigs = rigs_of(cells)
    own = {rig: _text([cell for cell in cells if cell.rig == rig]) for rig in rigs}
    if len(rigs) == 1:
        return own[rigs[0]]
    return "\n".join(f"{rig}:\n{table}" for rig, table in own.items())


def _text(cells: Sequence[Cell]) -> str:
    notes = [
        f"{c.record}, seed {c.seed}: {c.law} is {c.note}"
        for c in cells
        if c.note and c.law != CLAIRVOYANT
    ]
    notes += list(dict.fromkeys(f"{c.law}: {c.note}" for c in cells if c.law == CLAIRVOYANT))
    return "\n".join([format_table(*rows(cells)), "", *notes])


def as_data(cells: Sequence[Cell]) -> list[dict[str, Any]]:
    return [{**asdict(cell), "zone": zone_of(cell.figures)} for cell in cells]


def as_csv(cells: Sequence[Cell]) -> str:
    stream = io.StringIO()
    out = csv.writer(stream, lineterminator="\n")
    names = [name for name, _, _ in ALL_FIGURES]
    out.writerow(["rig", "law", "record", "seed", "index", *names, "zone", "share"])
    for cell in cells:
        known = cell.figures
        values = [f"{known[name]:.9g}" if name in known else "" for name, _, _ in ALL_FIGURES]
        row = [
            cell.rig,
            cell.law,
            cell.record,
            cell.seed,
            f"{cell.index:.9g}",
            *values,
            zone_of(cell.figures),
            "" if cell.share is None else f"{cell.share:.9g}",
        ]
        out.writerow(row)
    return stream.getvalue()
