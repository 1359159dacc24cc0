"""Pictures of a rule base: its sets, its surface, and the difference of two."""

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.report.plot_style import COLORS, pyplot, svg_of
from quiesce.rules.model import FuzzySet, Input
from quiesce.rules.system.model import SetTerm, SystemInput
from quiesce.rules.views.subject import (
    AnyInput,
    AnyOutput,
    AnySet,
    Subject,
    membership,
    set_places,
    terms_of,
    values_of,
)
from quiesce.rules.views.surface import (
    CURVE_POINTS,
    Slice,
    axis_points,
    evaluate_slice,
    even_points,
    panel_points,
    panels,
)
from quiesce.rules.views.visits import CELLS, Visits, visited_cells

# Apart for colour-blind readers, for up to seven sets; more start again with another dash.
SET_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#4d4d4d")
DASHES = ("-", "--", ":", "-.")
SURFACE_MAP, DIFFERENCE_MAP = "YlGnBu", "RdBu_r"
VISITED = "#d55e00"
DEFAULT_NOTE = "hatched: no rule fires"
MESH_POINTS = 61  # of the view in three dimensions, along an axis


def save(figure: Any, folder: Path, name: str) -> str:
    """Writes NAME.png and NAME.svg, closes the figure, returns the SVG text."""
    figure.savefig(folder / f"{name}.png", dpi=130)
    svg = svg_of(figure)
    (folder / f"{name}.svg").write_text(svg, encoding="utf-8")
    return svg


