"""Where the nodes of a grid stand, and their values: as near to a function as so many words allow.

Between nodes the firmware takes straight lines in both directions (bilinear).
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

GOOD_ENOUGH = 2.0**-13  # of the range: finer nodes than that are not worth their words


@dataclass(frozen=True)
class Grid:
    """nodes: places [row], [column], ascending; values: [row, column]."""

    nodes: tuple[np.ndarray, np.ndarray]
    values: np.ndarray


@dataclass(frozen=True)
class Strip:
    """Between two chosen lines: the largest distance from straight lines across it, and where."""

    first: int
    last: int
    error: float
    worst: int


@dataclass
class Lines:
    """Those chosen along one axis. samples: [line, point of the other axis]."""

    at: np.ndarray
    samples: np.ndarray
    strips: list[Strip] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.strips = [strip_of(self.at, self.samples, 0, len(self.at) - 1)]

    @property
    def chosen(self) -> list[int]:
        return sorted({0, *(strip.last for strip in self.strips)})

    @property
    def worst(self) -> Strip:
        return max(self.strips, key=lambda strip: strip.error)

    def split(self, strip: Strip) -> None:
        self.strips.remove(strip)
        for first, last in ((strip.first, strip.worst), (strip.worst, strip.last)):
            self.strips.append(strip_of(self.at, self.samples, first, last))


def strip_of(at: np.ndarray, samples: np.ndarray, first: int, last: int) -> Strip:
    if last - first < 2:
        return Strip(first, last, 0.0, first)
    share = (at[first : last + 1] - at[first]) / (at[last] - at[first])
    lines = np.outer(1.0 - share, samples[first]) + np.outer(share, samples[last])
    off = np.abs(samples[first : last + 1] - lines).max(axis=1)[1:-1]
    worst = int(off.argmax())
    return Strip(first, last, float(off[worst]), first + 1 + worst)


def words_of(rows: int, columns: int, words_a_node: int) -> int:
    return words_a_node * (rows + columns) + (rows * columns + 1) // 2


def placed(
    at: tuple[np.ndarray, np.ndarray],
    samples: np.ndarray,
    room_words: int,
    words_a_node: int,
    most_nodes: int,
) -> Grid:
    """samples: [row, column] at all lines `at`, which nodes are chosen from, always the one that is
    missing most."""
    axes = (Lines(at[0], samples), Lines(at[1], samples.T))
    enough = GOOD_ENOUGH * float(np.ptp(samples))
    while True:
        axis = max(axes, key=lambda one: one.worst.error)
        strip = axis.worst
        rows, columns = (len(one.chosen) + (one is axis) for one in axes)
        is_full = words_of(rows, columns, words_a_node) > room_words
        if strip.error <= enough or is_full or max(rows, columns) > most_nodes:
            return best_values(at, samples, [one.chosen for one in axes])
        axis.split(strip)


def best_values(
    at: tuple[np.ndarray, np.ndarray], samples: np.ndarray, chosen: Sequence[Sequence[int]]
) -> Grid:
    """The samples at the nodes, or the least squares' values, never beyond what the samples reach:
    whichever is nearer at its worst."""
    rows, columns = (line[list(which)] for line, which in zip(at, chosen, strict=True))
    down, across = hats(at[0], rows), hats(at[1], columns)
    fitted = np.linalg.pinv(down) @ samples @ np.linalg.pinv(across).T
    both = (
        samples[np.ix_(*chosen)],
        np.clip(fitted, samples.min(), samples.max()),
    )
    values = min(both, key=lambda one: float(np.abs(down @ one @ across.T - samples).max()))
    return Grid((rows, columns), values)


def hats(x: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """[place, node]: what each node's value counts at each place."""
    last = np.clip(np.searchsorted(nodes, x, side="right"), 1, len(nodes) - 1)
    share = (x - nodes[last - 1]) / (nodes[last] - nodes[last - 1])
    out = np.zeros((len(x), len(nodes)))
    out[np.arange(len(x)), last - 1] = 1.0 - share
    out[np.arange(len(x)), last] += share
    return out
