"""Alive counter and CRC of safety-relevant messages; the same as firmware/comm/e2e.h.

CRC-8 SAE J1850: polynomial 0x1D, start 0xFF, inverted at the end, over the id's low byte, its high
byte and every data byte but the last, which is the CRC's own.
"""

from dataclasses import dataclass

from quiesce.can.database import Protection

POLYNOMIAL = 0x1D
ALIVE_PERIOD = 16

OK = "ok"
WRONG_SHAPE = "shape"
WRONG_CRC = "crc"
REPEATED = "repeated"
JUMPED = "jumped"


def crc_table() -> tuple[int, ...]:
    table = []
    for byte in range(256):
        for _ in range(8):
            byte = (byte << 1) ^ (POLYNOMIAL if byte & 0x80 else 0)
        table.append(byte & 0xFF)
    return tuple(table)


CRC_TABLE = crc_table()


def crc8(data: bytes) -> int:
    """CRC-8 SAE J1850; of b"123456789" it is 0x4B."""
    crc = 0xFF
    for byte in data:
        crc = CRC_TABLE[crc ^ byte]
    return crc ^ 0xFF


def frame_crc(frame_id: int, data: bytes) -> int:
    return crc8(bytes((frame_id & 0xFF, frame_id >> 8)) + data[:-1])


def alive_of(layout: Protection, data: bytes) -> int:
    return data[layout.alive_bit // 8] >> layout.alive_bit % 8 & 0xF


def protect(layout: Protection, alive: int, data: bytes) -> bytes:
    """The data with counter and CRC in their places. alive: 0 .. 15."""
    out = bytearray(data)
    byte, shift = divmod(layout.alive_bit, 8)
    out[byte] = out[byte] & ~(0xF << shift) | alive << shift
    out[-1] = frame_crc(layout.frame_id, bytes(out))
    return bytes(out)


@dataclass
class Receiver:
    """Judges the frames of one message in the order of their arrival."""

    layout: Protection
    alive: int | None = None  # of the last frame with a right CRC
    lost: int = 0  # frames missing, by the counter; 16 in a row look like none
    wrong_crc: int = 0
    wrong_shape: int = 0
    repeated: int = 0

    def take(self, data: bytes) -> str:
        """OK, or why the frame cannot be trusted; JUMPED: it can, but some before it are lost."""
        if len(data) != self.layout.length:
            self.wrong_shape += 1
            return WRONG_SHAPE
        if data[-1] != frame_crc(self.layout.frame_id, data):
            self.wrong_crc += 1
            return WRONG_CRC
        before, self.alive = self.alive, alive_of(self.layout, data)
        if before is None or self.layout.alive_is_free:
            return OK
        step = (self.alive - before) % ALIVE_PERIOD
        if step == 0:
            self.repeated += 1
            return REPEATED
        self.lost += step - 1
        return OK if step == 1 else JUMPED

    def forget(self) -> None:
        """The bus was away: any counter is right now."""
        self.alive = None