def file_name(text: str) -> str:
    """A name from a rule file as part of a file's name."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", text).strip("_") or "output"


# Membership functions


def plot_memberships(base: Subject, visits: Visits | None = None) -> Any:
    """Inputs left, outputs right, with the share of time that a run spent at each place."""
    rows = max(len(base.inputs), len(base.outputs))
    figure, axes = pyplot().subplots(rows, 2, figsize=(11, 2.3 * rows + 0.3), squeeze=False)
    for row in range(rows):
        for column, variables in enumerate((base.inputs, base.outputs)):
            axis = axes[row, column]
            if row >= len(variables):
                axis.set_axis_off()
                continue
            if column == 0 and visits is not None:
                draw_time_share(axis, base.inputs[row], visits.inputs[row])
            draw_variable(axis, base, variables[row])
            axis.set_title(f"{'input' if column == 0 else 'output'} {variables[row].name}", pad=16)
        axes[row, 0].set_ylabel("membership")
    return figure


def draw_variable(axis: Any, base: Subject, variable: AnyInput | AnyOutput) -> None:
    """Sets or values, each with its name above it; of values that depend on something how far
    they reach."""
    terms = terms_of(variable)
    named: list[tuple[str, str, float]] = []  # above the axes: name, colour, place
    ends = [variable.minimum, variable.maximum]
    for index, term in enumerate(terms):
        color = SET_COLORS[index % len(SET_COLORS)]
        look = {"color": color, "linestyle": DASHES[index // len(SET_COLORS) % len(DASHES)]}
        if isinstance(term, FuzzySet | SetTerm):
            named.append((term.name, color, draw_set(axis, variable, term, look)))
            continue
        least, most = values_of(base, term)
        ends += [least, most]
        if least == most:
            axis.vlines(least, 0.0, 1.0, linewidth=2.0, **look)
            named.append((term.name, color, least))
        else:
            draw_reach(axis, term.name, (least, most), 1.0 - (index + 0.5) / len(terms), look)
    low, high = min(ends), max(ends)
    places = spread([x for _, _, x in named], (high - low) / 30)
    for (name, color, _), x in zip(named, places, strict=True):
        axis.text(x, 1.04, name, ha="center", va="bottom", color=color)
    axis.set_xlim(low - 0.02 * (high - low), high + 0.02 * (high - low))
    axis.set_ylim(0.0, 1.03)
    is_output = not isinstance(variable, Input | SystemInput)
    if is_output and variable.default is not None:
        axis.plot(variable.default, 0.0, "^", color=COLORS["muted"], clip_on=False, zorder=5,
                  label=f"default {variable.default:g}")  # fmt: skip
        legend_above(axis, 1.1)


def draw_reach(
    axis: Any, name: str, ends: tuple[float, float], height: float, look: dict[str, Any]
) -> None:
    """From the least to the largest of values that depend on something."""
    axis.hlines(height, *ends, linewidth=2.0, **look)
    axis.plot(ends, [height, height], "|", color=look["color"])
    axis.annotate(name, (ends[1], height), xytext=(4, 0), textcoords="offset points",
                  va="center", color=look["color"])  # fmt: skip


def spread(places: Sequence[float], distance: float) -> list[float]:
    """Moved right where needed, so that names do not cover each other."""
    moved = list(places)
    order = sorted(range(len(places)), key=lambda i: places[i])
    for before, after in zip(order, order[1:], strict=False):
        moved[after] = max(moved[after], moved[before] + distance)
    return moved


def legend_above(axis: Any, height: float = 1.0) -> None:
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, height), borderaxespad=0.1, ncols=2,
                handlelength=1.2, markerscale=0.7)  # fmt: skip


def draw_set(axis: Any, variable: AnyInput | AnyOutput, one: AnySet, look: dict[str, Any]) -> float:
    """Returns the middle of where it is greatest inside the universe."""
    x = set_places(variable, one)
    mu = membership(one, x)
    axis.plot(x, mu, linewidth=1.8, **look)
    axis.fill_between(x, mu, color=look["color"], alpha=0.08, linewidth=0)
    top = x[mu == mu.max()]
    return float(top.min() + top.max()) / 2


def draw_time_share(axis: Any, variable: AnyInput, values: np.ndarray) -> None:
    clamped = np.clip(values, variable.minimum, variable.maximum)
    counts, edges = np.histogram(clamped, CELLS, (variable.minimum, variable.maximum))
    axis.stairs(counts / counts.max(), edges, fill=True, color=COLORS["reference"], alpha=0.55,
                label="time spent there (highest = 1)")  # fmt: skip
    legend_above(axis, 1.1)


# Surfaces


def plot_output(base: Subject, index: int, cut: Slice, visits: Visits | None = None) -> Any:
    """A curve over one input, a map and a view in three dimensions over two; where other inputs
    are free, a map for each of their ends and middles."""
    if len(cut.axes) == 1:
        return plot_curve(base, index, cut, visits)
    if cut.free:
        return plot_panels(base, index, cut, visits)
    points = grid_of(base, cut)
    answer = evaluate_slice(base, cut, points)
    values = answer.outputs[index]
    plt = pyplot()
    figure = plt.figure(figsize=(11.5, 4.9))
    flat, solid = figure.add_gridspec(1, 2, width_ratios=[1.25, 1])
    axis = figure.add_subplot(flat)
    output = base.outputs[index]
    draw_map(axis, points, values, output, answer.is_default[index])
    draw_visits(axis, base, cut, visits)
    label_map(axis, base, cut, output)
    draw_solid(figure.add_subplot(solid, projection="3d"), base, index, cut)
    return figure


def grid_of(base: Subject, cut: Slice) -> list[np.ndarray]:
    count = panel_points(base, cut)
    return [even_points(base.inputs[i], count) for i in cut.axes]


def plot_panels(base: Subject, index: int, cut: Slice, visits: Visits | None) -> Any:
    """Maps of one colour scale. A run's visits are in the map that is nearest to them."""
    output, points, cuts = base.outputs[index], grid_of(base, cut), panels(base, cut)
    answers = [[evaluate_slice(base, one, points) for one in row] for row in cuts]
    every = np.array([[answer.outputs[index] for answer in row] for row in answers])
    look = dict(zip(("vmin", "vmax"), color_range(output, every), strict=True))
    rows, columns = len(cuts), len(cuts[0])
    figure, axes = pyplot().subplots(
        rows, columns, figsize=(3.5 * columns + 1.2, 3.0 * rows + 0.6), squeeze=False,
        sharex=True, sharey=True,
    )  # fmt: skip
    for line, row, some in zip(axes, cuts, answers, strict=True):
        for axis, one, answer in zip(line, row, some, strict=True):
            mesh = axis.pcolormesh(*points, answer.outputs[index].T, cmap=SURFACE_MAP,
                                   shading="gouraud", rasterized=True, **look)  # fmt: skip
            hatch(axis, points, answer.is_default[index], note=False)
            draw_visits(axis, base, one, visits and near(base, cut, one, visits), label=False)
            free = [f"{base.inputs[i].name} = {one.held[i]:g}" for i in cut.free]
            axis.set_title(", ".join(free))
            axis.grid(visible=False)
        line[0].set_ylabel(base.inputs[cut.axes[1]].name)
    for axis in axes[-1]:
        axis.set_xlabel(base.inputs[cut.axes[0]].name)
    figure.colorbar(mesh, ax=list(axes.flat), label=output.name, pad=0.02)
    is_default = any(one.is_default[index].any() for some in answers for one in some)
    notes = [DEFAULT_NOTE] if is_default else []
    notes += [] if visits is None else [visit_label(visits)]
    fixed = cut.fixed_text(base)
    title = f"{output.name} of {base.name}" + (f" at {fixed}" if fixed else "")
    figure.suptitle("; ".join([title, *notes]))
    return figure


def near(base: Subject, cut: Slice, one: Slice, visits: Visits) -> Visits:
    """Those for which no other panel's level of a free input is nearer."""
    is_near = np.ones(visits.inputs.shape[1], dtype=bool)
    for i in cut.free:
        variable = base.inputs[i]
        x = np.clip(visits.inputs[i], variable.minimum, variable.maximum)
        reach = 0.25 * (variable.maximum - variable.minimum)
        is_near &= np.abs(x - one.held[i]) <= reach
    return replace(visits, inputs=visits.inputs[:, is_near])


