"""Tables of law `signs`: a current for each pattern of signs.

firmware/law/forms/law_signs.c describes the words.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.law.sections import CurrentSections, limited, read_sections
from quiesce.law.signal import COEFFICIENT_LIMIT, Input, read_coefficients, read_input
from quiesce.table.kinds import SIGNS
from quiesce.table.words import Reader

MAGIC = SIGNS.magic
MOST_INPUTS, MOST_SIGNS, MOST_SHIFT = 6, 4, 40
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

    def words(self) -> list[int]:
        signs = len(self.combinations)
        if not (1 <= len(self.inputs) <= MOST_INPUTS and 1 <= signs <= MOST_SIGNS):
            raise ValueError(f"{len(self.inputs)} inputs and {signs} signs of a damper")
        values = [len(self.inputs), signs, self.idle_mA]
        for one in self.inputs:
            values += one.words()
        for combination in self.combinations:
            values += [combination.band, combination.shift, *combination.coefficients]
        return [*values, *self.currents_mA]

    def currents_A(self, values: np.ndarray) -> np.ndarray:
        u = limited(self.inputs, values)
        known = np.ones(len(values), dtype=bool)
        number = np.zeros(len(values), dtype=int)
        for j, one in enumerate(self.combinations):
            total = u @ np.array(one.coefficients, dtype=float)
            band = one.band * 2.0**one.shift
            said = np.where(total > band, 1, np.where(total < -band, 0, -1))
            last = np.maximum.accumulate(np.where(said >= 0, np.arange(len(said)), -1))
            known &= last >= 0
            number |= np.where(last >= 0, said[last], 0) << j
        currents = np.array(self.currents_mA)[number]
        return 1e-3 * np.where(known, currents, self.idle_mA)


class SignsTable(CurrentSections[SignsSection]):
    magic = MAGIC
    law = "signs"


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
    return SignsTable(read_sections(words, _read_section))


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
