"""Words of tables: what all kinds begin with, and files of them, one hexadecimal number a line.

firmware/base/table.h describes the head.
"""

import struct
import zlib
from collections.abc import Sequence
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown

HEAD_WORDS = 3
MOST_WORDS = 2048
WORD = 2**32


def sealed(magic: int, values: Sequence[int]) -> list[int]:
    """A whole table from what follows its head, signed or not. ValueError where it is too long."""
    count = HEAD_WORDS + len(values)
    if count > MOST_WORDS:
        raise ValueError(f"{count} words; a controller takes {MOST_WORDS}")
    after = [count, *(value % WORD for value in values)]
    return [magic, zlib.crc32(struct.pack(f"<{len(after)}I", *after)), *after]


def opened(words: Sequence[int]) -> list[int]:
    """What follows the head, signed. ValueError, in one line, where the head is not right."""
    count = len(words)
    if not HEAD_WORDS < count <= MOST_WORDS or not all(0 <= word < WORD for word in words):
        raise ValueError(f"expected {HEAD_WORDS + 1} .. {MOST_WORDS} words of 32 bits")
    if words[2] != count:
        raise ValueError(f"{count} words where its head says {words[2]}")
    if words[1] != zlib.crc32(struct.pack(f"<{count - 2}I", *words[2:])):
        raise ValueError("its CRC-32 is not that of its words: it is damaged")
    return [word - WORD if word >= WORD // 2 else word for word in words[HEAD_WORDS:]]


def read_file(file: Path) -> list[int]:
    """UsageError where it cannot be read or holds anything else."""
    try:
        words = [int(text, 16) for text in file.read_text(encoding="ascii").split()]
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name a table of words")
    except (UnicodeDecodeError, ValueError):
        raise UsageError(f"{shown(file)}: expected hexadecimal numbers, one a line")
    return words


def file_text(words: Sequence[int]) -> str:
    return "".join(f"{word:08x}\n" for word in words)


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
