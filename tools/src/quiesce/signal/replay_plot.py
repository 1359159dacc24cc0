"""The picture of a replay: acceleration, frequency, RMS and current against time."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.engine.board import Board
from quiesce.report.plot_style import COLORS, pyplot
from quiesce.signal.picture import ACCEL, DISPLACEMENT, STROKE, Quantity, curve
from quiesce.signal.replay import Replayed

# More points than this are drawn as the range of each stretch.
MAX_POINTS = 4000


def band(time_s: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lowest and highest value of each stretch, so that no peak is lost."""
    step = max(1, len(values) // MAX_POINTS)
    count = len(values) // step
    blocks = values[: count * step].reshape(count, step)
    return time_s[: count * step : step], blocks.min(axis=1), blocks.max(axis=1)


def shade_invalid(axes, time_s: np.ndarray, is_valid: np.ndarray) -> None:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], (~is_valid).astype(int), [0]])))
    last = len(time_s) - 1
    for number, (first, end) in enumerate(edges.reshape(-1, 2)):
        axes.axvspan(
            time_s[first],
            time_s[min(end, last)],
            color=COLORS["shade"],
            linewidth=0,
            label="not valid" if number == 0 else None,
        )


def draw_frequency(axes, replayed: Replayed, reference: tuple[np.ndarray, np.ndarray] | None):
    is_valid = replayed.trace["freq_is_valid"] > 0
    time_s, step = replayed.time_s, replayed.updates
    freq_Hz = np.where(is_valid, replayed.trace["freq_uHz"] * 1e-6, np.nan)
    shade_invalid(axes, time_s, is_valid)
    if reference is not None:
        axes.plot(*reference, color=COLORS["reference"], linewidth=2.4, label="reference sensor")
    axes.plot(
        (time_s - replayed.latency_s)[step],
        freq_Hz[step],
        color=COLORS["main"],
        linewidth=1.1,
        label="firmware, drawn at the middle of its window",
    )
    axes.set_ylabel("frequency (Hz)")
    top = np.nanpercentile(freq_Hz, 99.5) if is_valid.any() else 10.0
    axes.set_ylim(0.0, 1.25 * top)
    axes.legend(loc="upper left", ncols=3)


def draw_band(axes, time_s: np.ndarray, values: np.ndarray, color: str, **look: Any) -> None:
    axes.fill_between(*band(time_s, values), **{"color": color, "linewidth": 0.8, **look})


def draw_rms(axes, replayed: Replayed) -> None:
    low_s, _, high = band(replayed.time_s, replayed.trace["rms_um_s2"] * 1e-6)
    axes.plot(low_s, high, color=COLORS["main"], linewidth=1.1)
    axes.set_ylabel("RMS (m/s²)")
    axes.set_ylim(bottom=0.0)


def draw_accel(axes, replayed: Replayed) -> None:
    draw_band(axes, replayed.time_s, replayed.trace["accel_um_s2"] * 1e-6, COLORS["muted"])
    axes.set_ylabel("acceleration\n(m/s²)")


def draw_current(axes, replayed: Replayed) -> None:
    current_A = replayed.trace["current_cmd_mA"] * 1e-3
    draw_band(axes, replayed.time_s, current_A, COLORS["current"], linewidth=1.1)
    axes.set_ylabel("current (A)")
    axes.set_ylim(bottom=-0.1)


def draw_curves(axes, time_s: np.ndarray, curves: dict[str, np.ndarray], unit: str) -> None:
    """By name; what is known nowhere is left out."""
    for number, (name, values) in enumerate(curves.items()):
        if np.isfinite(values).any():
            draw_band(axes, time_s, values, f"C{number}", label=name, alpha=0.7)
    axes.set_ylabel(unit)
    if axes.has_data():
        axes.legend(loc="upper left", ncols=4)


def rig_curves(replayed: Replayed, board: Board) -> list[tuple[str, dict[str, np.ndarray]]]:
    """Of bodies and dampers as the controller sees them, and what it commands."""
    trace = replayed.trace

    def of(names: tuple[str, ...], quantity: Quantity, scale: float) -> dict[str, np.ndarray]:
        curves = (curve(trace, names, k, quantity) for k in range(len(names)))
        return {name: scale * values for name, values in zip(names, curves, strict=True)}

    strokes = of(board.dampers, STROKE, 1e-6)
    moved = of(board.bodies, DISPLACEMENT, 1e-6)
    moved |= {f"{name}, stroke": values for name, values in strokes.items()}
    currents = [
        ("current (A)", {name: 1e-3 * trace[f"{name}_current_cmd_mA"]}) for name in board.dampers
    ]
    return [
        ("acceleration\n(m/s²)", of(board.bodies, ACCEL, 1e-6)),
        ("displacement\n(mm)", moved),
        *currents,
    ]


def panels(
    replayed: Replayed, reference: tuple[np.ndarray, np.ndarray] | None
) -> list[tuple[int, Callable[[Any], None]]]:
    """Height and content of each, from the top."""

    def frequency(axes: Any) -> None:
        draw_frequency(axes, replayed, reference)

    middle = [(3, frequency), (2, partial(draw_rms, replayed=replayed))]
    if replayed.board is None:
        first = (2, partial(draw_accel, replayed=replayed))
        return [first, *middle, (2, partial(draw_current, replayed=replayed))]
    accel, moved, *currents = (
        (2, partial(draw_curves, time_s=replayed.time_s, curves=curves, unit=unit))
        for unit, curves in rig_curves(replayed, replayed.board)
    )
    return [accel, moved, *middle, *currents]


def plot_replay(
    file: Path,
    replayed: Replayed,
    title: str,
    reference: tuple[np.ndarray, np.ndarray] | None,
) -> None:
    plt = pyplot()
    heights, draws = zip(*panels(replayed, reference), strict=True)
    figure, axes = plt.subplots(
        len(heights), 1, sharex=True, figsize=(10, 8 * sum(heights) / 9), height_ratios=heights
    )
    for axis, draw in zip(axes, draws, strict=True):
        draw(axis)
    axes[-1].set_xlabel("time (s)")
    axes[-1].set_xlim(replayed.time_s[0], replayed.time_s[-1])
    figure.suptitle(title, x=0.01, ha="left")
    figure.align_ylabels(axes)
    figure.savefig(file)
    plt.close(figure)
