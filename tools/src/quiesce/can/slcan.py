"""SLCAN on serial lines, pseudo-terminals and TCP, in whole reads.

python-can's own class reads byte by byte, which does not keep up with a busy bus, and one byte
that is no ASCII leaves it unable to decode anything after. Here a malformed line is counted,
dropped and forgotten.
"""

import re
import select
import time
from collections import deque
from typing import Any

from quiesce.can.python_can import can  # isort: skip

from can.exceptions import CanInitializationError, error_check
from can.interfaces.slcan import slcanBus

# TIIIIIIIILDD.. with 8 bytes and a time stamp; beyond it a line is noise.
MAX_LINE = 30
# Kind, id, length; then data and possibly a time stamp. Hexadecimal digits only: Python's int()
# also takes blanks, signs and underscores.
FRAME = re.compile(
    rb"(?:([tr])([0-9A-Fa-f]{3})|([TR])([0-9A-Fa-f]{8}))([0-8])((?:[0-9A-Fa-f]{2})*)"
)
TIME_STAMP_DIGITS = 4
# Serial lines whose opening may reset the board behind them.
BOARDS = ("/dev/ttyACM", "/dev/ttyUSB")
RESET_S = 2.0
READ_BYTES = 4096
BELL = 0x07


class SlcanBus(slcanBus):
    """As python-can's; `malformed` counts lines that start like a frame and are none, or too
    long."""

    def __init__(self, channel: str, **options: Any) -> None:
        # A board that resets when its line is opened would miss the commands that open its channel
        # and the first requests. 'stop' does not wait: it opens with 0 and repeats its frame.
        options.setdefault("sleep_after_open", RESET_S if channel.startswith(BOARDS) else 0.0)
        self.malformed = 0
        self._frames: deque[can.Message] = deque()
        self._line = bytearray()
        self._is_noise = False
        super().__init__(channel, timeout=0, **options)
        with error_check(exception_type=CanInitializationError):
            self.serialPortOrig.write_timeout = 1.0

    def send(self, msg: can.Message, timeout: float | None = 1.0) -> None:
        super().send(msg, timeout or 1.0)

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if not self._frames:
            self._fill(timeout)
        return (self._frames.popleft() if self._frames else None), False

    def _fill(self, timeout: float | None) -> None:
        """Reads what is there, waiting at most so long for the first byte."""
        with error_check("Could not read from serial device"):
            ready, _, _ = select.select([self.serialPortOrig.fileno()], [], [], timeout)
            data = self.serialPortOrig.read(READ_BYTES) if ready else b""
        now_s = time.time()
        for byte in data:
            if byte in (0x0D, 0x0A, BELL):
                self._end_line(now_s)
            elif len(self._line) < MAX_LINE:
                self._line.append(byte)
            else:
                self._is_noise = True

    def _end_line(self, now_s: float) -> None:
        line, is_noise = bytes(self._line), self._is_noise
        self._line.clear()
        self._is_noise = False
        if is_noise or line[:1] in (b"t", b"T", b"r", b"R"):
            message = None if is_noise else frame_of(line, now_s)
            if message is None:
                self.malformed += 1
            else:
                self._frames.append(message)


def frame_of(line: bytes, now_s: float) -> can.Message | None:
    """None where the line is not exactly a classic frame. A time stamp after it is dropped."""
    match = FRAME.fullmatch(line)
    if match is None:
        return None
    short, short_id, long, long_id, length_digit, rest = match.groups()
    is_extended, is_remote = short is None, (short or long) in (b"r", b"R")
    frame_id, length = int(short_id or long_id, 16), int(length_digit)
    digits = 0 if is_remote else 2 * length
    if len(rest) not in (digits, digits + TIME_STAMP_DIGITS):
        return None
    if frame_id > (0x1FFFFFFF if is_extended else 0x7FF):
        return None
    return can.Message(
        timestamp=now_s,
        arbitration_id=frame_id,
        is_extended_id=is_extended,
        is_remote_frame=is_remote,
        dlc=length,
        data=None if is_remote else bytes.fromhex(rest[:digits].decode()),
    )
