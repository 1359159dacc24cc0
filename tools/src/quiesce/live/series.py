"""What of a bus can be drawn: every number that controller, driver and sensors send by themselves.

Taken from the database, so that a message that is added there can be drawn.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce.can.columns import raw_column
from quiesce.can.database import CYCLIC, Database, Message

# The firmware's sub-units, as people read them.
UNITS = {"mA": ("A", 1e-3), "um/s2": ("m/s2", 1e-6), "uHz": ("Hz", 1e-6), "nm": ("mm", 1e-6)}
SENDERS = ("Controller", "Driver", "Sensor")
PROTECTION = ("alive", "crc")
RAW = "RawSample"
TITLES = {
    "accel_counts": "acceleration",
    "sample_counts": "sensor",
    "rms_um_s2": "RMS",
    "freq_uHz": "frequency",
    "displacement_amp_nm": "displacement",
    "current_cmd_mA": "commanded current",
    "current_meas_mA": "measured current",
    "current_law_mA": "current that the law requests",
}
# Signals that another one of their message says are none.
VALID_BY = {(RAW, "current_meas_mA"): "current_is_measured"}
FREQUENCY = ("Motion", "freq_uHz")  # that the controller reports
RMS = ("Status", "rms_um_s2")  # of the acceleration, likewise
# Drawn where nobody has chosen, the first of each row that the bus carries.
PREFERRED = (
    ((RAW, "accel_counts"), ("AccelSample", "accel_counts")),
    (RMS,),
    (FREQUENCY,),
    (("Motion", "displacement_amp_nm"),),
    (("CurrentDemand", "current_cmd_mA"),),
    ((RAW, "current_meas_mA"), ("CurrentMeasured", "current_meas_mA")),
)


@dataclass(frozen=True)
class Series:
    """A signal, and where it is in the 8 bytes of its message."""

    number: int  # of the series, for as long as a server runs
    frame_id: int
    message: str
    signal: str
    title: str
    unit: str  # as people read it
    scale: float  # of the integer on the wire, to that unit
    start_bit: int  # little-endian
    bits: int
    is_signed: bool
    valid_bit: int | None  # 0 there: no value; None: always one

    def values(self, words: np.ndarray) -> np.ndarray:
        """The integers as float32 (exact up to 2^24; NaN: none) of messages as 64-bit words."""
        raw = raw_column(words, self.start_bit, self.bits, self.is_signed)
        values = raw.astype(np.float32)
        if self.valid_bit is not None:
            values[raw_column(words, self.valid_bit, 1, False) == 0] = np.nan
        return values


def catalogue(database: Database) -> tuple[Series, ...]:
    """In the order of the messages' ids."""
    found: list[Series] = []
    for message in sorted(database.messages, key=lambda one: one.frame_id):
        is_drawn = message.send_type == CYCLIC or message.name == RAW
        if message.is_lockstep or not is_drawn or message.sender not in SENDERS:
            continue
        signals = {one.name: one for one in database.signals(message.frame_id)}
        for name in (name for name in signals if name not in PROTECTION):
            valid = signals.get(VALID_BY.get((message.name, name), ""))
            found.append(series_of(len(found), message, signals[name], valid))
    return tuple(found)


def series_of(number: int, message: Message, signal: Any, valid: Any) -> Series:
    unit, scale = UNITS.get(signal.unit or "", (signal.unit or "", 1.0))
    words = TITLES.get(signal.name, signal.name.replace("_", " "))
    return Series(
        number=number,
        frame_id=message.frame_id,
        message=message.name,
        signal=signal.name,
        title=f"{words} {message.number}" if message.number else words,
        unit=unit,
        scale=scale,
        start_bit=signal.start,
        bits=signal.length,
        is_signed=signal.is_signed,
        valid_bit=valid.start if valid else None,
    )


def preferred(known: tuple[Series, ...], heard: set[int]) -> list[int]:
    """Numbers of the series to begin with. heard: ids of the messages that the bus carries."""
    by_name = {(one.message, one.signal): one for one in known if one.frame_id in heard}
    rows = (next((by_name[one] for one in row if one in by_name), None) for row in PREFERRED)
    return [one.number for one in rows if one is not None]
