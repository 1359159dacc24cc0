"""The plots of `quiesce tune`, each as a figure of matplotlib."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from quiesce.report.plot_style import COLORS, pyplot
from quiesce.tune.cycle import Cycle
from quiesce.tune.law import Row
from quiesce.tune.phase_table import SETTINGS, PhaseLaw, interpolated
from quiesce.tune.robust import Cell

SETTING_COLORS = dict(zip(SETTINGS, ("main", "current"), strict=True))
PHASES, MAP_ROWS = 180, 240
LOOP_POINTS = 100
REDUCTIONS = (
    ("amp_red_pct", "Displacement, half peak-to-peak", "amp"),
    ("accel_red_pct", "RMS acceleration", "accel"),
)


def plot_reductions(rows: Sequence[Row]) -> Any:
    figure, axes = pyplot().subplots(1, 2, figsize=(10.5, 3.8))
    points = [row for row in rows if not row.is_between]
    freqs_Hz = [row.freq_Hz for row in points]
    for axis, (key, title, bound) in zip(axes, REDUCTIONS, strict=True):
        best = [row.bounds[bound][key] for row in points if row.bounds]
        axis.plot(freqs_Hz, best, "--", color=COLORS["bound"], label="bound")
        full = [row.constants[-1][key] for row in points]
        axis.plot(freqs_Hz, full, color=COLORS["reference"], label="full constant current")
        constant = [max(one[key] for one in row.constants) for row in points]
        axis.plot(freqs_Hz, constant, ":", color=COLORS["muted"], label="best constant current")
        for name in SETTINGS:
            all_Hz = [row.freq_Hz for row in rows]
            color = COLORS[SETTING_COLORS[name]]
            axis.plot(all_Hz, reductions(rows, name, key), color=color, label=name, linewidth=1.2)
        low = min(min(best), min(reductions_known(rows, key)))
        axis.set_ylim(bottom=max(min(low, 0.0) - 3.0, -40.0))
        axis.set(title=title, xlabel="frequency (Hz)", ylabel="reduction against 0 A (%)")
    axes[0].legend()
    return figure


def reductions(rows: Sequence[Row], name: str, key: str) -> list[float]:
    found = [row.settings[name] for row in rows]
    return [one[key] if one else np.nan for one in found]


def reductions_known(rows: Sequence[Row], key: str) -> list[float]:
    return [one[key] for row in rows for one in row.settings.values() if one] or [0.0]


def plot_pulses(law: PhaseLaw) -> Any:
    """Command over the displacement's phase and frequency."""
    figure, axes = pyplot().subplots(1, 2, figsize=(10.5, 3.8), sharey=True)
    phase_deg = (np.arange(PHASES) + 0.5) * 180.0 / PHASES
    for axis, (name, points) in zip(axes, law.settings.items(), strict=True):
        freqs_Hz = np.linspace(points[0].freq_Hz, points[-1].freq_Hz, MAP_ROWS)
        map_A = np.array([current_A(points, freq_Hz, phase_deg) for freq_Hz in freqs_Hz])
        extent = (0.0, 180.0, freqs_Hz[0], freqs_Hz[-1])
        top_A = 1e-3 * max(p.level_mA for all_ in law.settings.values() for p in all_)
        image = axis.imshow(
            map_A, origin="lower", aspect="auto", extent=extent, cmap="viridis", vmin=0, vmax=top_A
        )
        axis.set(title=name, xlabel="phase of the displacement, 0: peak (degrees)")
        axis.set_xticks(range(0, 181, 30))
        axis.grid(visible=False)
    axes[0].set_ylabel("frequency (Hz)")
    figure.colorbar(image, ax=axes, label="commanded current (A)")
    return figure


def current_A(points: Any, freq_Hz: float, phase_deg: np.ndarray) -> np.ndarray:
    at = interpolated(points, freq_Hz)
    away_deg = np.abs((phase_deg - at.centre_deg + 90.0) % 180.0 - 90.0)
    ramp_deg = max(min(at.ramp_deg, at.width_deg, 180.0 - at.width_deg), 1e-3)
    part = np.clip((0.5 * at.width_deg - away_deg) / ramp_deg + 0.5, 0.0, 1.0)
    return 1e-3 * (at.floor_mA + (at.level_mA - at.floor_mA) * part)


def plot_fronts(rows: Sequence[Row], fronts: dict[float, list[dict[str, float]]]) -> Any:
    """Displacement against acceleration: what any current can do, and what is done."""
    width = max(len(fronts), 2)
    figure, axes = pyplot().subplots(1, width, figsize=(11, 3.6), squeeze=False)
    by_freq = {row.freq_Hz: row for row in rows}
    for axis, (freq_Hz, front) in zip(axes[0], fronts.items(), strict=False):
        row = by_freq[freq_Hz]
        draw(axis, front, "o-", "bound", "any current", markersize=3)
        draw(axis, row.constants, "-", "reference", "constant currents")
        best = max(row.constants, key=lambda one: one["amp_red_pct"])
        draw(axis, [best], "D", "reference", f"best constant, {best['current_A']:.3g} A")
        for name, marker in zip(SETTINGS, "s^", strict=True):
            if found := row.settings[name]:
                draw(axis, [found], marker, SETTING_COLORS[name], name)
        axis.set(title=f"{freq_Hz:g} Hz", xlabel="RMS acceleration, reduction (%)")
        axis.margins(0.15)
    for unused in axes[0][len(fronts) :]:
        unused.set_visible(False)
    axes[0][0].set_ylabel("displacement, reduction (%)")
    handles, labels = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def draw(
    axis: Any, points: Sequence[dict[str, float]], style: str, color: str, label: str, **more: Any
) -> None:
    accel = [one["accel_red_pct"] for one in points]
    amp = [one["amp_red_pct"] for one in points]
    axis.plot(accel, amp, style, color=COLORS[color], label=label, **more)


