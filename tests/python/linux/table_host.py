"""A host that loads and fetches tables: ISO-TP (ISO 15765-2) and files of tables, written from
docs/reference/can-messages.md, docs/reference/table-files.md and the messages alone."""

import struct
import time
import zlib
from dataclasses import dataclass

from quiesced_peer import DBC, Peer, slcan

DATA_ID = DBC.get_message_by_name("TableData").frame_id
LAW, TRACKER, LEARNT = 0, 1, 2  # roads
CRC, MAGIC, STORED_CRC, SOURCE, BOARD, WRITES, REFUSAL, RECORD = range(8)  # of TABLE_INFO
SHIPS, CAN, STORED, CONFIGURATION = 1, 2, 3, 4  # sources
DONE, STORE_FAILED, NOTHING_TO_SEND, TABLE_REFUSED, NOTHING_RECEIVED = 0, 5, 7, 10, 11
FILE_MAGIC = int.from_bytes(b"QTF1", "little")
CONTINUE, OVERFLOW = 0, 2  # flow status
SINGLE_MOST = 7  # bytes of a message that needs no flow control
SHORT_MOST = 4095  # of one whose first frame has 12 bits for its length
WORD = 2**32
ATTEMPTS = 5  # a busy machine may be silent for a second


def table(words: list[int]) -> list[int]:
    """The same with its own count and CRC."""
    after = [len(words), *(word % WORD for word in words[3:])]
    return [words[0], zlib.crc32(struct.pack(f"<{len(after)}I", *after)), *after]


def file_of(words: list[int], board: int = 0) -> bytes:
    head = struct.pack("<3I", FILE_MAGIC, board, len(words))
    return head + struct.pack("<I", zlib.crc32(head)) + struct.pack(f"<{len(words)}I", *words)


def words_of(data: bytes) -> list[int]:
    """The table of a file, both found whole."""
    count = len(data) // 4
    magic, _, size, crc, *words = struct.unpack(f"<{count}I", data)
    assert magic == FILE_MAGIC and size == len(words)
    assert crc == zlib.crc32(data[:12])
    assert words == table(words)
    return words


def padded(data: bytes) -> bytes:
    return data.ljust(8, b"\xcc")


def first_of(message: bytes) -> tuple[bytes, bytes]:
    """The first frame, and what is left."""
    length = len(message)
    if length <= SHORT_MOST:
        head = struct.pack(">H", 1 << 12 | length)
    else:
        head = struct.pack(">HI", 1 << 12, length)
    room = 8 - len(head)
    return head + message[:room], message[room:]


@dataclass
class TableHost:
    peer: Peer

    def load(self, message: bytes, crc: int, operation: str = "TABLE_COMMIT") -> tuple[int, int]:
        """Sends a file, and has it used. Returns result and value."""
        for _ in range(ATTEMPTS):
            self.send(message)
            result, value = self.ask(operation, LAW, crc)
            if result != NOTHING_RECEIVED:
                break
        return result, value

    def use(self, words: list[int]) -> None:
        assert self.load(file_of(words), words[1]) == (DONE, 0)

    def send(self, message: bytes) -> None:
        assert len(message) > SINGLE_MOST
        after = self.peer.count()
        first, rest = first_of(message)
        self._send(first)
        sequence = 1
        while rest:
            status, block, gap_s = self._await_flow(after)
            assert status == CONTINUE
            after = self.peer.count()
            for _ in range(block or len(rest)):
                if not rest:
                    break
                time.sleep(gap_s)
                self._send(padded(bytes([2 << 4 | sequence]) + rest[:7]))
                rest = rest[7:]
                sequence = (sequence + 1) % 16

    def fetch(self, road: int) -> bytes:
        """The file of what is in use."""
        for _ in range(ATTEMPTS):
            after = self.peer.count()
            result, length = self.ask("TABLE_SEND", road)
            assert result == DONE
            message = self._receive(length, after)
            if len(message) == length:
                return message
        raise AssertionError("no transfer got through")

    def _receive(self, length: int, after: int) -> bytes:
        got = b""
        expected = 1

        def take(signals: dict[str, int]) -> bool:
            nonlocal got, expected
            frame = signals["isotp_frame"].to_bytes(8, "little")
            if frame[0] >> 4 == 1 and not got:
                is_long = frame[:2] == b"\x10\x00"
                said = int.from_bytes(frame[2:6] if is_long else frame[:2], "big") & 0xFFFFFFF
                assert (said if is_long else said & 0xFFF) == length
                got = frame[6:] if is_long else frame[2:]
                self._send(padded(bytes([3 << 4 | CONTINUE, 0, 0])))
            elif frame[0] >> 4 == 2:
                assert frame[0] & 15 == expected
                expected = (expected + 1) % 16
                got += frame[1:]
            return len(got) >= length

        self.peer.wait("TableFlow", take, after)
        return got[:length]

    def ask(self, operation: str, road: int, value: int = 0) -> tuple[int, int]:
        """Result and value of the reply; a value is a word without a sign."""
        signed = value - WORD if value >= WORD // 2 else value
        reply = self.peer.request(operation, road, signed).signals
        return reply["result"], reply["param_value"] % WORD

    def info(self, road: int, number: int) -> int:
        result, value = self.ask("TABLE_INFO", road, number)
        assert result == DONE
        return value

    def _await_flow(self, after: int) -> tuple[int, int, float]:
        frame = self.peer.wait("TableFlow", lambda s: s["isotp_frame"] & 0xF0 == 3 << 4, after)
        status, block, gap_ms = frame.data[0] & 15, frame.data[1], frame.data[2]
        assert gap_ms <= 127  # milliseconds, not parts of them
        return status, block, gap_ms / 1e3

    def _send(self, data: bytes) -> None:
        self.peer.send_raw(slcan(DATA_ID, data))
