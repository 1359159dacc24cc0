"""A controller's side of tables over CAN, written from docs/reference/can-messages.md alone, on a
python-can bus: ISO-TP byte by byte, service replies, and the faults that a test asks for."""

import struct
import threading
import time
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field

import can
from can_protection import encode, frame_crc, load_database

DATABASE = load_database()
REQUEST, REPLY, DATA, FLOW, IDENTIFICATION = (
    DATABASE.get_message_by_name(name)
    for name in ("ServiceRequest", "ServiceReply", "TableData", "TableFlow", "Identification")
)
MOST_BYTES = 16 + 4 * 2048
BLOCK, GAP_MS, SILENCE_S = 32, 2, 1.0
ROADS = 3
IDENTIFIES_S = 0.05  # once a second is the real one's, which would be most of a test's time


@dataclass
class Faults:
    """What goes wrong. Counts are of frames that are lost, once each, in the order of arrival."""

    lose_data: set[int] = field(default_factory=set)  # numbers of TableData's frames
    lose_flow: set[int] = field(default_factory=set)  # numbers of TableFlow's frames
    twice_flow: set[int] = field(default_factory=set)  # sent twice: a wrong sequence number
    lose_replies: dict[str, int] = field(default_factory=dict)  # by operation, how many
    busy: dict[str, int] = field(default_factory=dict)  # by operation, how often
    results: dict[str, tuple[str, int]] = field(default_factory=dict)  # by operation: instead
    has_flow_control: bool = True
    waits: int = 0  # flow controls that ask to wait before the one that lets send
    most_bytes: int = MOST_BYTES
    is_silent: bool = False
    interface_version: int = 3
    is_old: bool = False  # firmware that knows nothing of tables
    ignores_commit: bool = False


@dataclass
class Road:
    shipped: list[int] = field(default_factory=list)
    words: list[int] = field(default_factory=list)
    previous: list[int] | None = None
    stored: list[int] = field(default_factory=list)
    source: int = 0
    writes: int = 0
    refusal: int = 0
    record: int | None = 0  # None: firmware that does not tell


def file_of(words: list[int], board: int = 0) -> bytes:
    head = struct.pack("<3I", 0x31465451, board, len(words))
    return head + struct.pack("<I", zlib.crc32(head)) + struct.pack(f"<{len(words)}I", *words)


def words_in(data: bytes) -> list[int] | None:
    """The table in a whole file."""
    if len(data) < 20 or len(data) % 4:
        return None
    head = struct.unpack_from("<4I", data)
    if head[0] != 0x31465451 or head[3] != zlib.crc32(data[:12]) or len(data) != 16 + 4 * head[2]:
        return None
    return list(struct.unpack_from(f"<{head[2]}I", data, 16))


