"""A surface in words: where its nodes stand, and some of its values."""

from collections.abc import Sequence

import numpy as np

from quiesce.base.table import format_table
from quiesce.rules.surface.words import SurfaceTable

SHOWN = 8  # nodes of an input


def described_surface(surface: SurfaceTable) -> str:
    """For the controller in its units, else in the table's own."""
    rows, columns = surface.counts.shape
    scales = (1e-6, 1e-6, 1e-3) if surface.is_for_controller else (1.0, 1.0, 1.0)
    names = ("Hz", "m/s2", "A") if surface.is_for_controller else ("input 1", "input 2", "output")
    head = (
        f"surface: {rows} x {columns} values, straight lines between; {names[2]} over {names[0]} "
        f"(rows) and {names[1]} (columns)"
    )
    down, across = (some(len(nodes)) for nodes in surface.nodes)
    first, second = ([text(x, scale) for x in nodes]
                     for nodes, scale in zip(surface.nodes, scales, strict=False))  # fmt: skip
    table = [[first[i], *(text(surface.counts[i, k], scales[2]) for k in across)] for i in down]
    return f"{head}\n\n{format_table(['', *(second[k] for k in across)], table, (0,))}"


def some(count: int) -> Sequence[int]:
    """Indices from the first to the last."""
    return sorted({int(i) for i in np.rint(np.linspace(0, count - 1, min(count, SHOWN)))})


def text(count: float, scale: float) -> str:
    return f"{scale * count:.4g}"
