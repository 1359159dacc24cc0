"""Signals of many messages at once."""

import numpy as np


def raw_column(words: np.ndarray, start_bit: int, bits: int, is_signed: bool) -> np.ndarray:
    """(n,) integers on the wire, int64 or uint64, of n messages as 64-bit little-endian words."""
    kind = np.int64 if is_signed else np.uint64
    left = words << np.uint64(64 - start_bit - bits)
    return left.view(kind) >> kind(64 - bits)
