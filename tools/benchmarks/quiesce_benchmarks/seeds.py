"""The seed of a benchmark, and the random numbers that come of it."""

import zlib

import numpy as np
from quiesce.base.command import whole_number

seed_number = whole_number(0, (1 << 32) - 1)


def generator(seed: int, *names: object) -> np.random.Generator:
    """Random numbers of one piece of work: the same whatever else runs, and in which order."""
    return np.random.default_rng([seed, zlib.crc32(repr(names).encode())])
