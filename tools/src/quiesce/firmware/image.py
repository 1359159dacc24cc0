"""An image as it is loaded: its bytes, where they go, and what it says of itself
(hal/image/image_info.h).

Files: ELF, Intel HEX, bare bytes (`.bin`), and bytes in a signed container (`.signed.bin`,
`.update`; container.py). Boot code before the image (`.updatable.bin`, `.updatable.signed`) is left
out.
"""

import hashlib
import struct
from dataclasses import dataclass
from io import BytesIO, StringIO
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.extras import extra
from quiesce.base.paths import shown
from quiesce.firmware.container import MAGIC as CONTAINER_MAGIC
from quiesce.firmware.container import payload_of
from quiesce.table.file import FILE_HEAD_WORDS, read_data
from quiesce.table.kinds import kind_name
from quiesce.table.words import WORD_BYTES, crc_of, unpacked

FLASH_BEGIN = 0x08000000
# With boot code before them, which has the first sector (hal/stm32f4/nvm_stm32f4.c).
SLOT_BEGINS = (0x08004000, 0x08020000)
BOOT_BYTES = SLOT_BEGINS[0] - FLASH_BEGIN
SLOT_BYTES = 0x1C000
SLOT_MARK_BYTES = 128  # hal/slots/slots.h
MOST_BYTES = 1 << 24  # of a file
INFO_MAGIC, INFO_LAYOUT = 0x474D4951, 1
INFO_WORDS, INFO_BEGIN = 8, 4
INFO_WITHIN = 4096  # of the image's beginning
SEAL_BYTES = 32
UNSEALED = b"\xff" * SEAL_BYTES
MOST_TABLES = 16
MOST_NAME = 64
COUNT_AT = 2  # of a table file's words: how many the table has


@dataclass(frozen=True)
class LinkedTable:
    """A table that is linked into the image: of its file's head and words."""

    kind: str
    words: int
    crc: int


@dataclass(frozen=True)
class Image:
    """payload: all that is loaded from `begin` on, the seal last."""

    payload: bytes
    begin: int
    version: tuple[int, int, int]
    board: str
    param_layout: int
    tables: tuple[LinkedTable, ...]

    @property
    def version_text(self) -> str:
        return ".".join(str(part) for part in self.version)

    @property
    def seal(self) -> bytes:
        return self.payload[-SEAL_BYTES:]

    @property
    def is_sealed(self) -> bool:
        return self.seal != UNSEALED

    @property
    def is_whole(self) -> bool:
        return self.seal == digest_of(self.payload)


def digest_of(payload: bytes) -> bytes:
    """What the seal should be."""
    return hashlib.sha256(payload[:-SEAL_BYTES]).digest()


def sealed(payload: bytes) -> bytes:
    return payload[:-SEAL_BYTES] + digest_of(payload)


def read_image(file: Path) -> Image:
    """UsageError, in one line, where it is no image of ours."""
    return image_of(read_bytes(file), file)


def read_bytes(file: Path) -> bytes:
    try:
        with file.open("rb") as stream:
            data = stream.read(MOST_BYTES + 1)
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name an image")
    if len(data) > MOST_BYTES:
        raise UsageError(f"{shown(file)}: longer than 16 MiB; name an image")
    return data


def image_of(data: bytes, file: Path) -> Image:
    """data: of that file. UsageError likewise."""
    try:
        begin, payload = loaded(data)
        return described(begin, payload)
    except ValueError as error:
        raise UsageError(f"{shown(file)}: {error}")


def loaded(data: bytes) -> tuple[int, bytes]:
    """Address and bytes, of any kind of file. ValueError where there are none."""
    if data[:4] == b"\x7fELF":
        return loaded_of_elf(data)
    if data[:1] == b":":
        return loaded_of_hex(data)
    if data[:4] == struct.pack("<I", CONTAINER_MAGIC):
        return placed(payload_of(data))
    return placed(data)


def placed(data: bytes) -> tuple[int, bytes]:
    """Bare bytes, where they say that they go, one of the places there are. Without boot code."""
    behind = data[BOOT_BYTES:]
    if info_at(data) < 0 and info_at(behind) >= 0:
        data = behind
    if (at := info_at(data)) >= 0 and len(words := unpacked(data[at:])[:INFO_WORDS]) == INFO_WORDS:
        if (begin := words[INFO_BEGIN]) in SLOT_BEGINS:
            return begin, data
    return FLASH_BEGIN, data