def draw_map(
    axis: Any,
    points: Sequence[np.ndarray],
    values: np.ndarray,
    output: AnyOutput,
    is_default: np.ndarray,
) -> None:
    low, high = color_range(output, values)
    mesh = axis.pcolormesh(*points, values.T, cmap=SURFACE_MAP, shading="gouraud", vmin=low,
                           vmax=high, rasterized=True)  # fmt: skip
    axis.figure.colorbar(mesh, ax=axis, label=output.name)
    ruled = np.where(is_default, np.nan, values)
    if has_contours(ruled):
        lines = axis.contour(*points, ruled.T, levels=9, colors="#33415c", linewidths=0.6)
        axis.clabel(lines, fontsize=9, fmt="%g")
    hatch(axis, points, is_default)


def color_range(output: AnyOutput, values: np.ndarray) -> tuple[float, float]:
    """The output's universe, wider where singletons lie outside."""
    found = values[np.isfinite(values)]
    low = min(output.minimum, found.min(initial=output.minimum))
    return low, max(output.maximum, found.max(initial=output.maximum))


def has_contours(values: np.ndarray) -> bool:
    found = values[np.isfinite(values)]
    return found.size > 0 and bool(np.ptp(found) > 0)


def hatch(
    axis: Any, points: Sequence[np.ndarray], is_default: np.ndarray, note: bool = True
) -> None:
    if is_default.any():
        axis.contourf(*points, is_default.T.astype(float), levels=[0.5, 1.5], colors="none",
                      hatches=["////"])  # fmt: skip
    if note and is_default.any():
        axis.text(0.01, 1.01, DEFAULT_NOTE, transform=axis.transAxes,
                  color=COLORS["muted"], ha="left", va="bottom")  # fmt: skip


def draw_visits(
    axis: Any, base: Subject, cut: Slice, visits: Visits | None, label: bool = True
) -> None:
    """Circles at visited cells, the larger the longer."""
    if visits is None or visits.inputs.shape[1] == 0:
        return
    (x, y), share = visited_cells(base, visits, cut.axes)
    axis.scatter(x, y, s=12 + 220 * np.sqrt(share), facecolors="none", edgecolors=VISITED,
                 linewidths=1.2, clip_on=False, label=visit_label(visits), zorder=4)  # fmt: skip
    if label:
        legend_above(axis)


def visit_label(visits: Visits) -> str:
    return f"visited in {Path(visits.name).name} (size: time spent)"


def label_map(axis: Any, base: Subject, cut: Slice, output: AnyOutput) -> None:
    axis.set_xlabel(base.inputs[cut.axes[0]].name)
    axis.set_ylabel(base.inputs[cut.axes[1]].name)
    axis.set_title(title_of(base, cut, output), pad=16)
    axis.grid(visible=False)


def title_of(base: Subject, cut: Slice, output: AnyOutput) -> str:
    held = cut.text(base)
    return f"{output.name} of {base.name}" + (f" at {held}" if held else "")


def draw_solid(axis: Any, base: Subject, index: int, cut: Slice) -> None:
    points = [even_points(base.inputs[i], MESH_POINTS) for i in cut.axes]
    values = evaluate_slice(base, cut, points).outputs[index]
    low, high = color_range(base.outputs[index], values)
    x, y = np.meshgrid(*points, indexing="ij")
    axis.plot_surface(x, y, np.ma.masked_invalid(values), cmap=SURFACE_MAP, vmin=low, vmax=high,
                      rstride=1, cstride=1, linewidth=0.15, edgecolor="#33415c",
                      rasterized=True)  # fmt: skip
    axis.set_zlim(low, high)
    axis.set_xlabel(base.inputs[cut.axes[0]].name)
    axis.set_ylabel(base.inputs[cut.axes[1]].name)
    for one in (axis.xaxis, axis.yaxis, axis.zaxis):
        one.set_major_locator(pyplot().MaxNLocator(5))
    axis.view_init(elev=28, azim=-125)
    axis.set_box_aspect((1.2, 1.0, 0.65), zoom=0.9)


def plot_curve(base: Subject, index: int, cut: Slice, visits: Visits | None) -> Any:
    output, variable = base.outputs[index], base.inputs[cut.axes[0]]
    x = axis_points(variable, CURVE_POINTS)
    answer = evaluate_slice(base, cut, [x])
    figure, axis = pyplot().subplots(figsize=(9, 3.8))
    axis.plot(x, answer.outputs[index], color=COLORS["main"], linewidth=1.8)
    if answer.is_default[index].any():
        shade_default(axis, x, answer.is_default[index])
    if visits is not None:
        (at,), share = visited_cells(base, visits, cut.axes)
        values = evaluate_slice(base, cut, [at]).outputs[index]
        axis.scatter(at, values, s=12 + 220 * np.sqrt(share), facecolors="none",
                     edgecolors=VISITED, label=visit_label(visits), zorder=4)  # fmt: skip
    if axis.get_legend_handles_labels()[0]:
        legend_above(axis)
    axis.set_xlabel(variable.name)
    axis.set_ylabel(output.name)
    axis.set_title(title_of(base, cut, output))
    return figure


def shade_default(axis: Any, x: np.ndarray, is_default: np.ndarray) -> None:
    axis.fill_between(x, 0, 1, where=is_default, transform=axis.get_xaxis_transform(),
                      color=COLORS["shade"], linewidth=0, label="no rule fires",
                      zorder=0)  # fmt: skip
