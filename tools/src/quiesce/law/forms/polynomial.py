"""Tables of law `polynomial`: a current that is a polynomial of signals.

firmware/law/forms/law_polynomial.c describes the words.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.law.sections import CurrentSections, limited, read_sections
from quiesce.law.signal import Input, read_input
from quiesce.table.kinds import POLYNOMIAL
from quiesce.table.words import Reader

MAGIC = POLYNOMIAL.magic
MOST_INPUTS, MOST_TERMS, MOST_POWER = 4, 16, 3
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

    def words(self) -> list[int]:
        m, t = len(self.inputs), len(self.terms)
        if not (1 <= m <= MOST_INPUTS and 1 <= t <= MOST_TERMS):
            raise ValueError(f"{m} inputs and {t} terms of a damper")
        values = [m, t]
        for one, is_magnitude in zip(self.inputs, self.is_magnitude, strict=True):
            values += [*one.words(), int(is_magnitude)]
        for term in self.terms:
            packed = sum(power << 8 * i for i, power in enumerate(term.powers))
            values += [term.coefficient, packed]
        return values

    def currents_A(self, values: np.ndarray) -> np.ndarray:
        u = limited(self.inputs, values) / ONE_Q30
        u = np.where(self.is_magnitude, np.abs(u), u)
        total = sum(
            term.coefficient / ONE_mA_Q8 * np.prod(u ** np.array(term.powers), axis=1)
            for term in self.terms
        )
        return np.clip(1e-3 * total, 0.0, MOST_A)


class PolynomialTable(CurrentSections[PolynomialSection]):
    magic = MAGIC
    law = "polynomial"


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
    return PolynomialTable(read_sections(words, _read_section))


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
