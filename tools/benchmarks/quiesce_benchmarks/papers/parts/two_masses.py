"""Two masses with damper and elastomer in the bench (MRD+MRE paper, eqs 32 to 38, Table 1)."""

from pathlib import Path

import numpy as np
from quiesce.base.table import format_table
from quiesce.report.plot_style import pyplot, svg_of

from quiesce_benchmarks.laws.two_masses import (
    CONTROLS,
    Found,
    FROM_s,
    PUBLISHED_m_s2,
    measured,
)
from quiesce_benchmarks.part import Effort, Measured

TITLE = "two masses: peak accelerations with damper and elastomer"
FIGURES = (
    ("two_masses_peak_error", "of uncontrolled", 0.1, "lower"),
    ("two_masses_e_error", "of uncontrolled", None, "lower"),
)
MOTIONS = ("at_10Hz", "at_40Hz", "not_periodic")
PLOTTED_s = 0.5


def plot(folder: Path, found: Found) -> None:
    """Fig 10."""
    figure, axes = pyplot().subplots(len(MOTIONS), 1, figsize=(7, 8), sharex=True)
    for axis, motion, runs in zip(axes, MOTIONS, found.accel_m_s2, strict=True):
        for name, accel_m_s2 in zip(CONTROLS, runs, strict=True):
            t = FROM_s + 1e-3 * np.arange(len(accel_m_s2))
            shown = t < FROM_s + PLOTTED_s
            axis.plot(t[shown], accel_m_s2[shown], label=name, lw=1.0)
        axis.set(ylabel="m/s2", title=motion.replace("_", " "))
    axes[0].legend()
    axes[-1].set(xlabel="time (s)")
    (folder / "two_masses.svg").write_text(svg_of(figure), encoding="utf-8")


def measure(effort: Effort) -> Measured:
    found = measured(effort.seed)
    plot(effort.folder, found)
    values: dict[str, float | None] = {
        "two_masses_peak_error": found.worst_peak_error,
        "two_masses_e_error": found.worst_rms_error,
    }
    peaks = dict(zip(MOTIONS, found.peak_m_s2.tolist(), strict=True))
    rows = [
        [motion, *(f"{one:.2f}" for one in (*peaks[motion], *published))]
        for motion, published in zip(MOTIONS, PUBLISHED_m_s2, strict=True)
    ]
    head = ["peaks of mass 2, m/s2", *CONTROLS, *(f"{name}, published" for name in CONTROLS)]
    return Measured(values, {"peak_m_s2": peaks}, (format_table(head, rows),))
