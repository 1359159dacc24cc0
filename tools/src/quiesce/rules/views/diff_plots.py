"""Pictures of two rule bases side by side, and of their difference."""

from pathlib import Path
from typing import Any

import numpy as np

from quiesce.report.plot_style import COLORS, pyplot
from quiesce.rules.model import RuleBase
from quiesce.rules.views.compare import OutputDifference, differences
from quiesce.rules.views.plots import DIFFERENCE_MAP, SURFACE_MAP, color_range, hatch
from quiesce.rules.views.surface import GRID_POINTS, Slice, evaluate_slice

CURVE_POINTS = 2001


def common_points(one: RuleBase, other: RuleBase, cut: Slice, count: int) -> list[np.ndarray]:
    """Evenly over the universes of both."""
    return [
        np.linspace(
            min(one.inputs[i].minimum, other.inputs[i].minimum),
            max(one.inputs[i].maximum, other.inputs[i].maximum),
            count,
        )
        for i in cut.axes
    ]


def plot_difference(
    one: RuleBase, other: RuleBase, index: int, cut: Slice, found: OutputDifference
) -> Any:
    """A, B and B - A, with the place of the largest difference where the slice holds it."""
    if len(cut.axes) == 1:
        return plot_curves(one, other, index, cut, found)
    points = common_points(one, other, cut, GRID_POINTS)
    answers = [evaluate_slice(base, cut, points) for base in (one, other)]
    values = [answer.outputs[index] for answer in answers]
    figure, axes = pyplot().subplots(1, 3, figsize=(11.5, 3.8), sharex=True, sharey=True)
    spans = [color_range(b.outputs[index], v) for b, v in zip((one, other), values, strict=True)]
    look = {"cmap": SURFACE_MAP, "vmin": min(s[0] for s in spans), "vmax": max(s[1] for s in spans)}
    for axis, letter, base, value, answer in zip(
        axes, "AB", (one, other), values, answers, strict=False
    ):
        mesh = draw(axis, points, value, look)
        hatch(axis, points, answer.is_default[index])
        axis.set_title(f"{letter}: {Path(base.name).name}", pad=16)
    figure.colorbar(mesh, ax=list(axes[:2]), label=found.name, pad=0.02)
    draw_change(axes[2], points, values[1] - values[0], found.name)
    mark(axes[2], one, cut, found)
    for axis in axes:
        axis.set_xlabel(one.inputs[cut.axes[0]].name)
        axis.grid(visible=False)
    axes[0].set_ylabel(one.inputs[cut.axes[1]].name)
    if cut.text(one):
        figure.suptitle(f"at {cut.text(one)}", x=0.99, ha="right", fontsize=9)
    return figure


def draw(axis: Any, points: list[np.ndarray], values: np.ndarray, look: dict[str, Any]) -> Any:
    return axis.pcolormesh(*points, values.T, shading="nearest", rasterized=True, **look)


def draw_change(axis: Any, points: list[np.ndarray], change: np.ndarray, name: str) -> None:
    most = float(np.nanmax(np.abs(change))) if np.isfinite(change).any() else 0.0
    limit = most or 1.0
    mesh = draw(axis, points, change, {"cmap": DIFFERENCE_MAP, "vmin": -limit, "vmax": limit})
    axis.figure.colorbar(mesh, ax=axis, label=f"difference of {name}")
    axis.set_title("B - A" if most else "B - A: no difference in this picture", pad=16)


def mark(axis: Any, one: RuleBase, cut: Slice, found: OutputDifference) -> None:
    """The largest difference, where this slice goes through it."""
    is_here = all(
        i in cut.axes or np.isclose(cut.held[i], x, rtol=1e-9, atol=0)
        for i, x in enumerate(found.at)
    )
    if found.is_same or not is_here:
        return
    x, y = (found.at[i] for i in cut.axes)
    axis.plot(x, y, "o", markersize=9, markerfacecolor="none", markeredgecolor="black",
              clip_on=False, label="largest difference")  # fmt: skip
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1)


def plot_curves(
    one: RuleBase, other: RuleBase, index: int, cut: Slice, found: OutputDifference
) -> Any:
    (x,) = common_points(one, other, cut, CURVE_POINTS)
    a, b = (evaluate_slice(base, cut, [x]).outputs[index] for base in (one, other))
    figure, axes = pyplot().subplots(2, 1, figsize=(9, 5.4), sharex=True, height_ratios=[2, 1])
    axes[0].plot(x, a, color=COLORS["main"], linewidth=2.4, label=f"A: {Path(one.name).name}")
    axes[0].plot(x, b, color=COLORS["current"], linewidth=1.3, label=f"B: {Path(other.name).name}")
    axes[0].set_ylabel(found.name)
    axes[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=2)
    axes[1].plot(x, b - a, color=COLORS["bound"], linewidth=1.1)
    axes[1].fill_between(
        x, b - a, where=differences(a, b) > found.threshold, color=COLORS["reference"], alpha=0.6,
        linewidth=0, label=f"beyond {found.threshold:g}",
    )  # fmt: skip
    axes[1].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1)
    axes[1].set_ylabel("B - A")
    axes[1].set_xlabel(one.inputs[cut.axes[0]].name)
    if cut.text(one):
        axes[0].set_title(f"at {cut.text(one)}")
    figure.align_ylabels(axes)
    return figure
