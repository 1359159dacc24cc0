"""Gray codes: neighbouring numbers differ in one bit."""

import numpy as np


def numbers_of(bits: np.ndarray) -> np.ndarray:
    """Numbers [...] from their Gray codes [..., bits], bool, the highest bit first."""
    binary = np.logical_xor.accumulate(bits, axis=-1)
    return binary @ (1 << np.arange(bits.shape[-1])[::-1])


def bits_of(number: int, width: int) -> list[bool]:
    """The Gray code of a number."""
    code = number ^ (number >> 1)
    return [bool(code >> i & 1) for i in reversed(range(width))]
