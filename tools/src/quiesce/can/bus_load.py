"""Bus load and worst-case response times, computed from the DBC.

Frame length with worst-case stuffing and the response-time analysis are those of R. I. Davis,
A. Burns, R. J. Bril, J. J. Lukkien, "Controller Area Network (CAN) schedulability analysis:
refuted, revisited and revised", Real-Time Systems 35 (2007); the error model is theirs with a
rate: each error costs an error frame and the longest repetition.
Times are in bits: integers, exact; milliseconds only where they are shown.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

from quiesce.base.table import format_table
from quiesce.can.database import (
    CYCLIC,
    CYCLIC_IF_ACTIVE,
    Database,
    Message,
)

ERROR_FRAME_BITS = 31  # with what follows it, the paper's section 3.4
RAW = "RawSample"
RECORD = "FaultRecord"  # on request
# A transfer has data one way, and the other way one frame in 64 ms, which is not counted.
TABLE, TABLE_BACK = "TableData", "TableFlow"
SENSOR = "SensorSample"  # of every sensor on the bus
OF_DAMPERS = ("CurrentDemand", "CurrentMeasured")
# Rates that serial adapters commonly have.
BAUD_RATES = (9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600)
BAUD_RATES += (1_000_000, 1_500_000, 2_000_000, 3_000_000, 4_000_000)
UART_BITS_PER_CHARACTER = 10


def frame_bits(length: int) -> int:
    """Longest standard frame of so many data bytes, with its inter-frame space, in bits."""
    return 8 * length + 47 + (34 + 8 * length - 1) // 4


def slcan_characters(length: int) -> int:
    """tIIIL, two a byte, CR."""
    return 6 + 2 * length


@dataclass(frozen=True)
class Stream:
    """A message with its least period, in bits."""

    message: Message
    bits: int
    period: int


def streams(messages: Sequence[Message], bitrate: int) -> list[Stream]:
    """In the order of priority."""
    return [
        Stream(one, frame_bits(one.length), one.period_ms * bitrate // 1000)
        for one in sorted(messages, key=lambda one: one.frame_id)
    ]


def load_pct(messages: Sequence[Message], bitrate: int) -> float:
    return sum(100.0 * 1000 * frame_bits(m.length) / m.period_ms / bitrate for m in messages)


def cyclic(database: Database, dampers: int = 1) -> list[Message]:
    """What the controller's own configuration puts on a bus all the time, and while a fault or an
    emergency stop holds: everything with a cycle time but samples. Those of sensor nodes are only
    on buses that have them."""
    return [
        m
        for m in database.messages
        if m.send_type in (CYCLIC, CYCLIC_IF_ACTIVE)
        and m.kind not in (RAW, RECORD, SENSOR)
        and is_there(m, 0, dampers)
    ]


def is_there(message: Message, sensors: int, dampers: int) -> bool:
    """Whether a bus of so many sensors and dampers carries it."""
    if message.kind == SENSOR:
        return message.number < sensors
    return message.kind not in OF_DAMPERS or message.number < dampers


def samples(database: Database, sensors: int) -> list[Message]:
    """Those of so many sensors."""
    return [m for m in database.messages if m.kind == SENSOR and m.number < sensors]


def totals_pct(
    database: Database, bitrate: int, sensors: int = 1, dampers: int = 1
) -> dict[str, float]:
    """Loads of the bus in what it may carry."""
    base, raw = cyclic(database, dampers), named(database, RAW)
    sensor = samples(database, sensors)
    chosen = {
        "cyclic": base,
        "with_raw": base + raw,
        "with_sensor_node": base + sensor,
        "with_sensor_node_and_raw": base + sensor + raw,
        "everything": everything(database, sensors, dampers),
        "with_table": on_bus(database, sensors, dampers),
    }
    return {name: load_pct(messages, bitrate) for name, messages in chosen.items()}


TOTAL_WORDS = {
    "cyclic": "cyclic messages of the controller's own configuration, no sensor node",
    "with_raw": "the same with raw streaming",
    "with_sensor_node": "cyclic messages with a sensor node on the bus",
    "with_sensor_node_and_raw": "the same with raw streaming",
    "everything": "everything at once, services too, but no table",
    "with_table": "the same while a table is transferred",
}
LEFT_OUT = (
    "The first leaves out AccelSample: a sensor node sends it, and exists only on buses that have "
    "one."
)


def totals_table(totals: dict[str, float], bitrate: int) -> str:
    """totals: of totals_pct()."""
    rows = [(words, totals[name]) for name, words in TOTAL_WORDS.items()]
    return f"{format_table([f'load at {bitrate} bit/s', '%||.1f'], rows)}\n{LEFT_OUT}"


def on_bus(database: Database, sensors: int = 1, dampers: int = 1) -> list[Message]:
    """Everything that may meet on a bus at work, samples, services and a table, too."""
    return [
        m
        for m in database.messages
        if m.period_ms > 0
        and m.name != TABLE_BACK
        and not m.is_lockstep
        and is_there(m, sensors, dampers)
    ]


def everything(database: Database, sensors: int, dampers: int) -> list[Message]:
    """The same without a table."""
    return [m for m in on_bus(database, sensors, dampers) if m.name != TABLE]


def named(database: Database, name: str) -> list[Message]:
    return [database.by_name[name]] if name in database.by_name else []


class Analysis:
    """Response times of messages that are queued at their least periods, in the worst phase.

    jitter_ms: of the queueing, for all; errors_per_s: bus errors, evenly spread, 0: none.
    """

    def __init__(
        self,
        messages: Sequence[Message],
        bitrate: int,
        jitter_ms: float = 0.0,
        errors_per_s: float = 0.0,
    ) -> None:
        self.streams = streams(messages, bitrate)
        self.bitrate = bitrate
        self.jitter = ceil(jitter_ms * bitrate / 1000)
        self.errors_per_bit = errors_per_s / bitrate

    def response(self, index: int) -> int | None:
        """Bits from the event to the last bit on the wire; None: no bound, the bus is too full."""
        own, above = self.streams[index], self.streams[: index + 1]
        if not self.is_bounded(above):
            return None
        blocking = max((one.bits for one in self.streams[index + 1 :]), default=0)
        period = self._fixed_point(own.bits, blocking, above, 0, above)
        instances = ceil((period + self.jitter) / own.period)
        worst = 0
        queueing = 0
        for q in range(instances):
            start = max(queueing, blocking + q * own.bits)
            queueing = self._queueing(start, blocking + q * own.bits, index)
            worst = max(worst, self.jitter + queueing - q * own.period + own.bits)
        return worst

    def is_bounded(self, above: Sequence[Stream]) -> bool:
        """Whether the load of these, errors included, leaves the bus idle now and then."""
        load = sum(one.bits / one.period for one in above)
        return load + self.errors_per_bit * self._error_bits(above) < 1.0

    def _queueing(self, start: int, fixed: int, index: int) -> int:
        """Time from the start of the busy period until the frame begins."""
        own, above = self.streams[index], self.streams[:index]
        return self._fixed_point(start, fixed, above, 1, self.streams[: index + 1], own.bits)

    def _fixed_point(
        self,
        start: int,
        fixed: int,
        interfering: Sequence[Stream],
        bit: int,
        repeated: Sequence[Stream],
        own_bits: int = 0,
    ) -> int:
        """Least t = fixed + errors(t + own_bits) + frames of the interfering within t."""
        t = start
        while True:
            demand = fixed + self._errors(t + own_bits, repeated)
            demand += sum(ceil((t + self.jitter + bit) / s.period) * s.bits for s in interfering)
            if demand <= t:
                return t
            t = demand

    def _errors(self, window: int, repeated: Sequence[Stream]) -> int:
        return ceil(self.errors_per_bit * window) * self._error_bits(repeated)

    @staticmethod
    def _error_bits(repeated: Sequence[Stream]) -> int:
        return ERROR_FRAME_BITS + max(one.bits for one in repeated)

    def response_ms(self, name: str) -> float | None:
        index = [one.message.name for one in self.streams].index(name)
        bits = self.response(index)
        return None if bits is None else 1000.0 * bits / self.bitrate


def baud_needed(messages: Sequence[Message]) -> tuple[float, int | None]:
    """Bits a second of a UART that carries these as SLCAN one way, and the next usual rate; None
    where it is beyond all."""
    need = sum(
        UART_BITS_PER_CHARACTER * 1000.0 * slcan_characters(m.length) / m.period_ms
        for m in messages
    )
    return need, next((rate for rate in BAUD_RATES if rate >= need), None)


def slcan_messages(database: Database, dampers: int = 1) -> list[Message]:
    """What a controller sends when everything is on and a table is fetched."""
    sent = on_bus(database, 0, dampers) + named(database, TABLE_BACK)
    return [m for m in sent if m.sender == "Controller"]
