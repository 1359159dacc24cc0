"""The last committed results: docs/results/*.json, as named figures.

`hil.json` is metrics.json of `./tools/hil` with the printed table, any other file NAME.json the
object of a benchmark. tools/gen/results.py --record writes them.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

FOLDER = Path("docs/results")


@dataclass(frozen=True)
class Committed:
    """What the files of one folder say."""

    files: dict[str, dict[str, Any]]

    @cached_property
    def figures(self) -> dict[str, float]:
        found: dict[str, float] = {}
        for name, content in self.files.items():
            pairs = hil_figures(content) if name == "hil" else benchmark_figures(content)
            found.update((f"{name}.{key}", value) for key, value in pairs if value is not None)
        return found


def load(root: Path) -> Committed:
    files = (root / FOLDER).glob("*.json")
    return Committed({file.stem: json.loads(file.read_text()) for file in sorted(files)})


def hil_figures(hil: dict[str, Any]) -> Iterator[tuple[str, float | None]]:
    """`SCENARIO.LAW.KEY`, with the frequency of a step's second half behind its name; totals."""
    for row in hil["runs"]:
        prefix = f"{row['scenario']}.{row['freq_hz']:g}Hz.{row['law']}"
        if row["target"] == "host":
            yield f"{prefix}.amp", row["amp_reduction_pct"]
            yield f"{prefix}.accel", row["accel_rms_reduction_pct"]
            yield f"{prefix}.bound_amp", row["bound_amp_pct"]
            yield f"{prefix}.bound_accel", row["bound_accel_rms_pct"]
            yield f"{prefix}.mean_A", row["mean_current_A"]
        else:
            yield f"{prefix}.tick_median", row["instr_median"]
            yield f"{prefix}.tick_worst", row["instr_worst"]
    counted = [row["instr_worst"] for row in hil["runs"] if row["instr_worst"] is not None]
    yield "tick_worst", max(counted, default=None)
    equal = hil["trace_equal"] or {}
    for key in ("ticks", "mismatches", "distinct_commands"):
        yield f"equal.{key}", equal.get(key)
    yield "equal.seeds", len(equal.get("seeds", [])) or None


def benchmark_figures(result: dict[str, Any]) -> Iterator[tuple[str, float | None]]:
    for figure in result["figures"]:
        yield figure["name"], figure["value"]
