"""Words of tables: what all kinds begin with.

firmware/base/table.h describes the head.
"""

import struct
import zlib
from collections.abc import Sequence

HEAD_WORDS = 3
MOST_WORDS = 2048
WORD_BYTES = 4
WORD = 2**32


def packed(words: Sequence[int]) -> bytes:
    """Little-endian."""
    return struct.pack(f"<{len(words)}I", *words)


def unpacked(data: bytes) -> list[int]:
    """The whole words that it begins with."""
    count = len(data) // WORD_BYTES
    return list(struct.unpack(f"<{count}I", data[: WORD_BYTES * count]))


def crc_of(words: Sequence[int]) -> int:
    """CRC-32 as zlib's over their bytes."""
    return zlib.crc32(packed(words))


def signed(word: int) -> int:
    """The int32 that a word holds."""
    return word - WORD if word >= WORD // 2 else word


def size_text(count: int) -> str:
    return f"{count} words, {WORD_BYTES * count} bytes"


def require_room(count: int) -> None:
    """ValueError where a controller does not take so many words."""
    if count > MOST_WORDS:
        raise ValueError(
            f"a table of {size_text(count)}; a controller takes {size_text(MOST_WORDS)}"
        )


def sealed(magic: int, values: Sequence[int]) -> list[int]:
    """A whole table from what follows its head, signed or not. ValueError where it is too long."""
    count = HEAD_WORDS + len(values)
    require_room(count)
    after = [count, *(value % WORD for value in values)]
    return [magic, crc_of(after), *after]


def opened(words: Sequence[int]) -> list[int]:
    """What follows the head, signed. ValueError, in one line, where the head is not right."""
    count = len(words)
    require_room(count)
    if count <= HEAD_WORDS or not all(0 <= word < WORD for word in words):
        raise ValueError(f"expected {HEAD_WORDS + 1} .. {MOST_WORDS} words of 32 bits")
    if words[2] != count:
        raise ValueError(f"{count} words where its head says {words[2]}")
    if words[1] != crc_of(words[2:]):
        raise ValueError("its CRC-32 is not that of its words: it is damaged")
    return [signed(word) for word in words[HEAD_WORDS:]]


class Reader:
    """Takes values one after the other; ValueError where there are no more."""

    def __init__(self, values: Sequence[int]) -> None:
        self._values = values
        self._at = 0

    def take(self, count: int) -> list[int]:
        found = list(self._values[self._at : self._at + count])
        if len(found) < count or count < 0:
            raise ValueError("it ends before all of its parts")
        self._at += count
        return found

    def one(self, low: int, high: int, what: str) -> int:
        value = self.take(1)[0]
        if not low <= value <= high:
            raise ValueError(f"{what} {value} is not in {low} .. {high}")
        return value

    def end(self) -> None:
        if self._at != len(self._values):
            raise ValueError(f"{len(self._values) - self._at} words after its last part")
