"""Table files: their bytes, and what is refused."""

import re
import struct
import zlib
from pathlib import Path

import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.table.file import read_file, read_words, table_bytes
from quiesce.table.kinds import KINDS
from quiesce.table.words import MOST_WORDS, opened, sealed

TABLE = sealed(0x31475351, [1, -1, 2**31 - 1])


def head(count: int, board: int = 0, magic: bytes = b"QTF1") -> bytes:
    """Written here by itself, from the page on the format."""
    first = magic + struct.pack("<2I", board, count)
    return first + struct.pack("<I", zlib.crc32(first))


def test_bytes_are_those_of_the_page() -> None:
    table = b"QSG1" + struct.pack(
        "<I", zlib.crc32(struct.pack("<2Ii", 6, 1, -1) + b"\xff\xff\xff\x7f")
    )
    table += struct.pack("<2Ii", 6, 1, -1) + b"\xff\xff\xff\x7f"
    assert table_bytes(TABLE, 0x89ABCDEF) == head(6, 0x89ABCDEF) + table


@pytest.mark.parametrize("count", [4, MOST_WORDS])
def test_what_is_written_is_read(tmp_path: Path, count: int) -> None:
    file = tmp_path / "x.table"
    words = list(range(count))
    file.write_bytes(table_bytes(words, 7))
    found = read_file(file)
    assert (found.words, found.board) == (words, 7)
    assert read_words(file) == words


GOOD = table_bytes(TABLE)


def flipped(at: int) -> bytes:
    return GOOD[:at] + bytes([GOOD[at] ^ 16]) + GOOD[at + 1 :]


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"", "not a table file; `quiesce table pack`"),
        (b"31475351\n00000000\n00000004\n00000001\n", "not a table file"),
        (GOOD[16:], "not a table file"),
        (GOOD[:15], "not a table file"),
        (head(6, magic=b"QTF2") + GOOD[16:], "not a table file"),
        (flipped(5), "the CRC-32 of its head is wrong: it is damaged"),
        (flipped(8), "the CRC-32 of its head is wrong"),
        (flipped(15), "the CRC-32 of its head is wrong"),
        (head(3) + b"\0" * 12, "a table of 3 words, 12 bytes; one has at least 4 words, 16 bytes"),
        (
            head(2049) + b"\0" * 8196,
            "a table of 2049 words, 8196 bytes; a controller takes 2048 words, 8192 bytes",
        ),
        (head(2**32 - 1), "a table of 4294967295 words, 17179869180 bytes; a controller takes"),
        (GOOD[:16], "ends after 0 words, 0 bytes where its head says 6 words, 24 bytes"),
        (GOOD[:-1], "ends after 5 words, 20 bytes where its head says 6 words, 24 bytes"),
        (GOOD + b"\n", "goes on after the 6 words, 24 bytes that its head says"),
        (head(2048) + b"\0" * 8193, "goes on after the 2048 words, 8192 bytes"),
    ],
)
def test_damaged_files_are_refused_in_one_line(tmp_path: Path, data: bytes, why: str) -> None:
    file = tmp_path / "x.table"
    file.write_bytes(data)
    with pytest.raises(UsageError) as caught:
        read_file(file)
    assert str(caught.value).startswith(f"{file}: {why}") and "\n" not in str(caught.value)


def test_a_table_s_own_damage_is_not_the_file_s(tmp_path: Path) -> None:
    file = tmp_path / "x.table"
    file.write_bytes(flipped(30))
    with pytest.raises(ValueError, match="its CRC-32 is not that of its words"):
        opened(read_words(file))


def test_what_cannot_be_read_is_told(tmp_path: Path) -> None:
    for file in (tmp_path / "none.table", tmp_path):
        with pytest.raises(UsageError, match="; name a table file") as caught:
            read_file(file)
        assert str(caught.value).startswith(f"{file}: ")


def test_what_no_controller_takes_is_not_written() -> None:
    with pytest.raises(ValueError, match="2049 words, 8196 bytes; a controller takes 2048 words"):
        table_bytes([0] * 2049)
    with pytest.raises(ValueError, match="2049 words, 8196 bytes"):
        sealed(1, [0] * 2046)
    with pytest.raises(ValueError, match="at least 4 words"):
        table_bytes([1, 2, 3])


def test_first_words_of_kinds_stand_in_the_firmware() -> None:
    pattern = re.compile(r"#define \w+ UINT32_C\(0x([0-9A-F]{8})\)")
    found = set()
    for file in (ROOT / "firmware").rglob("*.[ch]"):
        found |= {int(one, 16) for one in pattern.findall(file.read_text(encoding="utf-8"))}
    assert set(KINDS) <= found
    assert len({one.name for one in KINDS.values()}) == len(KINDS)
    assert [one.version for one in KINDS.values()].count("2") == 1  # maps
