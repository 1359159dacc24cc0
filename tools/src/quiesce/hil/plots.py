"""The figures of the report, each as SVG text."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from quiesce.engine import laws
from quiesce.hil.metrics import Result, amplitude_spectrum, excitation_text
from quiesce.hil.rule_surface import RuleSurface, visited_cells
from quiesce.hil.runs import ConstantSearch, Run, displacement_um, reduction_pct
from quiesce.report.plot_style import COLORS, pyplot, svg_of

PERIODS_SHOWN = 3
BROADBAND_SHOWN_s = 2.0
STEP_BEFORE_s, STEP_AFTER_s = 0.4, 1.4
SPECTRUM_TOP_Hz = 60.0
# Drawn in this order, ever thinner, so that of equal curves all stay visible.
LINE_WIDTHS = {
    "constant_best": 3.2,
    "fuzzy_selftune_printed_gated": 2.6,
    "fuzzy_selftune_reversed": 2.2,
    "open_loop": 1.6,
    "fuzzy_selftune_reversed_ungated": 1.3,
    "fuzzy_selftune_printed": 1.2,
    "fuzzy": 1.1,
    "phase": 1.1,
    "phase_displacement": 1.1,
}
CELL_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")


def one_run_a_law(runs: Sequence[Run], scenario: str) -> dict[str, Run]:
    """Runs of a scenario by law, on the host where there is a choice."""
    found: dict[str, Run] = {}
    for run in sorted(runs, key=lambda run: run.case.target != "host"):
        if run.case.scenario.name == scenario:
            found.setdefault(run.case.law.name, run)
    return {name: found[name] for name in laws.names() if name in found}


def label(law: str) -> str:
    return laws.find(law).label


def line_style(law: str) -> dict[str, Any]:
    return {
        "color": COLORS[law],
        "label": label(law),
        "linewidth": LINE_WIDTHS[law],
        "zorder": 2.0 + 0.1 * list(LINE_WIDTHS).index(law),
    }


def scenario_names(runs: Sequence[Run], is_step: bool) -> list[str]:
    chosen = [r.case.scenario.name for r in runs if r.case.scenario.is_step == is_step]
    return list(dict.fromkeys(chosen))


def figure_legend(figure: Any, axes: Any) -> None:
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=len(labels))


def plot_reductions(result: Result) -> str:
    """Bars of our reductions in the steady scenarios, with what they are compared with."""
    rows = [(r, b) for r, b in result.plain if r.settle_s is None]
    rows = [(r, b) for r, b in rows if r.law != laws.OPEN_LOOP and r.amp_reduction_pct is not None]
    if not rows:
        return ""
    figure, axes = pyplot().subplots(1, 2, figsize=(11, 3.6))
    titles = ("displacement amplitude", "RMS acceleration")
    for axis, title, key in zip(axes, titles, ("amp", "accel_rms"), strict=True):
        draw_reductions(axis, rows, f"{key}_reduction_pct", f"bound_{key}_pct")
        axis.set_title(title)
        axis.axhline(0.0, color="#333333", linewidth=0.8)
    axes[0].set_ylabel("reduction against open loop (%)")
    figure_legend(figure, axes[0])
    return svg_of(figure)


def draw_reductions(axis: Any, rows: Sequence[Any], key: str, bound_key: str) -> None:
    freqs = sorted({row.freq_hz for row, _ in rows})
    names = [name for name in laws.names() if any(row.law == name for row, _ in rows)]
    width = 0.8 / len(names)
    seen: set[str] = set()

    def once(text: str) -> str | None:
        is_new = text not in seen
        seen.add(text)
        return text if is_new else None

    drawn: set[tuple[float, str]] = set()
    for row, beside in rows:
        if (row.freq_hz, row.law) in drawn:
            continue
        drawn.add((row.freq_hz, row.law))
        x = freqs.index(row.freq_hz) - 0.4 + (names.index(row.law) + 0.5) * width
        ours, sim = getattr(row, key), beside.simulated.get(key)
        axis.bar(x, ours, 0.9 * width, color=COLORS[row.law], label=once(label(row.law)))
        if sim is not None:
            axis.plot(x, sim, "o", color="white", markeredgecolor="black", markersize=4,
                      label=once("independent simulation"))  # fmt: skip
        if beside.published and key == "amp_reduction_pct":
            middle = (beside.published.low_pct + beside.published.high_pct) / 2
            axis.errorbar(x, middle, middle - beside.published.low_pct, fmt="D", markersize=4,
                          color="black", capsize=3, label=once("published"))  # fmt: skip
        bound = getattr(row, bound_key)
        if bound is not None:
            axis.hlines(bound, x - width / 2, x + width / 2, color="black", linewidth=1.6,
                        label=once("bound"))  # fmt: skip
    axis.set_xticks(range(len(freqs)), [excitation_text(freq) for freq in freqs])
    axis.grid(axis="x", visible=False)


def plot_steady(runs: Sequence[Run]) -> str:
    """The last periods of the steady scenarios: displacement, acceleration, current."""
    names = scenario_names(runs, is_step=False)
    if not names:
        return ""
    figure, axes = pyplot().subplots(3, len(names), figsize=(11, 5.2), squeeze=False, sharex="col")
    columns = (
        ("x5_um", 1.0, "displacement (µm)"),
        ("a5_mm_s2", 1e-3, "acceleration (m/s²)"),
        ("coil_A", 1.0, "coil current (A)"),
    )
    for column, name in zip(axes.T, names, strict=True):
        for law, run in one_run_a_law(runs, name).items():
            freq_Hz = run.figures["freq_hz"]
            span_s = PERIODS_SHOWN / freq_Hz if freq_Hz > 0.0 else BROADBAND_SHOWN_s
            time_s = run.trace["t_s"] - run.trace["t_s"][-1]
            last = time_s > -span_s
            for axis, (key, scale, _) in zip(column, columns, strict=True):
                axis.plot(time_s[last], scale * run.trace[key][last], **line_style(law))
        column[0].set_title(name)
        column[2].set_xlabel("time before the end (s)")
    for axis, (_, _, text) in zip(axes[:, 0], columns, strict=True):
        axis.set_ylabel(text)
    figure.align_ylabels(axes[:, 0])
    figure_legend(figure, axes[0, 0])
    return svg_of(figure)


def plot_rig(runs: Sequence[Run], name: str) -> str:
    """The last seconds of a rig: displacement of each body, force and current of each damper."""
    found = one_run_a_law(runs, name)
    board = next(iter(found.values())).case.scenario.board
    curves = [(f"{body}_true_um", 1e-3, f"{body} (mm)") for body in board.bodies]
    for damper in board.dampers:
        curves.append((f"{damper}_true_force_mN", 1e-3, f"{damper} (N)"))
        curves.append((f"{damper}_true_mA", 1e-3, f"{damper} (A)"))
    figure, axes = pyplot().subplots(
        len(curves), 1, figsize=(11, 0.6 + 1.3 * len(curves)), squeeze=False, sharex=True
    )
    for law, run in found.items():
        time_s = run.trace["t_s"] - run.trace["t_s"][-1]
        last = time_s > -BROADBAND_SHOWN_s
        for axis, (key, scale, _) in zip(axes[:, 0], curves, strict=True):
            axis.plot(time_s[last], scale * run.trace[key][last], **line_style(law))
    for axis, (_, _, text) in zip(axes[:, 0], curves, strict=True):
        axis.set_ylabel(text)
    axes[-1, 0].set_xlabel("time before the end (s)")
    figure.align_ylabels(axes[:, 0])
    figure_legend(figure, axes[0, 0])
    return svg_of(figure)


def plot_step(runs: Sequence[Run], name: str) -> str:
    """Displacement, current and estimated frequency around the step."""
    chosen = one_run_a_law(runs, name)
    figure, axes = pyplot().subplots(3, 1, figsize=(11, 6), sharex=True, height_ratios=[3, 2, 2])
    for law, run in chosen.items():
        step_s = run.case.scenario.transient_s or 0.0
        time_s = run.trace["t_s"] - step_s
        near = (time_s > -STEP_BEFORE_s) & (time_s < STEP_AFTER_s)
        style = line_style(law)
        axes[0].plot(time_s[near], run.trace["x5_um"][near], **style)
        axes[1].plot(time_s[near], run.trace["coil_A"][near], **style)
        freq_Hz = np.where(run.trace["freq_is_valid"] > 0, run.trace["freq_uHz"] * 1e-6, np.nan)
        axes[2].plot(time_s[near], freq_Hz[near], **{**style, "label": None})
    figures = next(iter(chosen.values())).figures
    true_Hz = [figures["freq_hz"], figures["freq_hz"], figures["freq2_hz"], figures["freq2_hz"]]
    axes[2].plot([-STEP_BEFORE_s, 0, 0, STEP_AFTER_s], true_Hz, color="black", linewidth=0.9,
                 linestyle="--", label="excitation")  # fmt: skip
    axes[2].legend(loc="lower right")
    texts = ("displacement (µm)", "coil current (A)", "frequency (Hz),\nwhere valid")
    for axis, text in zip(axes, texts, strict=True):
        axis.set_ylabel(text)
        axis.axvline(0.0, color="#777777", linewidth=0.8)
    axes[2].set_xlabel("time after the step (s)")
    axes[2].set_xlim(-STEP_BEFORE_s, STEP_AFTER_s)
    figure.align_ylabels(axes)
    figure_legend(figure, axes[0])
    return svg_of(figure)


def plot_spectra(runs: Sequence[Run]) -> str:
    """Amplitude spectra of the acceleration in the steady state."""
    names = scenario_names(runs, is_step=False)
    if not names:
        return ""
    figure, axes = pyplot().subplots(1, len(names), figsize=(11, 3.0), squeeze=False, sharey=True)
    for axis, name in zip(axes[0], names, strict=True):
        for law, run in one_run_a_law(runs, name).items():
            windows_s = run.case.scenario.windows_s or ((0.0, run.trace["t_s"][-1]),)
            freq_Hz, amp_mm_s2 = amplitude_spectrum(run.trace, *windows_s[-1])
            shown = (freq_Hz > 0.5) & (freq_Hz <= SPECTRUM_TOP_Hz)
            axis.semilogy(freq_Hz[shown], np.maximum(amp_mm_s2[shown], 1e-3), **line_style(law))
        axis.set_title(name)
        axis.set_xlabel("frequency (Hz)")
    axes[0, 0].set_ylim(0.05, 1000.0)
    axes[0, 0].set_ylabel("acceleration (mm/s²)")
    figure_legend(figure, axes[0, 0])
    return svg_of(figure)


def plot_surface(surface: RuleSurface, runs: Sequence[Run]) -> str:
    """The rule surface with the cells that the fuzzy law visited, by scenario."""
    figure, axis = pyplot().subplots(figsize=(11, 4.4))
    mesh = axis.pcolormesh(
        surface.freq_Hz, surface.rms_m_s2, surface.current_A, cmap="YlGnBu", shading="nearest",
        rasterized=True,
    )  # fmt: skip
    figure.colorbar(mesh, ax=axis, label="current (A)")
    visitors = [run for run in runs if run.case.law.name == "fuzzy"]
    names = list(dict.fromkeys(run.case.scenario.name for run in visitors))
    for name, marker in zip(names, CELL_MARKERS, strict=False):
        run = one_run_a_law(visitors, name)["fuzzy"]
        axis.plot(*visited_cells(surface, run.trace), linestyle="", marker=marker, markersize=5,
                  markerfacecolor="none", markeredgewidth=1.2, label=name,
                  color=f"C{1 + names.index(name)}")  # fmt: skip
    if names:
        axis.legend(loc="upper left", frameon=True, title="cells visited by the fuzzy law")
    axis.grid(visible=False)
    axis.set_xlabel("dominant frequency (Hz)")
    axis.set_ylabel("RMS acceleration (m/s²)")
    return svg_of(figure)


def plot_searches(searches: Sequence[ConstantSearch]) -> str:
    """What each constant current achieves."""
    steady = [search for search in searches if not search.scenario.is_step]
    if not steady:
        return ""
    figure, axes = pyplot().subplots(1, 2, figsize=(11, 3.0), sharex=True)
    for search in steady:
        current_A = [mA / 1000.0 for mA in search.current_mA]
        found = search.figures
        displacements = [displacement_um(figures) for figures in found]
        accelerations = [figures["accel_rms_mm_s2"] for figures in found]
        for axis, values in zip(axes, (displacements, accelerations), strict=True):
            reductions = [reduction_pct(value, values[0]) for value in values]
            axis.plot(current_A, reductions, marker="o", markersize=3,
                      label=search.scenario.name)  # fmt: skip
    for axis, title in zip(axes, ("displacement amplitude", "RMS acceleration"), strict=True):
        axis.set_title(title)
        axis.set_xlabel("constant current (A)")
        axis.axhline(0.0, color="#333333", linewidth=0.8)
    axes[0].set_ylabel("reduction against 0 A (%)")
    figure_legend(figure, axes[0])
    return svg_of(figure)
