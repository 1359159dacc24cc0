"""Histograms of a figure, a line each group."""

import numpy as np

from quiesce.report.plot_style import COLORS, pyplot, svg_of

BINS = 40
DRAWN = 6  # groups, or nothing can be told apart
COLOURS = ("main", "current", "constant_best", "phase", "phase_displacement", "reference")


def histogram(figure: str, groups: dict[str, np.ndarray]) -> str:
    """SVG; "" where there is nothing to draw. Up to the 99.5 % quantile of all: a diverging run
    would flatten the others."""
    drawn = {name: values[np.isfinite(values)] for name, values in list(groups.items())[:DRAWN]}
    everything = np.concatenate(list(drawn.values()))
    if everything.size == 0 or np.ptp(everything) == 0.0:
        return ""
    edges = np.linspace(everything.min(), np.quantile(everything, 0.995), BINS + 1)
    if edges[0] == edges[-1]:
        return ""
    plot, axes = pyplot().subplots(figsize=(9, 3.2))
    for (name, values), colour in zip(drawn.items(), COLOURS, strict=False):
        axes.hist(values, edges, histtype="step", color=COLORS[colour], label=name, linewidth=1.4)
    axes.set_xlabel(figure)
    axes.set_ylabel("cases")
    if len(drawn) > 1:
        axes.legend()
    return svg_of(plot)
