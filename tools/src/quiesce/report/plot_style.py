"""How the project's plots look, and matplotlib set up to draw them without a display."""

import io
from typing import Any

# Colours that stay apart for colour-blind readers (Okabe and Ito), by meaning.
COLORS = {
    "main": "#0072b2",
    "muted": "#8a94a0",
    "current": "#d55e00",
    "reference": "#f0c44c",
    "shade": "#e9ecef",
    "open_loop": "#9aa3ad",
    "constant_best": "#009e73",
    "fuzzy": "#0072b2",
    "phase": "#e69f00",
    "phase_displacement": "#56b4e9",
    "fuzzy_selftune_printed": "#cc79a7",
    "fuzzy_selftune_printed_gated": "#882255",
    "fuzzy_selftune_reversed": "#d55e00",
    "fuzzy_selftune_reversed_ungated": "#a6761d",
    "bound": "#222222",
}

STYLE = {
    "figure.constrained_layout.use": True,
    "figure.dpi": 110,
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e3e6ea",
    "grid.linewidth": 0.7,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "legend.fontsize": 9,  # 9 pt are 12 pixels of a page
    "axes.formatter.min_exponent": 5,  # no exponents, which are smaller
    "font.sans-serif": ["DejaVu Sans"],
    "svg.fonttype": "none",  # text stays text: a small file
    # The same figure gives the same bytes.
    "svg.hashsalt": "quiesce",
}


def pyplot() -> Any:
    """matplotlib.pyplot on files only, in the project's style. Imported late: it is slow."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update(STYLE)
    return plt


def svg_of(figure: Any) -> str:
    """The figure as SVG text; closes it."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    pyplot().close(figure)
    return buffer.getvalue()
