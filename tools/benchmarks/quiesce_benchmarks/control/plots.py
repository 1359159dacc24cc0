"""The plots of `./tools/benchmark control`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from quiesce.report.plot_style import COLORS, pyplot, svg_of

from quiesce_benchmarks.control.adaptation import Trajectory
from quiesce_benchmarks.control.broadband import ChirpResult, Input
from quiesce_benchmarks.control.rig import SETTINGS
from quiesce_benchmarks.control.robust import DRIVES_V, FORCES, STRUCTURES, Cell, FREQS_Hz, LAGS_s
from quiesce_benchmarks.control.ruler import Ruler
from quiesce_benchmarks.control.steady import Point
from quiesce_benchmarks.control.steps import EARLY_s, StepResult

SETTING_COLORS = {"displacement": "main", "balanced": "constant_best"}
STEP_COLORS = {**SETTING_COLORS, "fuzzy": "current", "constant": "reference"}


def write(folder: Path, name: str, figure: Any) -> None:
    (folder / name).write_text(svg_of(figure), encoding="utf-8")


def plot_sweep(folder: Path, points: Sequence[Point], ruler: Ruler) -> None:
    """Reductions over frequency: displacement left, acceleration right."""
    figure, axes = pyplot().subplots(1, 2, figsize=(12, 4.2))
    freqs_Hz = [point.freq_Hz for point in points]
    bounds = [ruler.bound(freq_Hz) for freq_Hz in freqs_Hz]
    for axis, key, title in (
        (axes[0], "amp_pct", "Displacement, half peak-to-peak"),
        (axes[1], "accel_pct", "RMS acceleration"),
    ):
        lines = {
            "full constant current": ("reference", "-", [getattr(p.full, key) for p in points]),
            "fuzzy": ("current", "-", [getattr(p.fuzzy, key) for p in points]),
        }
        for name in SETTINGS:
            color = SETTING_COLORS[name]
            values = [getattr(p.adapted[name], key) for p in points]
            lines[name] = (color, "-", values)
            table = [getattr(p.shipped[name], key) for p in points]
            lines[f"{name}, table alone"] = (color, ":", table)
        lines["bound"] = ("bound", "--", as_floats(getattr(b, key) for b in bounds))
        for label, (color, style, values) in lines.items():
            axis.plot(freqs_Hz, values, style, color=COLORS[color], label=label)
        if key == "amp_pct":
            limit = as_floats(b.balanced_amp_pct for b in bounds)
            label = "bound, acceleration >= 0"
            axis.plot(freqs_Hz, limit, "-.", color=COLORS["muted"], label=label)
        axis.set(title=title, xlabel="frequency (Hz)", ylabel="reduction against 0 A (%)")
        axis.legend()
    write(folder, "sweep.svg", figure)


def as_floats(numbers: Any) -> list[float]:
    return [np.nan if value is None else value for value in numbers]


def plot_robust(folder: Path, cells: Sequence[Cell]) -> None:
    """A map for each frequency: share of that plant's bound, or points over its best constant."""
    has_bound = all(cell.fraction is not None for cell in cells)
    rows = [(drive_V, freq) for drive_V in DRIVES_V for freq in STRUCTURES]
    columns = [(lag_s, force) for lag_s in LAGS_s for force in FORCES]
    figure, axes = pyplot().subplots(1, len(FREQS_Hz), figsize=(14, 3.6), squeeze=False)
    for axis, freq_Hz in zip(axes[0], FREQS_Hz, strict=True):
        grid = np.full((len(rows), len(columns)), np.nan)
        for cell in (one for one in cells if one.freq_Hz == freq_Hz):
            plant = cell.variation.variant
            row = rows.index((plant.drive_V, plant.freq))
            column = columns.index((plant.rise_s, plant.force))
            value = cell.fraction if has_bound else -cell.below_constant_pts
            grid[row, column] = np.nan if value is None else value
        limits = {"vmin": 0.8, "vmax": 1.0} if has_bound else {"vmin": -5.0, "vmax": 15.0}
        image = axis.imshow(grid, aspect="auto", cmap="viridis", **limits)
        axis.set_title(f"{freq_Hz:g} Hz, least {np.nanmin(grid) + 0.0:.2f}")
        axis.set_xticks(range(len(columns)), [f"{1e3 * lag:g}/{k:g}" for lag, k in columns])
        axis.tick_params(axis="x", rotation=70)
        axis.set_yticks(range(len(rows)), [f"{v:g} V {100 * (f - 1):+.0f} %" for v, f in rows])
        axis.set_xlabel("coil lag (ms) / damper force")
        axis.grid(False)
    label = "share of the bound" if has_bound else "points over best constant"
    figure.colorbar(image, ax=axes[0, -1]).set_label(label)
    write(folder, "robust.svg", figure)


