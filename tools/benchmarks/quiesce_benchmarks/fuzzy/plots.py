"""The plots of `./tools/benchmark fuzzy`."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from quiesce.report.plot_style import COLORS, pyplot, svg_of

from quiesce_benchmarks.fuzzy.cost import EngineCost, PeerCost
from quiesce_benchmarks.fuzzy.grid import GridResult

MAP_SIDE = 250  # pixels of an error map; each is the largest error of what it covers


def coarse(error_A: np.ndarray) -> np.ndarray:
    """The largest magnitude of each tile."""
    side = max(1, -(-len(error_A) // MAP_SIDE))
    rows = np.maximum.reduceat(np.abs(error_A), np.arange(0, len(error_A), side), axis=0)
    return np.maximum.reduceat(rows, np.arange(0, error_A.shape[1], side), axis=1)


def plot_errors(folder: Path, grid: GridResult) -> None:
    """Where the errors are: one map for each form and for libfuzzylite's centroid."""
    columns = 4
    rows = -(-len(grid.maps) // columns)
    figure, axes = pyplot().subplots(rows, columns, figsize=(13, 2.9 * rows), squeeze=False)
    for axis, (name, error_A) in zip(axes.flat, grid.maps.items(), strict=False):
        tiles = coarse(error_A)
        image = axis.imshow(
            1e6 * tiles.T, origin="lower", extent=(0, 25, 0, 20), aspect="auto", cmap="viridis"
        )
        axis.set_title(f"{name.replace('reference_', '')}\nworst {tiles.max():.2g} A", fontsize=8)
        axis.grid(False)
        figure.colorbar(image, ax=axis).set_label("|error| (uA)")
    for axis in axes.flat[len(grid.maps) :]:
        axis.axis("off")
    for axis in axes[-1]:
        axis.set_xlabel("frequency (Hz)")
    for axis in axes[:, 0]:
        axis.set_ylabel("acceleration (m/s2)")
    write(folder / "fuzzy_errors.svg", svg_of(figure))


def plot_cost(folder: Path, engines: Sequence[EngineCost], peers: Sequence[PeerCost]) -> None:
    """Worst and mean instructions of an evaluation, on a logarithmic axis."""
    bars = [
        (f"{one.kind}, {one.variant.method}, {one.variant.format}", one.worst_instr, one.mean_instr)
        for one in engines
    ]
    bars += [
        (
            f"libfuzzylite 6, {one.resolution or 'no'} samples",
            one.worst_instr,
            one.mean_instr,
        )
        for one in peers
    ]
    figure, axis = pyplot().subplots(figsize=(9, 0.3 * len(bars) + 1))
    places = np.arange(len(bars))[::-1]
    colors = [COLORS["main"]] * len(engines) + [COLORS["current"]] * len(peers)
    axis.barh(places, [worst for _, worst, _ in bars], color=colors, alpha=0.35, label="worst")
    axis.barh(places, [mean for *_, mean in bars], color=colors, height=0.45, label="mean")
    for place, (_, worst, _) in zip(places, bars, strict=True):
        axis.text(1.05 * worst, place, f"{worst:,}", va="center", fontsize=8)
    axis.set(xscale="log", yticks=places, yticklabels=[name for name, *_ in bars])
    axis.set_xlabel("instructions of one evaluation on the Cortex-M4: mean (dark), worst (light)")
    write(folder / "fuzzy_cost.svg", svg_of(figure))


def write(file: Path, text: str) -> None:
    file.write_text(text, encoding="utf-8")
