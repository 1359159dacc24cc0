"""A bank of models at constant currents as the controller takes it, and what it says in float64.

firmware/track/force_bank.h describes words and elements; it checks them again.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.law.sections import read_kind, sealed_sections
from quiesce.table.kinds import BANK
from quiesce.table.words import Reader

MAGIC = BANK.magic
HEAD_WORDS = 6  # of a section
ELEMENT_WORDS = 3
MODEL_WORDS = 3
MAX_ELEMENTS = 8
MIN_CURRENTS, MAX_CURRENTS = 2, 8
MAX_SHIFT = 40
MAX_CURRENT_mA = 20000
LIMIT = 2**30 - 1  # of a force in mN and of an element in um/s
ONE = 2**30  # of a leak
LEAD_ONE = 2**20
SUM_LIMIT = 2**62


@dataclass(frozen=True)
class Element:
    leads: bool
    leak_q30: int
    limit_um_s: int

    def words(self) -> list[int]:
        return [int(self.leads), self.leak_q30, self.limit_um_s]


@dataclass(frozen=True)
class ConstantModel:
    """At one current; spring and weights in units of 2^-shift mN for a nm and a um/s."""

    current_mA: int
    offset_mN: int
    spring: int
    weights: tuple[int, ...]

    def words(self) -> list[int]:
        return [self.current_mA, self.offset_mN, self.spring, *self.weights]


@dataclass(frozen=True)
class Bank:
    """Of one damper."""

    rate_Hz: int
    shift: int
    lead_q20: int  # um/s for a nm
    lead_um_s: int
    elements: tuple[Element, ...]
    models: tuple[ConstantModel, ...]

    @property
    def currents_A(self) -> np.ndarray:
        return 1e-3 * np.array([one.current_mA for one in self.models])

    @property
    def needs_stroke(self) -> bool:
        return any(one.leads for one in self.elements) or any(one.spring for one in self.models)

    def words(self) -> list[int]:
        """Of its section."""
        head = [len(self.elements), len(self.models), self.rate_Hz, self.shift]
        return [
            *head, self.lead_q20, self.lead_um_s,
            *(word for one in (*self.elements, *self.models) for word in one.words()),
        ]  # fmt: skip

    def forces_N(self, stroke_m: np.ndarray, velocity_m_s: np.ndarray) -> np.ndarray:
        """[currents, ticks], from rest, for a motion [ticks] that is sampled at its rate, in
        float64: what the firmware's integers stand for, without their roundings."""
        z_um_s = states(self.elements, self.followed_um_s(stroke_m, velocity_m_s))
        unit = 2.0**-self.shift
        weights = unit * np.array([one.weights for one in self.models], dtype=float)
        springs = unit * np.array([one.spring for one in self.models], dtype=float)
        offsets = np.array([one.offset_mN for one in self.models], dtype=float)
        force_mN = weights @ z_um_s.T + springs[:, None] * (1e9 * stroke_m) + offsets[:, None]
        return 1e-3 * np.clip(force_mN, -LIMIT, LIMIT)

    def followed_um_s(self, stroke_m: np.ndarray, velocity_m_s: np.ndarray) -> np.ndarray:
        """What elements follow: the velocity, and with its lead, [ticks, 2]."""
        lead = np.clip(
            self.lead_q20 / LEAD_ONE * 1e9 * stroke_m, -float(self.lead_um_s), self.lead_um_s
        )
        return np.column_stack([1e6 * velocity_m_s, 1e6 * velocity_m_s + lead])


def states(elements: Sequence[Element], followed_um_s: np.ndarray) -> np.ndarray:
    """Of each element, from rest, [ticks, elements]."""
    leak = np.array([one.leak_q30 / ONE for one in elements])
    limit = np.array([float(one.limit_um_s) for one in elements])
    return clipped_sums(followed_um_s[:, [int(one.leads) for one in elements]], leak, limit)


def clipped_sums(followed: np.ndarray, leak: np.ndarray, limit: np.ndarray) -> np.ndarray:
    """z <- clip(z + v - leak z, -limit, limit) from 0 along the first axis of v, whose last one is
    the elements'."""
    z = np.zeros(followed.shape[1:])
    out = np.empty(followed.shape)
    keep = 1.0 - leak
    for tick, one in enumerate(followed):
        z = np.minimum(np.maximum(keep * z + one, -limit), limit)
        out[tick] = z
    return out


def bank_words(banks: Sequence[Bank]) -> list[int]:
    """One is of all dampers that there are, several are of the first, the second, ... ValueError,
    in one line, where they are too many or too long for a controller."""
    return sealed_sections(MAGIC, [one.words() for one in banks], "bank")


def banks_of_words(words: Sequence[int]) -> tuple[Bank, ...]:
    """ValueError, in one line, for words that the firmware refuses."""
    return read_kind(MAGIC, words, _bank_of, "bank")


def _bank_of(reader: Reader) -> Bank:
    n, k, rate_Hz, shift, lead_q20, lead_um_s = reader.take(HEAD_WORDS)
    if not (1 <= n <= MAX_ELEMENTS and MIN_CURRENTS <= k <= MAX_CURRENTS):
        raise ValueError(f"{n} elements and {k} currents are not the shape of a bank")
    elements = tuple(_element(reader.take(ELEMENT_WORDS)) for _ in range(n))
    rows = [reader.take(MODEL_WORDS + n) for _ in range(k)]
    models = tuple(ConstantModel(row[0], row[1], row[2], tuple(row[3:])) for row in rows)
    if not (rate_Hz > 0 and 0 <= shift <= MAX_SHIFT and 0 <= lead_um_s <= LIMIT):
        raise ValueError("its rate, shift or lead is out of range")
    bank = Bank(rate_Hz, shift, lead_q20, lead_um_s, elements, models)
    _check_models(bank)
    return bank


def _element(words: Sequence[int]) -> Element:
    leads, leak_q30, limit_um_s = words
    if not (leads in (0, 1) and 0 <= leak_q30 <= ONE and 1 <= limit_um_s <= LIMIT):
        raise ValueError("a lead, leak or limit of an element is out of range")
    return Element(bool(leads), leak_q30, limit_um_s)


def _check_models(bank: Bank) -> None:
    currents = [one.current_mA for one in bank.models]
    if currents[0] != 0 or currents[-1] > MAX_CURRENT_mA or (np.diff(currents) <= 0).any():
        raise ValueError("its currents do not rise from 0 to 20 A at most")
    for one in bank.models:
        if abs(one.offset_mN) > LIMIT or min(one.weights) < 0:
            raise ValueError("an offset is too large, or a weight is negative")
        if largest_sum(bank.elements, one) > SUM_LIMIT:
            raise ValueError("its weights are too large")


def largest_sum(elements: Sequence[Element], model: ConstantModel) -> int:
    """That the firmware's accumulator can reach, whatever the motion."""
    sums = [w * one.limit_um_s for w, one in zip(model.weights, elements, strict=True)]
    return sum(sums) + abs(model.spring) * LIMIT
