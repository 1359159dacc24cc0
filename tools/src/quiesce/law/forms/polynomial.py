"""Tables of law `polynomial`: a current that is a polynomial of signals.

firmware/law/forms/law_polynomial.c describes the words.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.law.signal import Input, Signal, read_input
from quiesce.law.words import Reader, opened, sealed

MAGIC = 0x314C5051
MOST_SECTIONS, MOST_INPUTS, MOST_TERMS, MOST_POWER = 4, 4, 16, 3
MOST_COEFFICIENT = 2**30 - 1
MOST_A = 20.0
ONE_Q30 = 2.0**30
ONE_mA_Q8 = 256


@dataclass(frozen=True)
class Term:
    """coefficient in mA, Q8, of the product of inputs, as Q30, to these powers."""

    coefficient: int
    powers: tuple[int, ...]  # one an input


@dataclass(frozen=True)
class PolynomialSection:
    """Of one damper; is_magnitude: of which inputs the sign is dropped."""

    inputs: tuple[Input, ...]
    is_magnitude: tuple[bool, ...]
    terms: tuple[Term, ...]


@dataclass(frozen=True)
class PolynomialTable:
    sections: tuple[PolynomialSection, ...]

    law = "polynomial"
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


def _section_words(section: PolynomialSection) -> list[int]:
    m, t = len(section.inputs), len(section.terms)
    if not (1 <= m <= MOST_INPUTS and 1 <= t <= MOST_TERMS):
        raise ValueError(f"{m} inputs and {t} terms of a damper")
    values = [m, t]
    for one, is_magnitude in zip(section.inputs, section.is_magnitude, strict=True):
        values += [*one.words(), int(is_magnitude)]
    for term in section.terms:
        packed = sum(power << 8 * i for i, power in enumerate(term.powers))
        values += [term.coefficient, packed]
    return values


def _currents_A(section: PolynomialSection, values: np.ndarray) -> np.ndarray:
    scale = np.array([one.per_unit for one in section.inputs])
    largest = np.array([one.largest for one in section.inputs])
    u = np.clip(values * scale, -largest, largest) / ONE_Q30
    u = np.where(section.is_magnitude, np.abs(u), u)
    total = sum(
        term.coefficient / ONE_mA_Q8 * np.prod(u ** np.array(term.powers), axis=1)
        for term in section.terms
    )
    return np.clip(1e-3 * total, 0.0, MOST_A)


def term(inputs: Sequence[Input], powers: Sequence[int], factor_A: float) -> Term:
    """factor_A for inputs in SI units. ValueError where 30 bits do not hold the coefficient."""
    scale = float(
        np.prod([(one.per_unit / ONE_Q30) ** p for one, p in zip(inputs, powers, strict=True)])
    )
    coefficient = round(1e3 * factor_A * ONE_mA_Q8 / scale)
    if abs(coefficient) > MOST_COEFFICIENT:
        largest_A = MOST_COEFFICIENT / ONE_mA_Q8 * scale / 1e3
        raise ValueError(f"a factor of {factor_A:g} is beyond {largest_A:.3g} for its limits")
    return Term(coefficient, tuple(powers))


def read(words: Sequence[int]) -> PolynomialTable:
    """ValueError, in one line, where the firmware refuses them."""
    reader = Reader(opened(words))
    count = reader.one(1, MOST_SECTIONS, "number of dampers")
    sections = tuple(_read_section(reader) for _ in range(count))
    reader.end()
    return PolynomialTable(sections)


def _read_section(reader: Reader) -> PolynomialSection:
    m = reader.one(1, MOST_INPUTS, "number of inputs")
    t = reader.one(1, MOST_TERMS, "number of terms")
    read_inputs = [(read_input(reader), reader.one(0, 1, "magnitude")) for _ in range(m)]
    terms = tuple(_read_term(reader, m) for _ in range(t))
    inputs = tuple(one for one, _ in read_inputs)
    return PolynomialSection(inputs, tuple(bool(flag) for _, flag in read_inputs), terms)


def _read_term(reader: Reader, inputs: int) -> Term:
    coefficient = reader.one(-MOST_COEFFICIENT, MOST_COEFFICIENT, "coefficient")
    packed = reader.take(1)[0] & 0xFFFFFFFF
    powers = [packed >> 8 * i & 0xFF for i in range(MOST_INPUTS)]
    if any(power > (MOST_POWER if i < inputs else 0) for i, power in enumerate(powers)):
        raise ValueError(f"powers {powers} of {inputs} inputs, each 0 .. {MOST_POWER}")
    return Term(coefficient, tuple(powers[:inputs]))
