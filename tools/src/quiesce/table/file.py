"""Table files (docs/reference/table-files.md): a head of four words, then the table."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.table.words import (
    HEAD_WORDS,
    MOST_WORDS,
    WORD_BYTES,
    crc_of,
    packed,
    require_room,
    size_text,
    unpacked,
)

SUFFIX = ".table"
MAGIC = 0x31465451  # "QTF1"
FILE_HEAD_WORDS = 4
LEAST_WORDS = HEAD_WORDS + 1
ANY_BOARD = 0
# One more than there may be, so that a longer file is seen to be one.
_MOST_BYTES = WORD_BYTES * (FILE_HEAD_WORDS + MOST_WORDS) + 1


@dataclass(frozen=True)
class TableFile:
    """board: CRC-32 of the words of the board that it is made for, or ANY_BOARD."""

    words: list[int]
    board: int = ANY_BOARD


def read_data(data: bytes) -> TableFile:
    """ValueError, in one line, where it is not one whole table file. The table's own head is not
    looked at."""
    head = unpacked(data[: WORD_BYTES * FILE_HEAD_WORDS])
    if len(head) < FILE_HEAD_WORDS or head[0] != MAGIC:
        raise ValueError("not a table file; `quiesce table pack` makes one of bare words")
    if head[-1] != crc_of(head[:-1]):
        raise ValueError("the CRC-32 of its head is wrong: it is damaged; copy or make it anew")
    count = head[2]
    _require_size(count)
    rest = data[WORD_BYTES * FILE_HEAD_WORDS :]
    words = unpacked(rest)
    if len(words) < count:
        raise ValueError(
            f"ends after {size_text(len(words))} where its head says {size_text(count)}; copy or "
            "make it anew"
        )
    if len(rest) > WORD_BYTES * count:
        raise ValueError(
            f"goes on after the {size_text(count)} that its head says; copy or make it anew"
        )
    return TableFile(words, head[1])


def read_file(file: Path) -> TableFile:
    """UsageError where it cannot be read or is not one whole table file."""
    try:
        with file.open("rb") as stream:
            return read_data(stream.read(_MOST_BYTES))
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name a table file")
    except ValueError as error:
        raise UsageError(f"{shown(file)}: {error}")


def read_words(file: Path) -> list[int]:
    """Of its table. UsageError likewise."""
    return read_file(file).words


def table_bytes(words: Sequence[int], board: int = ANY_BOARD) -> bytes:
    """The whole file. ValueError where a controller does not take so many words."""
    _require_size(len(words))
    head = [MAGIC, board, len(words)]
    return packed([*head, crc_of(head), *words])


def _require_size(count: int) -> None:
    require_room(count)
    if count < LEAST_WORDS:
        raise ValueError(
            f"a table of {size_text(count)}; one has at least {size_text(LEAST_WORDS)}"
        )
