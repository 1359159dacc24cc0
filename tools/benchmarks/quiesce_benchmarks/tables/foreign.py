"""A host that knows the messages' DBC and docs/reference/can-messages.md, and nothing else of this
project: ISO-TP, requests and files of tables in a few lines."""

import struct
import time
import zlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any, Protocol

import cantools

DATA, FLOW, REPLY = 0x410, 0x418, 0x408
DONE, NOTHING_TO_SEND, NOTHING_RECEIVED, BUSY = (
    "DONE",
    "NOTHING_TO_SEND",
    "NOTHING_RECEIVED",
    "BUSY",
)
LAW, TRACKER, LEARNT = range(3)
CRC, MAGIC, STORED_CRC, SOURCE = range(4)  # of TABLE_INFO
WORD = 1 << 32
SHORT_MOST = 4095  # bytes that a first frame says in 12 bits
REPLY_S, TRIES, SILENCE_S = 1.0, 20, 5.0


class Line(Protocol):
    def listen(self, identifiers: Sequence[int]) -> "SimpleQueue[bytes]": ...

    def send(self, identifier: int, data: bytes) -> None: ...


def file_of(words: Sequence[int], board: int = 0) -> bytes:
    head = struct.pack("<3I", 0x31465451, board, len(words))
    return head + struct.pack(f"<I{len(words)}I", zlib.crc32(head), *words)


def words_in(data: bytes) -> list[int]:
    """Of a whole file; [] where it is none."""
    found = list(struct.unpack(f"<{len(data) // 4}I", data[: len(data) // 4 * 4]))
    if len(data) % 4 or len(found) < 8 or found[2] != len(found) - 4:
        return []
    if found[0] != 0x31465451 or found[3] != zlib.crc32(data[:12]):
        return []
    return found[4:] if found[5] == zlib.crc32(data[24:]) else []


def frames_of(data: bytes) -> list[bytes]:
    """Of ISO-TP, each of 8 bytes."""
    short = len(data) <= SHORT_MOST
    head = struct.pack(">H", 0x1000 | len(data)) if short else struct.pack(">HI", 0x1000, len(data))
    first = 8 - len(head)
    frames = [head + data[:first]]
    for number, at in enumerate(range(first, len(data), 7), 1):
        frames.append(bytes([0x20 | number % 16]) + data[at : at + 7])
    return [frame.ljust(8, b"\xcc") for frame in frames]


def crc8(data: bytes) -> int:
    """SAE J1850."""
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ 0x1D if crc & 0x80 else crc << 1) & 0xFF
    return crc ^ 0xFF


class Silence(Exception):
    """Nothing came that was waited for."""


class ForeignClient:
    def __init__(self, dbc: Path, line: Line) -> None:
        database = cantools.database.load_file(dbc)
        self._request = database.get_message_by_name("ServiceRequest")
        self._reply = database.get_message_by_name("ServiceReply")
        self._line = line
        self._heard = line.listen((REPLY, FLOW))
        self._alive = 0
        self.repeats = 0  # requests that were asked again

    def ask(self, operation: str, road: int = 0, value: int = 0) -> tuple[str, int]:
        """Result and value; asked again where nothing comes, or it is busy."""
        for _ in range(TRIES):
            self._ask_once(operation, road, value)
            try:
                while (reply := self._reply_in(self._next(REPLY, REPLY_S))) is None:
                    pass
            except Silence:
                self.repeats += 1
                continue
            if reply[0] != BUSY:
                return reply
            time.sleep(0.02)
        raise Silence(f"no answer to {operation}")

    def request(self, operation: str, road: int = 0, value: int = 0) -> None:
        """Without waiting for the answer."""
        self._ask_once(operation, road, value)

    def info(self, road: int, number: int) -> int:
        result, value = self.ask("TABLE_INFO", road, number)
        assert result == DONE, result
        return value

    def load(self, words: Sequence[int]) -> str:
        """Sends a table and has it used; again where not all of it came."""
        result = NOTHING_RECEIVED
        for _ in range(5):
            self.send(file_of(words))
            result, _value = self.ask("TABLE_COMMIT", 0, words[1])
            if result != NOTHING_RECEIVED:
                break
        return result

    def send(
        self,
        data: bytes,
        mangle: Callable[[int, bytes], Sequence[bytes]] = lambda number, frame: (frame,),
        silence_s: float = SILENCE_S,
    ) -> bool:
        """All frames. mangle(number, frame): what goes out in a frame's place; False where no flow
        control comes any more."""
        self._forget()
        frames = frames_of(data)
        left, gap_s = 0, 0.0
        for number, frame in enumerate(frames):
            if number > 0 and left == 0:
                try:
                    left, gap_s = self._flow(silence_s)
                except Silence:
                    return False
            for one in mangle(number, frame):
                self._line.send(DATA, one)
                time.sleep(gap_s)
            left -= number > 0
        return True

    def fetch(self, road: int) -> list[int]:
        """The table in use; [] where there is none."""
        for _ in range(TRIES):
            self._forget()
            result, size = self.ask("TABLE_SEND", road)
            if result == NOTHING_TO_SEND:
                return []
            try:
                found = words_in(b"".join(self._parts(size))[:size])
            except Silence:
                continue
            if found:
                return found
        raise Silence("no table came whole")

    def _parts(self, size: int) -> Iterator[bytes]:
        first = self._next(FLOW, SILENCE_S)
        yield first[6:] if first[:2] == b"\x10\0" else first[2:]
        self._line.send(DATA, bytes([0x30, 0, 1]).ljust(8, b"\xcc"))
        done = 2 if first[:2] == b"\x10\0" else 6
        for number in range(1, 1 + -(-(size - done) // 7)):
            frame = self._next(FLOW, SILENCE_S)
            if frame[0] != 0x20 | number % 16:
                raise Silence("a frame is missing")
            yield frame[1:]

    def _ask_once(self, operation: str, road: int, value: int) -> None:
        self._alive = (self._alive + 1) % 16
        data = self._request.encode(
            {
                "operation": operation,
                "param_index": road,
                "param_value": value - WORD if value >= WORD // 2 else value,
                "alive": self._alive,
                "crc": 0,
            }
        )
        identifier = self._request.frame_id
        crc = crc8(bytes([identifier & 0xFF, identifier >> 8]) + data[:-1])
        self._line.send(identifier, data[:-1] + bytes([crc]))

    def _reply_in(self, data: bytes) -> tuple[str, int] | None:
        found: dict[str, Any] = dict(self._reply.decode(data))
        if found["alive"] != self._alive:
            return None
        return str(found["result"]), int(found["param_value"]) % WORD

    def _flow(self, silence_s: float) -> tuple[int, float]:
        """Frames that may go, and their gap."""
        while True:
            frame = self._next(FLOW, silence_s)
            if frame[0] == 0x30:
                return frame[1] or 1 << 30, frame[2] / 1e3
            if frame[0] == 0x32:
                raise Silence("no room")

    def _next(self, identifier: int, silence_s: float) -> bytes:
        end_s = time.monotonic() + silence_s
        while True:
            try:
                line = self._heard.get(timeout=max(0.0, end_s - time.monotonic()))
            except Empty:
                raise Silence(f"nothing of 0x{identifier:03x}") from None
            if int(line[1:4], 16) == identifier:
                return bytes.fromhex(line[5:].decode())

    def _forget(self) -> None:
        while not self._heard.empty():
            self._heard.get()
