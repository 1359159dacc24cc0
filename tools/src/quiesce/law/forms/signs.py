"""Tables of law `signs`: a current for each pattern of signs.

firmware/law/forms/law_signs.c describes the words.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.law.signal import COEFFICIENT_LIMIT, Input, Signal, read_coefficients, read_input
from quiesce.law.words import Reader, opened, sealed

MAGIC = 0x31475351
MOST_SECTIONS, MOST_INPUTS, MOST_SIGNS, MOST_SHIFT = 4, 6, 4, 40
MOST_mA = 20000


@dataclass(frozen=True)
class Combination:
    """On where the sum of coefficients x inputs is above band x 2^shift, off below minus that."""

    band: int
    shift: int
    coefficients: tuple[int, ...]


@dataclass(frozen=True)
class SignsSection:
    """Of one damper; currents_mA by the number whose bit j is the sign of combination j."""

    inputs: tuple[Input, ...]
    combinations: tuple[Combination, ...]
    idle_mA: int
    currents_mA: tuple[int, ...]


@dataclass(frozen=True)
class SignsTable:
    sections: tuple[SignsSection, ...]

    law = "signs"
    demands = "current"

    def signals(self) -> list[Signal]:
        return [one.signal for section in self.sections for one in section.inputs]

    def dampers(self) -> set[int]:
        return set(range(len(self.sections)))

    def words(self) -> list[int]:
        """ValueError where there is too much of it."""
        values = [len(self.sections)]
        for section in self.sections:
            values += _section_words(section)
        return sealed(MAGIC, values)

    def currents_A(self, values: np.ndarray) -> np.ndarray:
        """Of each damper [ticks 4] for signals [ticks, as signals() lists them] in SI units, in
        float64."""
        out = np.zeros((len(values), 4))
        first = 0
        for i, section in enumerate(self.sections):
            last = first + len(section.inputs)
            out[:, i] = _currents_A(section, values[:, first:last])
            first = last
        return out


def _section_words(section: SignsSection) -> list[int]:
    signs = len(section.combinations)
    if not (1 <= len(section.inputs) <= MOST_INPUTS and 1 <= signs <= MOST_SIGNS):
        raise ValueError(f"{len(section.inputs)} inputs and {signs} signs of a damper")
    values = [len(section.inputs), signs, section.idle_mA]
    for one in section.inputs:
        values += one.words()
    for combination in section.combinations:
        values += [combination.band, combination.shift, *combination.coefficients]
    return [*values, *section.currents_mA]


def _currents_A(section: SignsSection, values: np.ndarray) -> np.ndarray:
    scale = np.array([one.per_unit for one in section.inputs])
    largest = np.array([one.largest for one in section.inputs])
    u = np.clip(values * scale, -largest, largest)
    known = np.ones(len(values), dtype=bool)
    number = np.zeros(len(values), dtype=int)
    for j, one in enumerate(section.combinations):
        total = u @ np.array(one.coefficients, dtype=float)
        band = one.band * 2.0**one.shift
        said = np.where(total > band, 1, np.where(total < -band, 0, -1))
        last = np.maximum.accumulate(np.where(said >= 0, np.arange(len(said)), -1))
        known &= last >= 0
        number |= np.where(last >= 0, said[last], 0) << j
    currents = np.array(section.currents_mA)[number]
    return 1e-3 * np.where(known, currents, section.idle_mA)


def combination(inputs: Sequence[Input], factors: Sequence[float], band: float) -> Combination:
    """factors of the inputs' SI values; band in the unit of that sum. The largest coefficient gets
    all of its 24 bits."""
    raw = np.array([f / one.per_unit for f, one in zip(factors, inputs, strict=True)])
    if not np.abs(raw).max() > 0:
        raise ValueError("a combination of nothing")
    unit = (COEFFICIENT_LIMIT - 1) / np.abs(raw).max()
    coefficients = tuple(int(value) for value in np.rint(raw * unit))
    band_raw = band * unit
    shift = max(0, int(np.ceil(np.log2(max(band_raw, 1.0) / (COEFFICIENT_LIMIT - 1)))))
    return Combination(round(band_raw / 2.0**shift), shift, coefficients)


def read(words: Sequence[int]) -> SignsTable:
    """ValueError, in one line, where the firmware refuses them."""
    reader = Reader(opened(words))
    count = reader.one(1, MOST_SECTIONS, "number of dampers")
    sections = tuple(_read_section(reader) for _ in range(count))
    reader.end()
    return SignsTable(sections)


def _read_section(reader: Reader) -> SignsSection:
    m = reader.one(1, MOST_INPUTS, "number of inputs")
    s = reader.one(1, MOST_SIGNS, "number of signs")
    idle_mA = reader.one(0, MOST_mA, "idle current")
    inputs = tuple(read_input(reader) for _ in range(m))
    combinations = tuple(
        Combination(
            reader.one(0, COEFFICIENT_LIMIT - 1, "band"),
            reader.one(0, MOST_SHIFT, "shift"),
            read_coefficients(reader, m),
        )
        for _ in range(s)
    )
    currents = tuple(reader.one(0, MOST_mA, "current") for _ in range(2**s))
    return SignsSection(inputs, combinations, idle_mA, currents)