def plot_cycles(cycles: Sequence[Cycle], first_Hz: float) -> Any:
    """Displacement, force and current over one cycle, and force over displacement."""
    count = len(cycles)
    figure, axes = pyplot().subplots(4, count, figsize=(4.8 * count, 8.4), squeeze=False)
    for column, one in zip(axes.T, cycles, strict=True):
        where = "below" if one.freq_Hz < first_Hz else "above"
        column[0].set_title(f"{one.freq_Hz:g} Hz, {where} resonance ({one.setting})")
        for axis, values, label, color in (
            (column[0], one.disp_um, "displacement (µm)", "main"),
            (column[1], one.force_mN, "resisting force (mN)", "bound"),
            (column[2], one.coil_A, "coil current (A)", "current"),
        ):
            axis.plot(one.turn_deg, values, color=COLORS[color])
            axis.set(ylabel=label, xlim=(0, 360))
            axis.set_xticks(range(0, 361, 90))
            shade(axis, one)
        for level in (-one.uncontrolled_um, one.uncontrolled_um):
            column[0].axhline(level, color=COLORS["open_loop"], linestyle=":", linewidth=1)
        column[2].set_xlabel("phase of the displacement (degrees)")
        plot_loop(column[3], one)
    return figure


def shade(axis: Any, one: Cycle) -> None:
    """Where more than half of the largest current flows."""
    is_on = one.coil_A > 0.5 * (one.coil_A.max() + one.coil_A.min())
    edges = np.flatnonzero(np.diff(is_on.astype(int), prepend=0, append=0))
    ends_deg = np.append(one.turn_deg, 360.0)
    for first, last in edges.reshape(-1, 2):
        axis.axvspan(ends_deg[first], ends_deg[last], color=COLORS["shade"], zorder=0, linewidth=0)


def plot_loop(axis: Any, one: Cycle) -> None:
    closed = [*range(len(one.disp_um)), 0]
    axis.plot(one.disp_um[closed], one.force_mN[closed], color=COLORS["muted"], linewidth=0.8)
    few = slice(None, None, max(1, len(one.disp_um) // LOOP_POINTS))
    image = axis.scatter(
        one.disp_um[few], one.force_mN[few], c=one.coil_A[few], s=9, cmap="viridis", vmin=0
    )
    kind = "spring" if one.stiffness_N_m > 0 else "mass"
    reach = np.array([-1.0, 1.0]) * np.abs(one.disp_um).max()
    line = 1e-3 * one.stiffness_N_m * reach
    axis.plot(reach, line, "--", color=COLORS["current"])
    axis.set_title(f"dashed: its part like a {kind}", fontsize="medium")
    axis.set(xlabel="displacement (µm)", ylabel="resisting force (mN)")
    axis.figure.colorbar(image, ax=axis, label="coil current (A)")


def plot_robustness(cells: Sequence[Cell]) -> Any:
    """Share of each plant's own bound."""
    freqs_Hz = list(dict.fromkeys(cell.freq_Hz for cell in cells))
    names = list(dict.fromkeys(cell.variant.name for cell in cells))
    figure, axis = pyplot().subplots(figsize=(10.5, 4.0))
    at = {(n, f): i + 0.16 * (k - (len(freqs_Hz) - 1) / 2)
          for i, n in enumerate(names) for k, f in enumerate(freqs_Hz)}  # fmt: skip
    for label, marker, color, pick in (
        ("best constant current", "D", "reference", lambda c: c.constant),
        ("table alone", "o", "muted", lambda c: c.table["displacement"]),
        ("adapting, after 120 s", "o", "main", lambda c: c.adapted.get("displacement")),
    ):
        found = [(cell, pick(cell)) for cell in cells]
        shares = [(at[c.variant.name, c.freq_Hz], share(c, one)) for c, one in found if one]
        if shares:
            axis.plot(*zip(*shares, strict=True), marker, color=COLORS[color], label=label, ms=5)
    axis.axhline(1.0, color=COLORS["bound"], linestyle="--", linewidth=1)
    axis.axhline(0.9, color=COLORS["bound"], linestyle=":", linewidth=1)
    axis.set_xticks(range(len(names)), names, rotation=70 if len(names) > 12 else 25)
    axis.set(ylabel="displacement: share of that plant's bound", ylim=(0.0, 1.05))
    freqs = ", ".join(f"{freq_Hz:g}" for freq_Hz in freqs_Hz)
    axis.set_title(f"displacement; left to right within a plant: {freqs} Hz")
    axis.legend(loc="lower left")
    return figure


def share(cell: Cell, found: dict[str, float]) -> float:
    bound_pct = max(cell.bound["amp_red_pct"], 1e-9)
    return found["amp_red_pct"] / bound_pct
