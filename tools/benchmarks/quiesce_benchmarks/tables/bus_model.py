"""How long a table takes on a bus of 500 kbit/s beside full telemetry, in the worst case: computed
from the messages, as `quiesce can bus-load` does."""

from collections.abc import Sequence
from math import ceil

from quiesce.can import bus_load
from quiesce.can.database import Database

from quiesce_benchmarks.tables.bus import BITRATE

BLOCK, GAP_MS, TICK_MS = 32, 2, 1
FIRST_BYTES, NEXT_BYTES = 6, 7  # of the file, in a frame


def beside(database: Database) -> list[bus_load.Message]:
    """All that is cyclic, a sensor node's samples and raw streaming."""
    return [
        *bus_load.cyclic(database), *bus_load.samples(database, 1),
        *bus_load.named(database, bus_load.RAW),
    ]  # fmt: skip


def busy_bits(frames: int, above: Sequence[bus_load.Stream]) -> int:
    """Until so many frames that wait for all others have passed."""
    own = frames * bus_load.frame_bits(8)
    t = own
    while (demand := own + sum(ceil(t / one.period) * one.bits for one in above)) > t:
        t = demand
    return t


def frames_of(size: int) -> int:
    return 1 + ceil((size - FIRST_BYTES) / NEXT_BYTES)


def transfer_s(database: Database, size: int) -> float:
    """A block takes its gaps, or longer where the bus does; then the flow control has to come."""
    above = bus_load.streams(beside(database), BITRATE)
    left, total_ms = frames_of(size) - 1, 0.0

    def bus_ms(frames: int) -> float:
        return 1e3 * busy_bits(frames, above) / BITRATE

    total_ms += bus_ms(1)  # the first frame
    while left > 0:
        block = min(left, BLOCK)
        total_ms += TICK_MS + bus_ms(1) + max(block * GAP_MS, bus_ms(block))
        left -= block
    return 1e-3 * total_ms
