"""Signals that laws see, by name and place, and inputs of tables.

firmware/base/view_signal.h describes their words.
"""

from dataclasses import dataclass

from quiesce.table.words import Reader

LIMIT = 2**30 - 1  # of a value, and of one that is shifted
MOST_SHIFT = 29
MOST_PLACES = 4
COEFFICIENT_LIMIT = 2**24  # of a coefficient's magnitude, itself excluded


@dataclass(frozen=True)
class Quantity:
    name: str  # as boards and messages call it
    code: int  # quiesce_sense_t
    unit: str  # SI
    per_unit: float  # of the firmware's units
    of: str  # "body", "damper" or "board"
    usual: float  # a limit that no rig reaches, SI


QUANTITIES = (
    Quantity("acceleration", 0, "m/s2", 1e6, "body", 500.0),
    Quantity("velocity", 1, "m/s", 1e6, "body", 20.0),
    Quantity("displacement", 2, "m", 1e9, "body", 1.0),
    Quantity("stroke", 3, "m", 1e9, "damper", 1.0),
    Quantity("stroke velocity", 4, "m/s", 1e6, "damper", 20.0),
    Quantity("force", 5, "N", 1e3, "damper", 1e6),
    Quantity("coil voltage", 6, "V", 1e3, "damper", 1e3),
    Quantity("temperature", 7, "degC", 1e3, "damper", 500.0),
    Quantity("supply voltage", 8, "V", 1e3, "board", 1e3),
    Quantity("current", 9, "A", 1e3, "damper", 20.0),
)
BY_NAME = {quantity.name: quantity for quantity in QUANTITIES}


@dataclass(frozen=True)
class Signal:
    quantity: Quantity
    at: int  # body or damper, from 0

    @property
    def word(self) -> int:
        return self.quantity.code | self.at << 8

    @property
    def name(self) -> str:
        place = "" if self.quantity.of == "board" else f" of {self.quantity.of} {self.at + 1}"
        return self.quantity.name + place


def signal(name: str, at: int = 0) -> Signal:
    return Signal(BY_NAME[name], at)


@dataclass(frozen=True)
class Input:
    """A signal limited to +-limit, in the firmware's units, x 2^shift."""

    signal: Signal
    limit: int
    shift: int

    @classmethod
    def of(cls, wanted: Signal, limit: float | None = None) -> "Input":
        """limit in SI units; None: one that no rig reaches. The largest shift that fits."""
        size = wanted.quantity.usual if limit is None else limit
        units = max(1, min(LIMIT, round(size * wanted.quantity.per_unit)))
        return cls(wanted, units, (LIMIT // units).bit_length() - 1)

    @property
    def per_unit(self) -> float:
        """What it is in the table for 1 in its SI unit."""
        return self.signal.quantity.per_unit * 2.0**self.shift

    @property
    def largest(self) -> int:
        return self.limit << self.shift

    def words(self) -> list[int]:
        return [self.signal.word, self.limit, self.shift]


def signal_of(word: int) -> Signal:
    """ValueError, in one line, where the firmware refuses it."""
    code, at = word & 0xFF, word >> 8
    quantity = next((one for one in QUANTITIES if one.code == code), None)
    if quantity is None or not 0 <= at < (1 if quantity.of == "board" else MOST_PLACES):
        raise ValueError(f"0x{word & 0xFFFFFFFF:x} is no signal")
    return Signal(quantity, at)


def read_input(reader: Reader) -> Input:
    """ValueError, in one line, where the firmware refuses it."""
    word, limit, shift = reader.take(3)
    found = signal_of(word)
    if not (1 <= limit <= LIMIT and 0 <= shift <= MOST_SHIFT and limit << shift <= LIMIT):
        raise ValueError(f"a limit of {limit} x 2^{shift} is not in 1 .. 2^30 - 1")
    return Input(found, limit, shift)


def read_coefficients(reader: Reader, count: int) -> tuple[int, ...]:
    """ValueError where one is 2^24 or more."""
    found = reader.take(count)
    if any(abs(value) >= COEFFICIENT_LIMIT for value in found):
        raise ValueError("a coefficient of 2^24 or more")
    return tuple(found)
