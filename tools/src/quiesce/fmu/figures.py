"""What a co-simulation shows: RMS and peaks over its second half, and curves."""

from pathlib import Path

import numpy as np

from quiesce.fmu.cosim import PLANT, Run
from quiesce.report.plot_style import pyplot

MOST_CURVES = 8


def compared(run: Run, before: Run | None) -> tuple[list[str], list[list[str]]]:
    """Head and rows of a table: RMS about the mean and largest deviation from it, of each column
    in the second half; with another run the ratio of RMS to that one's."""
    head = ["second half", "RMS", "peak"]
    if before is not None:
        head += ["RMS, alone", "ratio"]
    rows = []
    for name, values in run.columns.items():
        row = [name, *(f"{value:.4g}" for value in rms_and_peak(values))]
        if before is not None and name.startswith(PLANT):
            rms, off = rms_and_peak(values)[0], rms_and_peak(before.columns[name])[0]
            row += [f"{off:.4g}", f"{rms / off:.3f}" if off > 0.0 else "-"]
        elif before is not None:
            row += ["", ""]  # what drives nothing
        rows.append(row)
    return head, rows


def rms_and_peak(values: np.ndarray) -> tuple[float, float]:
    half = values[len(values) // 2 :]
    moved = half - half.mean()
    return float(np.sqrt(np.mean(moved**2))), float(np.abs(moved).max())


def plot(file: Path, run: Run, before: Run | None, title: str) -> None:
    """A panel for each column, the first ones where there are many; without the controller grey."""
    plt = pyplot()
    names = list(run.columns)[:MOST_CURVES]
    figure, axes = plt.subplots(
        len(names), 1, sharex=True, figsize=(10, 1.4 * len(names) + 0.8), squeeze=False
    )
    for axis, name in zip(axes[:, 0], names, strict=True):
        if before is not None:
            axis.plot(
                before.time_s, before.columns[name], color="0.7", label="without the controller"
            )
        axis.plot(run.time_s, run.columns[name], label="controlled")
        axis.set_ylabel(name.replace(" ", "\n", 1).replace(".", "\n"), rotation=0, ha="right")
    if before is not None:
        axes[0, 0].legend(loc="upper right")
    axes[-1, 0].set_xlabel("time (s)")
    figure.suptitle(title, x=0.01, ha="left")
    figure.savefig(file)
    plt.close(figure)
