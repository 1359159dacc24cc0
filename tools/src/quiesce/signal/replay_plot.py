"""The picture of a replay: acceleration, frequency, RMS and current against time."""

from pathlib import Path

import numpy as np

from quiesce.report.plot_style import COLORS, pyplot
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


def plot_replay(
    file: Path,
    replayed: Replayed,
    title: str,
    reference: tuple[np.ndarray, np.ndarray] | None,
) -> None:
    plt = pyplot()
    figure, axes = plt.subplots(4, 1, sharex=True, figsize=(10, 8), height_ratios=[2, 3, 2, 2])
    time_s, trace = replayed.time_s, replayed.trace
    axes[0].fill_between(
        *band(time_s, trace["accel_um_s2"] * 1e-6), color=COLORS["muted"], linewidth=0.8
    )
    axes[0].set_ylabel("acceleration\n(m/s²)")
    draw_frequency(axes[1], replayed, reference)
    low_s, low, high = band(time_s, trace["rms_um_s2"] * 1e-6)
    axes[2].plot(low_s, high, color=COLORS["main"], linewidth=1.1)
    axes[2].set_ylabel("RMS (m/s²)")
    axes[2].set_ylim(bottom=0.0)
    low_s, low, high = band(time_s, trace["current_cmd_mA"] * 1e-3)
    axes[3].fill_between(low_s, low, high, color=COLORS["current"], linewidth=1.1)
    axes[3].set_ylabel("current (A)")
    axes[3].set_ylim(bottom=-0.1)
    axes[3].set_xlabel("time (s)")
    axes[3].set_xlim(time_s[0], time_s[-1])
    figure.suptitle(title, x=0.01, ha="left")
    figure.align_ylabels(axes)
    figure.savefig(file)
    plt.close(figure)
