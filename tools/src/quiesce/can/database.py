"""Messages of the CAN interface as quiesce.dbc describes them: the only source."""

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import root

CYCLIC = "Cyclic"
CYCLIC_IF_ACTIVE = "CyclicIfActive"
ON_REQUEST = "OnRequest"
# Lock-step messages and telemetry never share a bus with a controller at work.
FIRST_LOCKSTEP_ID = 0x600
# Of sensors and dampers after the first, whose messages are AccelSample and these without a number.
NUMBERED = re.compile(r"(CurrentDemand|SensorSample|CurrentMeasured)([1-9])")


@dataclass(frozen=True)
class Protection:
    """Where a message keeps its alive counter and its CRC."""

    frame_id: int
    length: int  # bytes; the CRC is the last one
    alive_bit: int  # first of four, little-endian numbering
    alive_is_free: bool  # the counter is not judged


@dataclass(frozen=True)
class Message:
    name: str
    frame_id: int
    length: int  # bytes
    sender: str
    send_type: str
    cycle_ms: int  # 0: none
    delay_ms: int  # least interval of a message on request, 0: none
    timeout_ms: int  # 0: none
    protection: Protection | None

    @property
    def period_ms(self) -> int:
        """Least time from one frame to the next; 0: the DBC says nothing."""
        return self.cycle_ms or self.delay_ms

    @property
    def is_lockstep(self) -> bool:
        return self.frame_id >= FIRST_LOCKSTEP_ID

    @property
    def kind(self) -> str:
        """Its name without the number of a sensor or damper: AccelSample is sensor 0's."""
        found = NUMBERED.fullmatch(self.name)
        return (found[1] if found else self.name).replace("AccelSample", "SensorSample")

    @property
    def number(self) -> int:
        """Of the sensor or damper that it belongs to; 0 for all others."""
        found = NUMBERED.fullmatch(self.name)
        return int(found[2]) if found else 0


class Database:
    """cantools' database, and the attributes that it leaves to its users."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.source = read_text(file)
        self.codec = load_dbc(self.source, file)
        self.messages = [message_of(one) for one in self.codec.messages]
        self.by_id = {one.frame_id: one for one in self.messages}
        self.by_name = {one.name: one for one in self.messages}
        # Of the messages: another number is incompatible (Identification). 0: the file has none.
        attributes = self.codec.dbc.attributes if self.codec.dbc else {}
        found = attributes.get("QuiesceInterfaceVersion")
        self.version = int(found.value) if found else 0
        self._codecs = {one.frame_id: one for one in self.codec.messages}

    def decode(self, frame_id: int, data: bytes) -> dict[str, Any]:
        """Signals by name: numbers, or the label where the value has one. Empty where the data are
        of no page that the message has."""
        from cantools.database import DecodeError

        try:
            return self._codecs[frame_id].decode(data, decode_choices=True)
        except DecodeError:
            return {}

    def raw(self, frame_id: int, data: bytes) -> dict[str, Any]:
        """Signals by name, integers only."""
        return self._codecs[frame_id].decode(data, decode_choices=False)

    def encode(self, name: str, **signals: int) -> bytes:
        """Data of a message; signals that are not given are 0."""
        message = self._codecs[self.by_name[name].frame_id]
        values = {signal.name: 0 for signal in message.signals}
        return bytes(message.encode({**values, **signals}, strict=False))

    def unit(self, frame_id: int, signal: str) -> str:
        return self._codecs[frame_id].get_signal_by_name(signal).unit or ""

    def signals(self, frame_id: int) -> list[Any]:
        """cantools' signals of a message."""
        return self._codecs[frame_id].signals

    def label(self, name: str, signal: str, value: int) -> str:
        choices = self._codecs[self.by_name[name].frame_id].get_signal_by_name(signal).choices
        return str((choices or {}).get(value, value))

    def number(self, name: str, signal: str, label: str) -> int:
        """Value of a label. KeyError where the DBC has none."""
        choices = self._codecs[self.by_name[name].frame_id].get_signal_by_name(signal).choices
        return {str(text): value for value, text in (choices or {}).items()}[label]


def shipped() -> Path:
    return root() / "firmware/comm/quiesce.dbc"


@cache
def load(file: Path | None = None) -> Database:
    """The shipped database, or another file. UsageError where it is none."""
    return Database(file or shipped())


def read_text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise UsageError(f"{file}: not a DBC file in UTF-8")


def load_dbc(source: str, file: Path) -> Any:
    import cantools

    try:
        codec = cantools.database.load_string(source, "dbc")
    except Exception as error:  # cantools has no common class for what its parsers raise
        raise UsageError(f"{file}: not a DBC file: {one_line(error)[:200]}")
    if not codec.messages:
        raise UsageError(f"{file}: not a DBC file: no message in it")
    return codec


def message_of(one: Any) -> Message:
    attributes = one.dbc.attributes if one.dbc else {}

    def attribute(name: str) -> int:
        return int(attributes[name].value) if name in attributes else 0

    return Message(
        name=one.name,
        frame_id=one.frame_id,
        length=one.length,
        sender=one.senders[0] if one.senders else "",
        send_type=one.send_type or ON_REQUEST,
        cycle_ms=one.cycle_time or 0,
        delay_ms=attribute("GenMsgDelayTime"),
        timeout_ms=attribute("QuiesceTimeoutMs"),
        protection=protection_of(one),
    )


def protection_of(one: Any) -> Protection | None:
    """None where the message has no signals `alive` and `crc`."""
    signals = {signal.name: signal for signal in one.signals}
    if "crc" not in signals or "alive" not in signals:
        return None
    # As in firmware/comm: stopping once too often is safe, and requests choose their own number.
    is_free = one.name in ("EmergencyStop", "ServiceRequest", "ServiceReply")
    return Protection(one.frame_id, one.length, signals["alive"].start, is_free)
