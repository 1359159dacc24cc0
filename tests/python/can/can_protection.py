"""Protection of CAN messages, written again from the description in
docs/reference/can-messages.md: bit by bit, and from the DBC alone."""

from pathlib import Path

import cantools
from cantools.database.can import Database, Message

ROOT = Path(__file__).resolve().parents[3]


def load_database() -> Database:
    return cantools.database.load_file(ROOT / "firmware/comm/quiesce.dbc")


def crc8_j1850(data: bytes) -> int:
    """Polynomial 0x1D, start 0xFF, inverted at the end."""
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ 0x1D) & 0xFF if crc & 0x80 else crc << 1
    return crc ^ 0xFF


def frame_crc(frame_id: int, data: bytes) -> int:
    """What the last byte of a protected message has to be."""
    return crc8_j1850(bytes([frame_id & 0xFF, frame_id >> 8]) + data[:-1])


def is_protected(message: Message) -> bool:
    return any(signal.name == "crc" for signal in message.signals)


def encode(message: Message, alive: int, **values: int | str) -> bytes:
    """A frame of a protected message; signals that are not given are 0."""
    named = {s.name: 0 for s in message.signals} | values | {"alive": alive % 16, "crc": 0}
    data = message.encode(named)
    return data[:-1] + bytes([frame_crc(message.frame_id, data)])
