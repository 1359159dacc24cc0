"""Surfaces as words of a table of rules, and back (firmware/fuzzy/fuzzy_table.h, FUZZY_SURFACE)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.rules.integers.rule_words import HEADER_WORDS, MAGIC, part
from quiesce.rules.surface.place import Grid
from quiesce.table.words import WORD, crc_of, packed, signed, unpacked

FORM = 4
NODE_WORDS = 3
MOST_NODES = 256
SCALE_BITS = 62
MIN_SHIFT, MAX_SHIFT = 16, 46
MOST_VALUE = 65535


@dataclass(frozen=True)
class SurfaceTable:
    """nodes: counts of each input, ascending; counts: of the output at every node [row, column]."""

    nodes: tuple[tuple[int, ...], tuple[int, ...]]
    counts: np.ndarray
    is_for_controller: bool


def surface_words(grid: Grid, is_for_controller: bool) -> list[int]:
    """grid: nodes in counts of the inputs, values in those of the output."""
    origin = math.floor(grid.values.min())
    shift = finest_shift(float(grid.values.max()) - origin)
    values = np.rint((grid.values - origin) * 2.0 ** (shift - 30))
    body: list[int] = []
    axes = []
    for nodes in grid.nodes:
        axes.append(HEADER_WORDS + len(body) | (len(nodes) - 1) << 16 | NODE_WORDS << 24)
        body += node_words([int(node) for node in nodes])
    output = HEADER_WORDS + len(body)
    body += halves(values)
    # Bits of memberships and rules: there are none.
    head = [HEADER_WORDS + len(body), 2 | 1 << 8 | FORM << 24, *axes, 0, 0, 0, output, 0, 0, 0]
    rest = [*head, 0, origin % WORD, shift << 16 | int(is_for_controller) << 24, *body]
    return [MAGIC, crc_of(rest), *rest]


def finest_shift(span: float) -> int:
    """With which values stay below 2^16."""
    fitting = (
        shift
        for shift in range(MAX_SHIFT, MIN_SHIFT - 1, -1)
        if round(span * 2.0 ** (shift - 30)) <= MOST_VALUE
    )
    found = next(fitting, None)
    if found is None:
        raise ValueError(f"its output spans {span:.6g} counts; a surface holds 2^30 at most")
    return found


def node_words(nodes: Sequence[int]) -> list[int]:
    words = []
    for first, second in zip(nodes, nodes[1:], strict=False):
        shift = 32 - (second - first).bit_length()
        scale = (1 << SCALE_BITS) // ((second - first) << shift)
        words += [first % WORD, shift, scale]
    return [*words, nodes[-1] % WORD, 0, 0]


def halves(values: np.ndarray) -> list[int]:
    """Two in a word, the lower first."""
    return unpacked(values.astype("<u2").tobytes() + b"\0\0" * (values.size % 2))


def is_surface(words: Sequence[int]) -> bool:
    return len(words) >= HEADER_WORDS and words[0] == MAGIC and words[3] >> 24 == FORM


def read_surface(words: Sequence[int]) -> SurfaceTable:
    """ValueError, in one line, where its parts lie outside of it."""
    if not is_surface(words) or words[2] != len(words) or words[1] != crc_of(words[2:]):
        raise ValueError(f"{len(words)} words that are no surface")
    nodes = tuple(read_nodes(words, words[4 + i]) for i in range(2))
    rows, columns = len(nodes[0]), len(nodes[1])
    halved = part(words, words[9], (rows * columns + 1) // 2)
    values = np.frombuffer(packed(halved), dtype="<u2")
    values = values[: rows * columns].reshape(rows, columns)
    shift = words[15] >> 16 & 0xFF
    counts = signed(words[14]) + values * 2.0 ** (30 - shift)
    return SurfaceTable((nodes[0], nodes[1]), counts, words[15] >> 24 == 1)


def read_nodes(words: Sequence[int], axis: int) -> tuple[int, ...]:
    at, cells = axis & 0xFFFF, axis >> 16 & 0xFF
    return tuple(signed(word) for word in part(words, at, NODE_WORDS * (cells + 1))[::NODE_WORDS])
