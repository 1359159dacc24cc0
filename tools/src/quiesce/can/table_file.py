"""A table's file: four words, then the table's own. To be replaced by quiesce.table."""

import struct
import zlib

CONTAINER = 0x31465451  # "QTF1"
HEAD_WORDS = 4
MOST_WORDS = 2048
LEAST_WORDS = 4


def file_bytes(words: list[int], board: int = 0) -> bytes:
    head = struct.pack("<3I", CONTAINER, board, len(words))
    return head + struct.pack(f"<I{len(words)}I", zlib.crc32(head), *words)


def words_of(data: bytes) -> list[int]:
    """The table's words. ValueError, in one line, where these are not a table's file."""
    head = 4 * HEAD_WORDS
    if len(data) < head or len(data) % 4:
        raise ValueError(f"{len(data)} bytes are no file of a table")
    magic, _, count, crc = struct.unpack_from("<4I", data)
    if magic != CONTAINER or crc != zlib.crc32(data[: head - 4]):
        raise ValueError("it does not begin as a file of a table does")
    if not LEAST_WORDS <= count <= MOST_WORDS:
        raise ValueError(f"{count} words; a controller takes {LEAST_WORDS} .. {MOST_WORDS}")
    if len(data) != head + 4 * count:
        raise ValueError(f"{len(data)} bytes where its head says {head + 4 * count}")
    words = list(struct.unpack_from(f"<{count}I", data, head))
    if words[2] != count or words[1] != zlib.crc32(data[head + 8 :]):
        raise ValueError("its CRC-32 is not that of its words: it is damaged")
    return words
