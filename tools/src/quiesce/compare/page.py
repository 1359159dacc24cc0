"""The page of a comparison: table, radar of ratios, fronts, motion over time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce.compare.clairvoyant import CLAIRVOYANT
from quiesce.compare.figures import INDEXED
from quiesce.compare.run import ALL, BEST, Cell
from quiesce.compare.table import laws_of, means, rows
from quiesce.engine.trace import Trace
from quiesce.report.page import render
from quiesce.report.plot_style import COLORS, pyplot, svg_of

CYCLE = [COLORS[name] for name in ("open_loop", "reference", "constant_best", "main", "phase",
                                   "phase_displacement", "current", "fuzzy_selftune_printed",
                                   "bound")]  # fmt: skip


@dataclass(frozen=True)
class Shown:
    """Of one structure. traces: of one record, by law; body and damper: whose motion and current
    are drawn."""

    rig: str
    cells: Sequence[Cell]
    traces: Mapping[str, Trace]
    body: str
    damper: str


def page(shown: Sequence[Shown]) -> str:
    told = [
        {
            "rig": one.rig,
            "cells": one.cells,
            "table": rows(one.cells),
            "radar": _radar(one.cells),
            "fronts": _fronts(one.cells),
            "motion": _motion(one.traces, one.body, one.damper),
        }
        for one in shown
    ]
    return render("compare/page.html.j2", shown=told, best_law=BEST, clairvoyant=CLAIRVOYANT)


def _radar(cells: Sequence[Cell]) -> str:
    plt = pyplot()
    base = means(cells, ALL)
    angles = np.linspace(0.0, 2 * np.pi, len(INDEXED) + 1)
    figure, axes = plt.subplots(figsize=(7, 5.2), subplot_kw={"projection": "polar"})
    for i, law in enumerate(laws_of(cells)):
        found = means(cells, law)
        ratios = [found[name] / base[name] for name in INDEXED]
        axes.plot(angles, [*ratios, ratios[0]], color=CYCLE[i % len(CYCLE)], label=law)
    axes.set_xticks(angles[:-1], [name.rsplit("_", 1)[0].replace("_", " ") for name in INDEXED])
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="center left", bbox_to_anchor=(1.15, 0.5))
    return svg_of(figure)


def _fronts(cells: Sequence[Cell]) -> str:
    plt = pyplot()
    figure, axes = plt.subplots(figsize=(7, 4))
    for i, law in enumerate(laws_of(cells)):
        own = [cell.figures for cell in cells if cell.law == law]
        axes.plot(
            [one["disp_peak_mm"] for one in own],
            [one["accel_peak_m_s2"] for one in own],
            "o",
            color=CYCLE[i % len(CYCLE)],
            label=law,
        )
    axes.set_xlabel("peak displacement of the last body, mm")
    axes.set_ylabel("peak acceleration, m/s2")
    axes.legend()
    return svg_of(figure)


def _motion(traces: Mapping[str, Trace], body: str, damper: str) -> str:
    plt = pyplot()
    figure, axes = plt.subplots(3, 1, figsize=(9, 6.4), sharex=True)
    for i, (law, trace) in enumerate(traces.items()):
        color: dict[str, Any] = {"color": CYCLE[i % len(CYCLE)], "linewidth": 0.9}
        axes[0].plot(trace["t_s"], 1e-3 * trace[f"{body}_true_um"], label=law, **color)
        axes[1].plot(trace["t_s"], 1e-3 * trace[f"{body}_true_mm_s2"], **color)
        axes[2].plot(trace["t_s"], 1e-3 * trace[f"{damper}_true_mA"], **color)
    axes[0].set_ylabel(f"{body}, mm")
    axes[1].set_ylabel(f"{body}, m/s2")
    axes[2].set_ylabel(f"current of {damper}, A")
    axes[2].set_xlabel("s")
    axes[0].legend(ncols=4, loc="lower right")
    return svg_of(figure)
