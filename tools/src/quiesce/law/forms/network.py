"""Tables of law `network` and of tracker `network`: a small network a damper.

firmware/base/network.h describes the words, law_network.c and track_network.c whose signals they
name.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from quiesce.law.sections import CurrentSections, read_sections
from quiesce.law.signal import LIMIT, QUANTITIES, Quantity, Signal, signal_of
from quiesce.network.layers import (
    MOST_INPUTS,
    MOST_LAYERS,
    MOST_SHIFT,
    MOST_WORK,
    ONE,
    Layers,
    read_layers,
)
from quiesce.table.kinds import INVERSE_NETWORK, NETWORK
from quiesce.table.words import Reader

MAGIC = NETWORK.magic
TRACK_MAGIC = INVERSE_NETWORK.magic
MOST_DELAY, MOST_PAST = 8, 12
MOST_mA = 20000
DEMAND = Quantity("demand", 64, "N", 1e3, "damper", 1e6)
# What a tracker sees of its damper.
OF_DAMPER = tuple(one for one in QUANTITIES if one.of == "damper")
STROKE_VELOCITY = next(one for one in OF_DAMPER if one.name == "stroke velocity")
FORCE = next(one for one in OF_DAMPER if one.name == "force")


@dataclass(frozen=True)
class Span:
    """A signal limited to low .. high, in the firmware's units, and scaled to -1 .. 1."""

    signal: Signal
    low: int
    high: int
    factor: int
    shift: int

    @classmethod
    def of(cls, wanted: Signal, low: float, high: float) -> "Span":
        """low < high, in SI units."""
        units = [round(value * wanted.quantity.per_unit) for value in (low, high)]
        first = max(-LIMIT, min(LIMIT - 1, units[0]))
        last = max(first + 1, min(LIMIT, units[1]))
        shift = 0
        while (2 * ONE << (shift + 1)) // (last - first) <= LIMIT and shift < MOST_SHIFT:
            shift += 1
        return cls(wanted, first, last, max(1, (2 * ONE << shift) // (last - first)), shift)

    def scaled(self, values: np.ndarray) -> np.ndarray:
        """[ticks] in SI units to -1 .. 1."""
        units = np.clip(values * self.signal.quantity.per_unit, self.low, self.high)
        return (units - self.low) * (self.factor * 2.0**-self.shift / ONE) - 1.0

    def words(self) -> list[int]:
        return [self.signal.word, self.low, self.high, self.factor, self.shift]


@dataclass(frozen=True)
class NetworkSection:
    """Of one damper. least_um_s, of trackers only: slower than it the damper counts as if it moved
    at it, the way of the demand. delay_ticks 0: no delayed inputs;
    rate_Hz: of these ticks, 0 without them."""

    inputs: tuple[Span, ...]
    delay_ticks: int
    largest_mA: int
    layers: Layers
    least_um_s: int = 0
    rate_Hz: int = 0

    def words(self) -> list[int]:
        _require_sizes(len(self.inputs), self.delay_ticks, len(self.layers.layers))
        _require_rate(self.delay_ticks, self.rate_Hz)
        return [
            self.least_um_s,
            self.largest_mA,
            len(self.inputs),
            self.delay_ticks,
            self.rate_Hz,
            len(self.layers.layers),
            *(word for one in self.inputs for word in one.words()),
            *self.layers.words(),
        ]

    def currents_A(self, values: np.ndarray) -> np.ndarray:
        """[ticks] for its inputs [ticks, inputs] in SI units, in float64."""
        now = np.stack([one.scaled(values[:, k]) for k, one in enumerate(self.inputs)], axis=1)
        if self.delay_ticks:
            before = np.zeros_like(now)
            before[self.delay_ticks :] = now[: -self.delay_ticks]
            now = np.hstack([now, before])
        return 1e-3 * np.clip(self.layers.sums_mA(now), 0.0, self.largest_mA)

    @property
    def work(self) -> int:
        """Instructions, about."""
        return 120 + 40 * len(self.inputs) + self.layers.work


class NetworkTable(CurrentSections[NetworkSection]):
    magic: ClassVar[int] = MAGIC
    law: ClassVar[str] = "network"

    def words(self) -> list[int]:
        """ValueError where there is too much of it."""
        _require_work(self.sections)
        return super().words()


class NetworkTrackTable(NetworkTable):
    """Of the tracker: signals of the damper itself and the demand; a section a damper."""

    magic: ClassVar[int] = TRACK_MAGIC

    def currents_A(self, values: np.ndarray) -> np.ndarray:
        """Of each damper [ticks 4] for signals [ticks, as signals() lists them] in SI units, in
        float64."""
        judged, feasible = values.copy(), []
        first = 0
        for section in self.sections:
            last = first + len(section.inputs)
            feasible.append(_judge(section, judged[:, first:last]))
            first = last
        out = super().currents_A(judged)
        for i, one in enumerate(feasible):
            out[:, i] = np.where(one, out[:, i], 0.0)
        return out


def _judge(section: NetworkSection, values: np.ndarray) -> np.ndarray:
    """Which demands [ticks] the damper can meet; in place, the others are 0, and where it is slower
    than the least speed it moves at that. As the firmware does it, in whole units."""
    names = [one.signal.quantity.name for one in section.inputs]
    demand = names.index(DEMAND.name)
    way = values[:, names.index((FORCE if FORCE.name in names else STROKE_VELOCITY).name)]
    feasible = (values[:, demand] != 0.0) & (values[:, demand] * way >= 0.0)
    values[~feasible, demand] = 0.0
    if STROKE_VELOCITY.name in names:
        velocity = values[:, names.index(STROKE_VELOCITY.name)]
        least_m_s = section.least_um_s / STROKE_VELOCITY.per_unit
        slow = feasible & (np.abs(velocity) < least_m_s)
        velocity[slow] = np.sign(values[slow, demand]) * least_m_s
    return feasible


def _require_sizes(inputs: int, delay_ticks: int, layers: int) -> None:
    if not (1 <= inputs <= MOST_INPUTS and 1 <= layers <= MOST_LAYERS):
        raise ValueError(
            f"{inputs} inputs and {layers} layers; there may be 1 .. {MOST_INPUTS} and 1 .. "
            f"{MOST_LAYERS}"
        )
    if not (0 <= delay_ticks <= MOST_DELAY and delay_ticks * inputs <= MOST_PAST):
        raise ValueError(f"{inputs} inputs delayed by {delay_ticks} ticks; {MOST_PAST} values fit")


def _require_rate(delay_ticks: int, rate_Hz: int) -> None:
    if (rate_Hz > 0) != (delay_ticks > 0) or rate_Hz < 0:
        raise ValueError(f"a delay of {delay_ticks} ticks, {rate_Hz} of them a second")


def _require_work(sections: Sequence[NetworkSection]) -> None:
    work = sum(section.work for section in sections)
    if work > MOST_WORK:
        raise ValueError(
            f"some {work} instructions a tick; {MOST_WORK} are allowed: fewer units do"
        )


def read(words: Sequence[int]) -> NetworkTable:
    """ValueError, in one line, where the firmware refuses them."""
    sections = read_sections(words, lambda reader: _read_section(reader, False))
    _require_work(sections)
    return NetworkTable(sections)


def read_tracker(words: Sequence[int]) -> NetworkTrackTable:
    """ValueError, in one line, where the firmware refuses them."""
    sections = read_sections(words, lambda reader: _read_section(reader, True))
    _require_work(sections)
    return NetworkTrackTable(sections)


def _read_section(reader: Reader, of_tracker: bool) -> NetworkSection:
    least_um_s = reader.one(0, LIMIT if of_tracker else 0, "least speed")
    largest_mA = reader.one(1, MOST_mA, "largest current")
    m, delay_ticks, rate_Hz, count = reader.take(4)
    _require_sizes(m, delay_ticks, count)
    _require_rate(delay_ticks, rate_Hz)
    inputs = tuple(_read_span(reader, of_tracker) for _ in range(m))
    names = {one.signal.quantity.name for one in inputs}
    if of_tracker and not (DEMAND.name in names and names & {FORCE.name, STROKE_VELOCITY.name}):
        raise ValueError("it lacks the demand, or both force and stroke velocity")
    layers = read_layers(reader.take, m * (2 if delay_ticks else 1), count)
    return NetworkSection(inputs, delay_ticks, largest_mA, layers, least_um_s, rate_Hz)


def _read_span(reader: Reader, of_tracker: bool) -> Span:
    word, low, high, factor, shift = reader.take(5)
    wanted = _own_signal(word) if of_tracker else signal_of(word)
    if not -LIMIT <= low < high <= LIMIT:
        raise ValueError(f"an input of {low} .. {high}")
    if not (1 <= factor <= LIMIT and 0 <= shift <= MOST_SHIFT):
        raise ValueError(f"a factor of {factor} x 2^-{shift}")
    if (high - low) * factor >> shift > 2 * ONE:
        raise ValueError("an input that passes 1")
    return Span(wanted, low, high, factor, shift)


def _own_signal(word: int) -> Signal:
    for quantity in (*OF_DAMPER, DEMAND):
        if quantity.code == word:
            return Signal(quantity, 0)
    raise ValueError(f"0x{word & 0xFFFFFFFF:x} is no signal of a damper")
