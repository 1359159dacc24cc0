"""Tables of law `fuzzy_signals`: a current by fuzzy rules over signals.

firmware/law/rules/law_fuzzy_signals.c describes the words.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from quiesce.law.sections import CurrentSections, limited, read_sections, sealed_sections
from quiesce.law.signal import Input, read_input
from quiesce.rules.integers.rule_words import MAX_INPUTS, MAX_OUTPUTS, Rules, read_rules
from quiesce.rules.model import RuleBase
from quiesce.rules.reference import evaluate
from quiesce.table.kinds import RULES_ON_SIGNALS
from quiesce.table.words import Reader

MAGIC = RULES_ON_SIGNALS.magic
MOST_SLOPES = MAX_OUTPUTS - 1
MOST_SHIFT = 62
MOST_A = 20.0
ONE_mA_Q8 = 256


@dataclass(frozen=True)
class Slope:
    """Output 1, 2, 3 of the rules is multiplied with this input, x 2^-shift."""

    input: int
    shift: int


@dataclass(frozen=True)
class Meaning:
    """The rules in real numbers: outputs as the law's table has them, per_output_A for 1 of the
    first. factors: of the base's unit for 1 in the SI unit of each signal."""

    base: RuleBase
    factors: tuple[float, ...]
    per_output_A: float


@dataclass(frozen=True)
class FuzzySection:
    """Of one damper; is_magnitude: of which inputs the sign is dropped. meaning: None where it was
    read from words."""

    inputs: tuple[Input, ...]
    is_magnitude: tuple[bool, ...]
    slopes: tuple[Slope, ...]
    rules: Rules
    meaning: Meaning | None = field(default=None, compare=False)

    def words(self) -> list[int]:
        return self.words_after(None)

    def words_after(self, before: Rules | None) -> list[int]:
        """before: rules of the section before, which are not said again."""
        rules = [] if self.rules == before else list(self.rules.words)
        values = [len(self.inputs), len(self.slopes), len(rules)]
        for one, is_magnitude in zip(self.inputs, self.is_magnitude, strict=True):
            values += [*one.words(), int(is_magnitude)]
        for slope in self.slopes:
            values += [slope.input, slope.shift]
        return values + rules

    def currents_A(self, values: np.ndarray) -> np.ndarray:
        """ValueError where it was read from words."""
        if self.meaning is None:
            raise ValueError("rules in words only have no real numbers")
        base, factors = self.meaning.base, np.array(self.meaning.factors)
        scale = np.array([one.per_unit for one in self.inputs])
        x = limited(self.inputs, values) / scale * factors
        x = np.where(self.is_magnitude, np.abs(x), x)
        out = evaluate(base, list(x.T)).outputs
        slopes = sum(out[1 + k] * x[:, one.input] for k, one in enumerate(self.slopes))
        return np.clip(self.meaning.per_output_A * (out[0] + slopes), 0.0, MOST_A)


class FuzzySignalsTable(CurrentSections[FuzzySection]):
    magic = MAGIC
    law = "fuzzy_signals"

    def words(self) -> list[int]:
        before = [None, *(one.rules for one in self.sections)]
        pairs = zip(self.sections, before, strict=False)
        return sealed_sections(MAGIC, [one.words_after(last) for one, last in pairs], "table")


def read(words: Sequence[int]) -> FuzzySignalsTable:
    """ValueError, in one line, where the firmware refuses its head, its sections or how their rules
    are laid out. What the numbers of rules may be, the firmware alone checks."""
    known: list[Rules] = []

    def read_one(reader: Reader) -> FuzzySection:
        section = _read_section(reader, known[-1] if known else None)
        known.append(section.rules)
        return section

    return FuzzySignalsTable(read_sections(words, read_one))


def _read_section(reader: Reader, before: Rules | None) -> FuzzySection:
    m = reader.one(1, MAX_INPUTS, "number of inputs")
    t = reader.one(0, MOST_SLOPES, "number of slopes")
    count = reader.take(1)[0]
    pairs = [(read_input(reader), reader.one(0, 1, "magnitude")) for _ in range(m)]
    slopes = tuple(
        Slope(
            reader.one(0, m - 1, "input of a slope"), reader.one(0, MOST_SHIFT, "shift of a slope")
        )
        for _ in range(t)
    )
    rules = read_rules(reader.take(count)) if count else before
    if rules is None:
        raise ValueError("its first damper has no rules")
    if (len(rules.axes), len(rules.outputs)) != (m, 1 + t):
        raise ValueError(
            f"rules of {len(rules.axes)} inputs and {len(rules.outputs)} outputs where {m} and "
            f"{1 + t} are read"
        )
    return FuzzySection(
        tuple(one for one, _ in pairs), tuple(bool(flag) for _, flag in pairs), slopes, rules
    )
