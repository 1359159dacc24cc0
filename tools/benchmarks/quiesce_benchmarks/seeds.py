"""The seed of a benchmark, and the random numbers that come of it."""

import zlib

import numpy as np


def seed_number(text: str) -> int:
    value = int(text)
    if not 0 <= value < 1 << 32:
        raise ValueError
    return value


def generator(seed: int, *names: object) -> np.random.Generator:
    """Random numbers of one piece of work: the same whatever else runs, and in which order."""
    return np.random.default_rng([seed, zlib.crc32(repr(names).encode())])
