"""Words of tables whose own part is a section for each damper, or one that is of all.

firmware/base/table.h and sections.h describe them.
"""

import struct
import zlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown

HEAD_WORDS = 4  # sections among them
MOST_WORDS = 1024
MAX_DAMPERS = 4


def words_of_file(file: Path, magic: int) -> list[int]:
    """One hexadecimal number a line, the first of them magic where it is what is looked for, which
    is not looked at here. UsageError where it cannot be read or holds anything else."""
    try:
        return [int(word, 16) for word in file.read_text(encoding="utf-8").split()]
    except (OSError, ValueError) as error:
        why = (
            error.strerror
            if isinstance(error, OSError)
            else f"expected words such as 0x{magic:08x}"
        )
        raise UsageError(f"{shown(file)}: {why}") from None


def sealed(magic: int, sections: Sequence[Sequence[int]], what: str) -> list[int]:
    """A whole table of signed words. ValueError, in one line, where it is more than a controller
    takes; `what` is what it is called there."""
    if not 1 <= len(sections) <= MAX_DAMPERS:
        raise ValueError(f"{len(sections)} dampers; a {what} is of 1 .. {MAX_DAMPERS}")
    values = [len(sections), *(value for section in sections for value in section)]
    count = HEAD_WORDS - 1 + len(values)
    if count > MOST_WORDS:
        raise ValueError(f"{count} words; a controller takes {MOST_WORDS}")
    after = [count, *(value & 0xFFFFFFFF for value in values)]
    return [magic, zlib.crc32(struct.pack(f"<{len(after)}I", *after)), *after]


def sections_of(
    magic: int, words: Sequence[int], size: Callable[[Sequence[int]], int], what: str
) -> Iterator[list[int]]:
    """Signed words of each section; size says how many of what is left are one's, or raises
    ValueError. ValueError, in one line, where head or sizes are not right."""
    if len(words) <= HEAD_WORDS or not all(0 <= word <= 0xFFFFFFFF for word in words):
        raise ValueError(f"expected more than {HEAD_WORDS} words of 32 bits")
    if words[0] != magic:
        raise ValueError(f"it begins with 0x{words[0]:08x}, a {what} with 0x{magic:08x}")
    if words[2] != len(words):
        raise ValueError(f"{len(words)} words where its header says {words[2]}")
    if words[1] != zlib.crc32(struct.pack(f"<{len(words) - 2}I", *words[2:])):
        raise ValueError("its CRC-32 is not that of its words")
    if not 1 <= words[3] <= MAX_DAMPERS:
        raise ValueError(f"{words[3]} dampers; a {what} is of 1 .. {MAX_DAMPERS}")
    rest = [int(value) for value in np.array(words[HEAD_WORDS:], dtype=np.uint32).view(np.int32)]
    for _ in range(words[3]):
        count = size(rest)
        yield rest[:count]
        rest = rest[count:]
    if rest:
        raise ValueError(f"{len(rest)} words after its last damper")
