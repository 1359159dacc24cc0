"""What frames take on a bus of 500 kbit/s: by priority, longest frames, in ticks."""

from collections.abc import Callable
from heapq import heappop, heappush
from itertools import count

from quiesce.can.bus_load import frame_bits

BITRATE, TICKS_A_SECOND = 500_000, 1000
TABLE_DATA = 0x410


class Bus:
    """Frames wait for those with lower ids; of TableData one in gap_ticks, as the controller's flow
    control wants it, however fast this machine is beside it."""

    def __init__(self, gap_ticks: int = 2) -> None:
        self._waiting: list[tuple[int, int, bytes, Callable[[bytes], None]]] = []
        self._numbers = count()
        self._left_bits = 0
        self._gap_ticks = gap_ticks
        self._tick = self._next_data_tick = 0
        self.bits = 0  # that have passed

    def put(self, line: bytes, deliver: Callable[[bytes], None]) -> None:
        heappush(self._waiting, (int(line[1:4], 16), next(self._numbers), line, deliver))

    def pass_tick(self) -> None:
        """A tick's time is over; what of it nobody used is lost."""
        self._tick += 1
        self._left_bits += BITRATE // TICKS_A_SECOND
        held = []
        while self._waiting and self._left_bits > 0:
            one = heappop(self._waiting)
            if one[0] == TABLE_DATA and self._tick < self._next_data_tick:
                held.append(one)
                continue
            self._send(one)
        self._left_bits = min(self._left_bits, 0)
        for one in held:
            heappush(self._waiting, one)

    def _send(self, one: tuple[int, int, bytes, Callable[[bytes], None]]) -> None:
        identifier, _, line, deliver = one
        bits = frame_bits(int(line[4:5]))
        self._left_bits -= bits
        self.bits += bits
        if identifier == TABLE_DATA:
            self._next_data_tick = self._tick + self._gap_ticks
        deliver(line)
