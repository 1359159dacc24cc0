"""Genomes as strings of bits, for searches by binary codes as the squeeze-mode paper names them: a
Gray code of N bits for every gene, one after the other.

A code of N bits names level floor(code * levels / 2^N): equal shares whatever the number of levels
is, and every level itself where it is a power of two.
"""

from collections.abc import Sequence

import numpy as np

from quiesce.base.searches.gray import bits_of, numbers_of
from quiesce.rules.optimize.genes import Genome

SPARE_BITS = 2  # more than the levels need, so that shares of unequal numbers differ little


class Coding:
    def __init__(self, levels: Sequence[int]) -> None:
        self._levels = levels
        self._widths = [width(count) for count in levels]

    @property
    def bits(self) -> int:
        return sum(self._widths)

    def decode(self, bits: np.ndarray) -> Genome:
        """bits: bool, shape (bits,)."""
        codes = [int(numbers_of(part)) for part in np.split(bits, np.cumsum(self._widths)[:-1])]
        parts = zip(codes, self._levels, self._widths, strict=True)
        return tuple(code * count >> wide for code, count, wide in parts)

    def encode(self, genome: Genome) -> np.ndarray:
        """The lowest code of each gene's level."""
        parts = zip(genome, self._levels, self._widths, strict=True)
        codes = [bits_of(-(-(gene << wide) // count), wide) for gene, count, wide in parts]
        return np.array([bit for code in codes for bit in code])


def width(count: int) -> int:
    exact = max(count - 1, 1).bit_length()
    return exact if count == 1 << exact else exact + SPARE_BITS
