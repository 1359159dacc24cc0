"""Figures of the bodies and dampers of a rig, each law against law off."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from quiesce.engine.laws import OPEN_LOOP
from quiesce.hil.runs import Run, reduction_pct

# Of a body: figures that have a reduction.
REDUCED = ("disp_rms_um", "peak_disp_um", "accel_rms_mm_s2")


@dataclass(frozen=True)
class RigRow:
    """One window of one run; the fields are those of an entry of metrics.json's `rigs`.

    Of each body disp_rms_um, peak_disp_um and accel_rms_mm_s2, with the reduction of each against
    law off as NAME_reduction_pct; of each damper mean_current_A, peak_force_N, by how much that is
    more than with law off as peak_force_more_N, and peak_stroke_um.
    """

    scenario: str
    law: str
    target: str
    start_s: float
    end_s: float
    bodies: dict[str, dict[str, float | None]]
    dampers: dict[str, dict[str, float]]


def body_figures(ours: dict[str, float], base: dict[str, float]) -> dict[str, float | None]:
    absolute = {key: round(ours[key], 4) for key in REDUCED}
    reduced = {f"{key}_reduction_pct": reduction_pct(ours[key], base[key]) for key in REDUCED}
    return {**absolute, **reduced}


def damper_figures(ours: dict[str, float], base: dict[str, float]) -> dict[str, float]:
    absolute = {key: round(value, 4) for key, value in ours.items()}
    return {**absolute, "peak_force_more_N": round(ours["peak_force_N"] - base["peak_force_N"], 4)}


def rig_row(run: Run, ours: dict[str, Any], base: dict[str, Any]) -> RigRow:
    """ours, base: a window of the run and of the one with law off."""
    return RigRow(
        scenario=run.case.scenario.name,
        law=run.case.law.name,
        target=run.case.target,
        start_s=ours["start_s"],
        end_s=ours["end_s"],
        bodies={
            name: body_figures(figures, base["bodies"][name])
            for name, figures in ours["bodies"].items()
        },
        dampers={
            name: damper_figures(figures, base["dampers"][name])
            for name, figures in ours["dampers"].items()
        },
    )


def rig_rows(runs: Sequence[Run]) -> list[RigRow]:
    """Of all runs with a board. Each target is measured against its own law off."""
    with_board = [run for run in runs if run.case.scenario.board is not None]
    base = {
        (run.case.scenario.name, run.case.target): run.figures["rig"]
        for run in with_board
        if run.case.law.name == OPEN_LOOP
    }
    return [
        rig_row(run, ours, off)
        for run in with_board
        for ours, off in zip(
            run.figures["rig"], base[run.case.scenario.name, run.case.target], strict=True
        )
    ]


def by_window(rows: Sequence[RigRow]) -> dict[str, list[RigRow]]:
    """Rows of all laws under what they have in common, in words."""
    found: dict[str, list[RigRow]] = {}
    for row in rows:
        heading = f"{row.scenario}, {row.start_s:g} .. {row.end_s:g} s"
        found.setdefault(heading, []).append(row)
    return found
