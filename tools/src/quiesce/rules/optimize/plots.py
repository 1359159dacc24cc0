"""The figures of a search's report, each as SVG text."""

from itertools import combinations
from typing import Any

import numpy as np

from quiesce.report.plot_style import COLORS, pyplot, svg_of
from quiesce.rules.model import RuleBase
from quiesce.rules.optimize.result import Found, bound_of
from quiesce.rules.reference import evaluate

POINTS = 101


def plot_convergence(found: Found) -> str:
    """Cost against rule bases tried: the best so far and each generation's mean."""
    figure, axis = pyplot().subplots(figsize=(11, 3.2))
    history = found.history
    axis.plot(history.evaluations, history.mean, color=COLORS["muted"], marker=".",
              label="mean of the generation")  # fmt: skip
    axis.plot(history.evaluations, history.best, color=COLORS["main"], marker=".",
              label="best so far")  # fmt: skip
    for name, outcome, color in (
        ("start", found.start_outcome, "current"),
        ("best constant currents", found.constant_outcome, "constant_best"),
    ):
        axis.axhline(found.objective.cost(outcome), color=COLORS[color], linestyle="--", label=name)
    axis.set(xlabel="rule bases tried", ylabel="cost (%)")
    axis.legend()
    return svg_of(figure)


def surface(base: RuleBase) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Both inputs' axes and the output over them, [second, first]."""
    first, second = (np.linspace(v.minimum, v.maximum, POINTS) for v in base.inputs)
    output = evaluate(base, [first[None, :], second[:, None]]).outputs[0]
    return first, second, output


def plot_surfaces(found: Found) -> str:
    """The rule surface before and after, with where the scenarios settle."""
    figure, axes = pyplot().subplots(1, 2, figsize=(11, 3.8), sharey=True)
    output = found.start.outputs[0]
    for axis, title, base, outcome in (
        (axes[0], "start", found.start, found.start_outcome),
        (axes[1], "found", found.best, found.best_outcome),
    ):
        first, second, values = surface(base)
        mesh = axis.pcolormesh(
            first, second, values, cmap="YlGnBu", shading="nearest", rasterized=True,
            vmin=output.minimum, vmax=output.maximum,
        )  # fmt: skip
        left = [1.0 - steady.accel_rms_reduction_pct / 100.0 for steady in outcome]
        rms_m_s2 = [1e-3 * p.accel_rms_mm_s2 * s for p, s in zip(found.places, left, strict=True)]
        axis.plot([p.freq_Hz for p in found.places], rms_m_s2, "o", markerfacecolor="none",
                  color=COLORS["current"], label="where the scenarios settle")  # fmt: skip
        axis.set(title=title, xlabel="frequency (Hz)")
        axis.set_xlim(first[0], first[-1])
        axis.set_ylim(second[0], second[-1])
        axis.grid(visible=False)
    axes[0].set_ylabel("RMS acceleration (m/s²)")
    axes[1].legend(loc="upper left", frameon=True)
    figure.colorbar(mesh, ax=axes, label="current (A)")
    return svg_of(figure)


def plot_places(found: Found) -> str:
    """Reductions and current by frequency: start, found, best constant, any waveform."""
    figure, axes = pyplot().subplots(1, 3, figsize=(11, 3.4), sharex=True)
    order = sorted(range(len(found.places)), key=lambda i: found.places[i].freq_Hz)
    freqs = [found.places[i].freq_Hz for i in order]
    curves = (
        ("start", found.start_outcome, {"color": COLORS["current"], "marker": "s"}),
        ("found", found.best_outcome, {"color": COLORS["main"], "marker": "o"}),
        ("best constant", found.constant_outcome,
         {"color": COLORS["constant_best"], "marker": "_", "markersize": 9}),
    )  # fmt: skip
    keys = ("amp_reduction_pct", "accel_rms_reduction_pct", "mean_current_A")
    for axis, key in zip(axes, keys, strict=True):
        for label, outcome, style in curves:
            values = [getattr(outcome[i], key) for i in order]
            axis.plot(freqs, values, linestyle="", label=label, fillstyle="none", **style)
        axis.set_xlabel("frequency (Hz)")
    draw_bounds(axes, found)
    for axis, title in zip(
        axes,
        ("displacement, reduction (%)", "RMS acceleration, reduction (%)", "mean current (A)"),
        strict=True,
    ):
        axis.set_title(title)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=len(labels))
    return svg_of(figure)


def draw_bounds(axes: Any, found: Found) -> None:
    known = [(place.freq_Hz, bound_of(place)) for place in found.places]
    bounds = sorted((freq_Hz, bound) for freq_Hz, bound in known if bound is not None)
    for axis, part in zip(axes[:2], (0, 1), strict=True):
        if bounds:
            axis.plot([f for f, _ in bounds], [b[part] for _, b in bounds], color=COLORS["bound"],
                      linewidth=1, linestyle=":", label="any waveform")  # fmt: skip


def plot_front(found: Found) -> str:
    """The Pareto front, one axis for every pair of objectives; empty without one."""
    names = found.objective.names
    pairs = list(combinations(range(len(names)), 2))
    if not found.front or not pairs:
        return ""
    figure, axes = pyplot().subplots(1, len(pairs), figsize=(11, 3.6), squeeze=False)
    costs = np.array([point.costs for point in found.front])
    start = found.objective.several([found.start_outcome])[0]
    for axis, (i, j) in zip(axes[0], pairs, strict=True):
        axis.plot(costs[:, i], costs[:, j], "o", color=COLORS["main"], markersize=4, label="front")
        axis.plot(start[i], start[j], "s", color=COLORS["current"], label="start")
        axis.set(xlabel=f"{names[i]} left (%)", ylabel=f"{names[j]} left (%)")
    axes[0, 0].legend()
    return svg_of(figure)