class TableController(threading.Thread):
    """Runs until stop(). Tables of `magics` are taken, by road; others are refused as MAGIC."""

    def __init__(self, channel: str, parameters: dict[int, int], magics: dict[int, int]) -> None:
        super().__init__(daemon=True)
        self.faults = Faults()
        self.roads = [Road() for _ in range(ROADS)]
        self.parameters, self.magics = parameters, magics
        self.board = 0xB0A2D000
        self.verdict = 0  # of every table
        self.received = b""
        self.requests: list[str] = []
        self.frames: list[bytes] = []  # of TableData
        self._bus = can.Bus(interface="virtual", channel=channel)
        self._is_over = threading.Event()
        self._buffer = b""
        self._size = self._sequence = self._in_block = 0
        self._data_count = self._flow_count = 0

    def stop(self) -> None:
        self._is_over.set()
        self.join()
        self._bus.shutdown()

    def run(self) -> None:
        due_s = 0.0
        while not self._is_over.is_set():
            frame = self._bus.recv(0.01)
            if not self.faults.is_silent and time.monotonic() >= due_s:
                due_s = time.monotonic() + IDENTIFIES_S
                self._identify()
            if frame is None or self.faults.is_silent:
                continue
            if frame.arbitration_id == REQUEST.frame_id:
                self._answer(bytes(frame.data))
            elif frame.arbitration_id == DATA.frame_id:
                self._take(bytes(frame.data))

    def _identify(self) -> None:
        values = {signal.name: 0 for signal in IDENTIFICATION.signals}
        values["interface_version"] = self.faults.interface_version
        self._bus.send(
            can.Message(
                arbitration_id=0x132, is_extended_id=False, data=IDENTIFICATION.encode(values)
            )
        )

    # ISO-TP

    def _flow(self, data: bytes) -> None:
        number, self._flow_count = self._flow_count, self._flow_count + 1
        if number in self.faults.lose_flow:
            return
        padded = data.ljust(8, b"\xaa")
        for _ in range(2 if number in self.faults.twice_flow else 1):
            self._bus.send(can.Message(arbitration_id=0x418, is_extended_id=False, data=padded))

    def _go_on(self, status: int = 0) -> None:
        if self.faults.has_flow_control:
            self._flow(bytes([0x30 | status, BLOCK, GAP_MS]))

    def _take(self, data: bytes) -> None:
        assert len(data) == 8
        number, self._data_count = self._data_count, self._data_count + 1
        if number in self.faults.lose_data:
            return
        self.frames.append(data)
        if data[0] >> 4 == 1:
            self._take_first(data)
        elif data[0] >> 4 == 2 and self._size:
            self._take_next(data)

    def _take_first(self, data: bytes) -> None:
        size, at = (data[0] & 15) << 8 | data[1], 2
        if size == 0:
            size, at = int.from_bytes(data[2:6], "big"), 6
        self.received = b""
        if size > self.faults.most_bytes:
            self._size = 0
            self._go_on(2)
            return
        self._buffer, self._size, self._sequence, self._in_block = data[at:], size, 1, 0
        for _ in range(self.faults.waits):
            self._go_on(1)
        self._go_on()

    def _take_next(self, data: bytes) -> None:
        if data[0] & 15 != self._sequence:
            self._size = 0  # all of it is given up
            return
        self._sequence = (self._sequence + 1) % 16
        self._buffer += data[1:]
        self._in_block += 1
        if len(self._buffer) >= self._size:
            self.received, self._size = self._buffer[: self._size], 0
        elif self._in_block == BLOCK:
            self._in_block = 0
            self._go_on()

    def _send(self, data: bytes) -> None:
        """Block by block, as the host's flow control says."""
        parts = self._parts(data)
        self._flow(next(parts))
        left = 0
        for part in parts:
            if left == 0:
                control = self._await_flow_control()
                if control is None:
                    return
                left, gap_s = control[1] or 1 << 30, control[2] / 1000.0
            time.sleep(gap_s)
            self._flow(part)
            left -= 1

    @staticmethod
    def _parts(data: bytes) -> Iterator[bytes]:
        size = len(data)
        is_long = size > 4095
        head = (
            b"\x10\0" + size.to_bytes(4, "big") if is_long else (0x1000 | size).to_bytes(2, "big")
        )
        first = 8 - len(head)
        yield head + data[:first]
        for number, at in enumerate(range(first, size, 7), 1):
            yield bytes([0x20 | number % 16]) + data[at : at + 7]

    def _await_flow_control(self) -> bytes | None:
        end_s = time.monotonic() + SILENCE_S
        while time.monotonic() < end_s and not self._is_over.is_set():
            frame = self._bus.recv(0.05)
            if frame is not None and frame.arbitration_id == DATA.frame_id:
                return bytes(frame.data) if frame.data[0] == 0x30 else None
            if frame is not None and frame.arbitration_id == REQUEST.frame_id:
                self._answer(bytes(frame.data), is_sending=True)
        return None

    # Services

    def _answer(self, data: bytes, is_sending: bool = False) -> None:
        assert data[-1] == frame_crc(REQUEST.frame_id, data)
        raw = REQUEST.decode(data, decode_choices=False)
        name = str(REQUEST.get_signal_by_name("operation").choices[raw["operation"]])
        self.requests.append(name)
        result, value = "BUSY", 0
        if not is_sending:
            result, value = self._result(name, raw["param_index"], raw["param_value"])
        if self.faults.lose_replies.get(name, 0) > 0:
            self.faults.lose_replies[name] -= 1
            return
        labels = {str(v): k for k, v in REPLY.get_signal_by_name("result").choices.items()}
        reply = encode(
            REPLY,
            raw["alive"],
            operation=raw["operation"],
            param_index=raw["param_index"],
            result=labels[result],
            param_value=value - (1 << 32) if value >= 1 << 31 else value,
        )
        self._bus.send(can.Message(arbitration_id=0x408, is_extended_id=False, data=reply))
        if name == "TABLE_SEND" and result == "DONE":
            self._send(file_of(self.roads[raw["param_index"]].words, self.board))

    def _result(self, name: str, index: int, value: int) -> tuple[str, int]:
        if name == "READ":
            return "DONE", self.parameters[index]
        if self.faults.is_old:
            return "NO_SUCH_OPERATION", 0
        if self.faults.busy.get(name, 0) > 0:
            self.faults.busy[name] -= 1
            return "BUSY", 0
        if name in self.faults.results:
            return self.faults.results[name]
        if index >= ROADS:
            return "NO_SUCH_TABLE", 0
        return getattr(self, f"_{name.lower()}")(index, value % (1 << 32))

    def _judged(self, crc: int) -> tuple[str, int, list[int]]:
        words = words_in(self.received)
        if words is None or words[1] != crc:
            return "NOTHING_RECEIVED", 0, []
        road = self._road_of(words[0])
        verdict = self.verdict or (2 if road is None else 0)
        if verdict:
            self.roads[road or 0].refusal = verdict
            return "TABLE_REFUSED", verdict, []
        return "DONE", 0, words

    def _road_of(self, magic: int) -> int | None:
        return next((road for road, taken in self.magics.items() if taken == magic), None)

    def _table_check(self, _index: int, crc: int) -> tuple[str, int]:
        return self._judged(crc)[:2]

    def _table_commit(self, _index: int, crc: int) -> tuple[str, int]:
        result, value, words = self._judged(crc)
        if result == "DONE":
            road = self.roads[self._road_of(words[0]) or 0]
            if not self.faults.ignores_commit:
                road.previous, road.words, road.source = road.words, words, 2
            self.received = b""
        return result, value

    def _table_revert(self, index: int, _value: int) -> tuple[str, int]:
        road = self.roads[index]
        if road.previous is None:
            return "NOTHING_TO_SEND", 0
        road.words, road.previous = road.previous, None
        road.source = 1 if road.words == road.shipped else 2
        return "DONE", 0

    def _table_ship(self, index: int, _value: int) -> tuple[str, int]:
        road = self.roads[index]
        road.previous, road.words = road.words, road.shipped
        road.source = 1 if road.shipped else 0
        return "DONE", 0

    def _table_save(self, index: int, _value: int) -> tuple[str, int]:
        road = self.roads[index]
        road.stored = [] if road.source == 1 else road.words
        road.writes += 1
        return "DONE", 0

    def _table_info(self, index: int, what: int) -> tuple[str, int]:
        road = self.roads[index]

        def word(words: list[int], at: int) -> int:
            return words[at] if words else 0

        told = (
            word(road.words, 1), word(road.words, 0), word(road.stored, 1), road.source, self.board,
            road.writes, road.refusal, road.record,
        )  # fmt: skip
        value = told[what] if what < len(told) else None
        return ("NO_SUCH_TABLE", 0) if value is None else ("DONE", value)

    def _table_send(self, index: int, _value: int) -> tuple[str, int]:
        words = self.roads[index].words
        return ("DONE", len(file_of(words))) if words else ("NOTHING_TO_SEND", 0)

    def _learnt_restore(self, _index: int, _value: int) -> tuple[str, int]:
        road = self.roads[2]
        if not road.stored:
            return "NOTHING_TO_SEND", 0
        road.words = road.stored
        return "DONE", 0

    def _learnt_forget(self, _index: int, _value: int) -> tuple[str, int]:
        self.roads[2].words = []
        return "DONE", 0
