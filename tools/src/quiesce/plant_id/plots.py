"""Measured against modelled: the response to the sweep, and each dwell with its current steps."""

from pathlib import Path

import numpy as np

from quiesce.plant_id.fit import DwellModel, Fit
from quiesce.plant_id.modes import Modes, SweepModel, structure_response
from quiesce.report.plot_style import COLORS, pyplot

POINTS = 300


def averaged(freq_Hz: np.ndarray, response: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """RMS magnitude in bands of equal ratio."""
    edges = np.geomspace(freq_Hz.min(), freq_Hz.max() * (1.0 + 1e-9), POINTS + 1)
    band = np.digitize(freq_Hz, edges) - 1
    count = np.bincount(band, minlength=POINTS)[:POINTS]
    power = np.bincount(band, np.abs(response) ** 2, minlength=POINTS)[:POINTS]
    used = count > 0
    return np.sqrt(edges[:-1] * edges[1:])[used], np.sqrt(power[used] / count[used])


def plot_sweep(file: Path, sweep: SweepModel, modes: Modes) -> None:
    """Acceleration per volt at the force of the reference frequency."""
    plt = pyplot()
    figure, axes = plt.subplots(figsize=(8, 4.5))
    measured = sweep.measured(modes.corner_Hz)
    axes.loglog(*averaged(sweep.freq_Hz, measured), ".", color=COLORS["muted"], label="measured")
    freq_Hz = np.geomspace(sweep.freq_Hz.min(), sweep.freq_Hz.max(), 2000)
    response = np.abs(structure_response(freq_Hz, modes))
    axes.loglog(freq_Hz, response, color=COLORS["main"], label="identified")
    axes.set_xlabel("frequency (Hz)")
    axes.set_ylabel("acceleration per volt (m/s²/V)\nthe shaker's roll-off taken out")
    axes.set_title("Drive sweep without current")
    axes.legend()
    figure.savefig(file)
    plt.close(figure)


def plot_dwells(file: Path, dwell: DwellModel, fit: Fit) -> None:
    plt = pyplot()
    count = len(dwell.dwells)
    figure, axes = plt.subplots(count, 2, figsize=(11, 2.3 * count), squeeze=False)
    for number, one in enumerate(dwell.dwells):
        measured = dwell.measured(number)
        modelled = dwell.response(number, fit.values)
        time_s = np.arange(len(measured)) / dwell.recording.rate_Hz
        current_A = dwell.recording.current_A[one.part.first : one.part.end]
        draw(axes[number, 0], time_s, measured, modelled, current_A)
        jumps = np.flatnonzero(np.diff(current_A) != 0.0)
        middle_s = time_s[jumps[len(jumps) // 2]] if len(jumps) else time_s.mean()
        near = np.abs(time_s - middle_s) < 2.0 / one.freq_Hz
        draw(axes[number, 1], time_s[near], measured[near], modelled[near], current_A[near])
        axes[number, 0].set_title(f"{one.freq_Hz:.4g} Hz: acceleration (m/s²)")
        axes[number, 1].set_title("around one current step")
    axes[0, 0].legend(loc="upper right", ncols=3)
    axes[-1, 0].set_xlabel("time in the dwell (s)")
    axes[-1, 1].set_xlabel("time in the dwell (s)")
    figure.savefig(file)
    plt.close(figure)


def draw(axes, time_s, measured, modelled, current_A) -> None:
    axes.plot(time_s, measured, color=COLORS["muted"], linewidth=1.6, label="measured")
    axes.plot(time_s, modelled, color=COLORS["main"], linewidth=0.7, label="identified")
    axes.plot(time_s, measured - modelled, color=COLORS["current"], linewidth=0.6, label="rest")
    top = axes.twinx()
    top.plot(time_s, current_A, color=COLORS["reference"], linewidth=0.9, drawstyle="steps-post")
    top.set_ylabel("A")
    top.grid(False)
    top.set_ylim(-0.1, 4.0 * max(1e-3, float(current_A.max())))