def info_at(payload: bytes) -> int:
    """Where it says what it is; negative where it does not."""
    at = payload[:INFO_WITHIN].find(struct.pack("<2I", INFO_MAGIC, INFO_LAYOUT))
    return at if at % WORD_BYTES == 0 else -1


def loaded_of_elf(data: bytes) -> tuple[int, bytes]:
    with extra("firmware", "an ELF file"):
        from elftools.common.exceptions import ELFError
        from elftools.elf.elffile import ELFFile
    try:
        segments = [
            (one["p_paddr"], one.data())
            for one in ELFFile(BytesIO(data)).iter_segments("PT_LOAD")
            if one["p_filesz"]
        ]
    except (ELFError, ValueError, TypeError, AttributeError):
        raise ValueError("a damaged ELF file")
    return joined(segments)


def loaded_of_hex(data: bytes) -> tuple[int, bytes]:
    with extra("firmware", "an Intel HEX file"):
        from intelhex import IntelHex, IntelHexError
    try:
        found = IntelHex(StringIO(data.decode("ascii")))
    except (IntelHexError, UnicodeDecodeError):
        raise ValueError("a damaged Intel HEX file")
    return joined([(a, found.tobinstr(a, b - 1)) for a, b in found.segments()])


def joined(segments: list[tuple[int, bytes]]) -> tuple[int, bytes]:
    """What lies between counts as zeros, as a linker fills it."""
    if not segments:
        raise ValueError("loads nothing; name an image")
    segments = sorted(segments)
    begin, end = segments[0][0], max(at + len(data) for at, data in segments)
    if end - begin > MOST_BYTES:
        raise ValueError("loads more than 16 MiB; name an image")
    payload = bytearray(end - begin)
    for at, data in segments:
        payload[at - begin : at - begin + len(data)] = data
    return begin, bytes(payload)


def described(begin: int, payload: bytes) -> Image:
    """ValueError where the bytes do not say what they are, or end before their seal does."""
    at = info_at(payload)
    if at < 0:
        raise ValueError("no image of this project: its first 4 KiB do not say what it is")
    words = unpacked(payload[at : at + INFO_WORDS * WORD_BYTES])
    if len(words) < INFO_WORDS:
        raise ValueError("is cut off")
    _, _, version, param_layout, loaded_at, seal_at, board_at, tables_at = words
    if loaded_at != begin:
        raise ValueError(f"is loaded at 0x{begin:08X}, and was linked for 0x{loaded_at:08X}")
    end = seal_at - begin + SEAL_BYTES
    if not at < end <= len(payload):
        raise ValueError(f"is cut off: {len(payload)} bytes of {end}")
    reader = Reader(begin, payload[:end])
    board = reader.text(reader.word(board_at))
    parts = (version >> 16, version >> 8 & 0xFF, version & 0xFF)
    return Image(payload[:end], begin, parts, board, param_layout, linked(reader, tables_at))


@dataclass(frozen=True)
class Reader:
    """What the target's pointers lead to."""

    begin: int
    payload: bytes

    def bytes_at(self, address: int, count: int) -> bytes:
        found = self.payload[address - self.begin : address - self.begin + count]
        if address < self.begin or len(found) < count:
            raise ValueError(f"says that something lies at 0x{address:08X}, outside of itself")
        return found

    def word(self, address: int) -> int:
        return unpacked(self.bytes_at(address, WORD_BYTES))[0]

    def text(self, address: int) -> str:
        self.bytes_at(address, 1)
        found = self.payload[address - self.begin :][: MOST_NAME + 1].split(b"\0")[0]
        if not found or len(found) > MOST_NAME or not found.isascii():
            raise ValueError("does not say which board it is for")
        return found.decode("ascii")


def linked(reader: Reader, address: int) -> tuple[LinkedTable, ...]:
    found: list[LinkedTable] = []
    while at := reader.word(address + WORD_BYTES * len(found)):
        if len(found) == MOST_TABLES:
            raise ValueError(f"says that it has more than {MOST_TABLES} tables")
        count = reader.word(at + WORD_BYTES * COUNT_AT)
        words = read_data(reader.bytes_at(at, WORD_BYTES * (FILE_HEAD_WORDS + count))).words
        found.append(LinkedTable(kind_name(words[0]), len(words), crc_of(words)))
    return tuple(found)
