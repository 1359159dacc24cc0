"""A bank of models at constant currents as an inverse: what tracker `bank` of the controller reads,
read back.

firmware/track/force_bank.h says what the words are and how a current is found between models.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.damper.bank.fit import fit_bank
from quiesce.damper.bank.table import MAGIC, Bank, bank_words, banks_of_words
from quiesce.damper.data.record import Record
from quiesce.damper.inverse import forces_by, interpolated
from quiesce.damper.inverses.demand import TICK_RATE_HZ, Source, in_ticks
from quiesce.damper.learned.model import Report, silent
from quiesce.damper.simulate import simulator
from quiesce.table.file import read_words, table_bytes

NAME = "bank"
TITLE = "models at constant currents, with memory"
HELP = "stops, saturations and dashpots that weigh at each current what the damper file says"
TRACKER = "tracker bank reads it"


@dataclass(frozen=True)
class BankInverse:
    """fit_error_pct: of each model's force, on motions that it was not fitted to; empty where it is
    read from a file."""

    words: list[int]
    fit_error_pct: tuple[float, ...] = ()

    @property
    def bank(self) -> Bank:
        return banks_of_words(self.words)[0]

    @property
    def max_current_A(self) -> float:
        return float(self.bank.currents_A[-1])

    def currents(self, demand: Record) -> np.ndarray:
        """The motion of a demand at another rate is interpolated at the bank's own ticks."""
        bank = self.bank
        seen, at = in_ticks(demand, bank.rate_Hz)
        forces_N = bank.forces_N(seen.disp_m, seen.velocity_m_s)
        return interpolated(bank.currents_A, forces_N, seen.force_N)[at]

    def parameters(self) -> dict[str, Any]:
        return {"words": self.words}

    def to_bytes(self) -> bytes:
        return table_bytes(self.words)

    def notes(self) -> list[str]:
        """What a user has to know of it."""
        if not self.fit_error_pct:
            return []
        pairs = zip(self.bank.currents_A, self.fit_error_pct, strict=True)
        errors = ", ".join(f"{error:.1f} at {current:.3g} A" for current, error in pairs)
        signals = "stroke and stroke velocity" if self.bank.needs_stroke else "stroke velocity"
        return [
            f"bank: error of its force, % of the model's, on motions not fitted to: {errors}",
            f"bank: needs {signals}; for ticks at {self.bank.rate_Hz} Hz",
        ]


def is_bank(file: Path) -> bool:
    """By its first word. UsageError where it is no table file."""
    return read_words(file)[:1] == [MAGIC]


def read_banks(file: Path) -> tuple[Bank, ...]:
    """Of one damper or several. UsageError where they are no bank."""
    try:
        return banks_of_words(read_words(file))
    except ValueError as error:
        raise UsageError(f"{shown(file)}: {error}") from None


def read_table(file: Path) -> BankInverse:
    """UsageError where they are no bank of one damper."""
    banks = read_banks(file)
    if len(banks) > 1:
        raise UsageError(f"{shown(file)}: a bank of {len(banks)} dampers; an inverse is of one")
    return BankInverse(bank_words(banks))


def joined(files: Sequence[Path]) -> list[int]:
    """One table for several dampers, in this order. UsageError where they are too many, too long,
    or not of one rate."""
    banks = [bank for file in files for bank in read_banks(file)]
    names = ", ".join(shown(file) for file in files)
    if len({bank.rate_Hz for bank in banks}) > 1:
        raise UsageError(f"{names}: banks for different tick rates")
    try:
        return bank_words(banks)
    except ValueError as error:
        raise UsageError(f"{names}: {error}") from None


def make(source: Source, seed: int = 0, progress: Report = silent) -> BankInverse:
    """UsageError where there is no bank."""
    damper = source.model_for(NAME)
    forces = forces_by(damper, None if damper.is_kernel else simulator(damper))
    found = fit_bank(damper, forces, source.max_current_A, TICK_RATE_HZ, seed, progress)
    inverse = BankInverse(bank_words([found.bank]), tuple(found.error_pct.tolist()))
    progress(f"bank: {4 * len(inverse.words)} bytes, up to {inverse.max_current_A:g} A")
    return inverse