def plot_steps(folder: Path, steps: Sequence[StepResult]) -> None:
    """Displacement and current around the changes at 4 s."""
    shown = [one for one in steps if one.at_s == EARLY_s and one.control in STEP_COLORS]
    changes = sorted({(one.from_Hz, one.to_Hz) for one in shown})
    figure, axes = pyplot().subplots(
        2, len(changes), figsize=(12, 5), sharex=True, squeeze=False, height_ratios=[2, 1]
    )
    for column, change in enumerate(changes):
        for one in (s for s in shown if (s.from_Hz, s.to_Hz) == change):
            time_s = one.trace["t_s"] - one.at_s
            near = (time_s > -0.5) & (time_s < 1.5)
            style = {"color": COLORS[STEP_COLORS[one.control]], "label": one.control}
            style |= {"linewidth": 0.9}
            axes[0, column].plot(time_s[near], one.trace["x5_um"][near], **style)
            axes[1, column].plot(time_s[near], one.trace["coil_A"][near], **style)
        axes[0, column].set_title(f"{change[0]:g} to {change[1]:g} Hz")
        axes[1, column].set_xlabel("time after the change (s)")
    axes[0, 0].set_ylabel("displacement (um)")
    axes[1, 0].set_ylabel("coil current (A)")
    axes[0, 0].legend()
    write(folder, "steps.svg", figure)


def plot_broadband(folder: Path, inputs: Sequence[Input]) -> None:
    """Ratios to the best constant current, input by input."""
    figure, axes = pyplot().subplots(1, 2, figsize=(11, 0.28 * len(inputs) + 1.5), sharey=True)
    places = np.arange(len(inputs))[::-1]
    for axis, ratio, title in (
        (axes[0], Input.disp_ratio, "RMS displacement"),
        (axes[1], Input.accel_ratio, "RMS acceleration"),
    ):
        for shift, name in zip((0.12, -0.12), SETTINGS, strict=True):
            values = [ratio(one, name) for one in inputs]
            axis.plot(values, places + shift, "o", color=COLORS[SETTING_COLORS[name]], label=name)
        axis.axvline(1.0, color=COLORS["bound"], linewidth=0.8)
        axis.axvline(1.02, color=COLORS["muted"], linestyle="--", linewidth=0.8, label="goal")
        axis.set(title=title, xlabel="over the best constant current")
    axes[0].set_yticks(places, [one.name for one in inputs])
    axes[1].legend()
    write(folder, "broadband.svg", figure)


def plot_chirp(folder: Path, chirp: ChirpResult) -> None:
    figure, axis = pyplot().subplots(figsize=(8, 3.6))
    colors = {"open loop": "open_loop", "constant": "reference", **SETTING_COLORS}
    for name, peaks_um in chirp.peaks_um.items():
        axis.plot(chirp.freq_Hz, peaks_um, color=COLORS[colors[name]], label=name, linewidth=1.0)
    axis.set(xlabel="frequency of the chirp (Hz)", ylabel="half peak-to-peak of a cycle (um)")
    axis.legend()
    write(folder, "chirp.svg", figure)


def plot_adaptation(folder: Path, trajectories: Sequence[Trajectory]) -> None:
    """Reduction and trims over time, from a cold start at 5 Hz."""
    figure, axes = pyplot().subplots(
        2, len(trajectories), figsize=(13, 5), sharex=True, squeeze=False
    )
    for column, one in enumerate(trajectories):
        axes[0, column].plot(np.arange(len(one.amp_pct)) + 0.5, one.amp_pct, color=COLORS["main"])
        axes[0, column].set_title(one.label)
        axes[1, column].set_xlabel("time (s)")
        if one.trims:
            time_s, axis = one.trims["t_s"], axes[1, column]
            axis.plot(time_s, 1e-3 * one.trims["trim_on_mdeg"], label="first edge (degrees)")
            axis.plot(time_s, 1e-3 * one.trims["trim_off_mdeg"], label="last edge (degrees)")
            level_pct = 100.0 * one.trims["trim_level_q15"] / 32768.0 - 100.0
            axis.plot(time_s, level_pct, label="level (%)")
    axes[0, 0].set_ylabel("displacement reduction (%)")
    axes[1, 0].set_ylabel("trim")
    if trajectories[0].trims:
        axes[1, 0].legend()
    write(folder, "adaptation.svg", figure)
