"""Tables of rules (firmware/fuzzy/fuzzy_table.h) as they are in words: what a page shows of them.

Layout and numbers of parts are checked; the ranges of their values the firmware checks.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass

from quiesce.table.kinds import RULES
from quiesce.table.words import WORD, crc_of, signed

MAGIC = RULES.magic
HEADER_WORDS, CELL_WORDS, RAMP_WORDS, RULE_WORDS, OUTPUT_WORDS = 16, 4, 4, 4, 8
MAX_INPUTS = MAX_OUTPUTS = 4
MAX_SETS, MAX_TERMS, MAX_RULES, MAX_CONDITIONS = 7, 64, 1024, 8
CENTROID = 2
NO_TERM = 0xFF
LOWEST, HIGHEST = -(2**31), 2**31 - 1  # of an input


@dataclass(frozen=True)
class Axis:
    """Of an input: for each set the integers from and to which it is above 0, and where it is
    greatest; ends: those between which something changes."""

    sets: dict[int, tuple[int, int, int]]
    ends: tuple[int, int]


@dataclass(frozen=True)
class Terms:
    """Of an output: values of singletons; empty where they are sets (a centroid). count: of the
    terms."""

    values: tuple[float, ...]
    count: int


@dataclass(frozen=True)
class Rule:
    """conditions: input, set, negated; conclusions: term of each output or None."""

    conditions: tuple[tuple[int, int, bool], ...]
    conclusions: tuple[int | None, ...]
    is_or: bool
    weight: float


@dataclass(frozen=True)
class Rules:
    """is_for_controller: over frequency in uHz and RMS acceleration in um/s2, to a current in
    mA."""

    words: tuple[int, ...]  # unsigned
    is_for_controller: bool
    axes: tuple[Axis, ...]
    outputs: tuple[Terms, ...]
    rules: tuple[Rule, ...]


def read_rules(values: Sequence[int]) -> Rules:
    """values: signed or not. ValueError, in one line, where they are no table of rules."""
    words = tuple(value % WORD for value in values)
    if len(words) < HEADER_WORDS or words[0] != MAGIC or words[2] != len(words):
        raise ValueError(f"{len(words)} words that are no table of rules")
    if words[1] != crc_of(words[2:]):
        raise ValueError("the CRC-32 of its rules is not that of their words")
    inputs, outputs, _, _ = _bytes(words[3])
    rules_at, rules = words[8] & 0xFFFF, words[8] >> 16
    if not (1 <= inputs <= MAX_INPUTS and 1 <= outputs <= MAX_OUTPUTS and 1 <= rules <= MAX_RULES):
        raise ValueError(f"{rules} rules of {inputs} inputs and {outputs} outputs")
    return Rules(
        words,
        words[15] >> 24 == 1,
        tuple(_axis(words, words[4 + i]) for i in range(inputs)),
        tuple(_terms(words, words[9 + i]) for i in range(outputs)),
        tuple(_rule(part(words, rules_at + RULE_WORDS * i, RULE_WORDS), outputs)
              for i in range(rules)),
    )  # fmt: skip


def part(words: Sequence[int], at: int, count: int) -> Sequence[int]:
    if at < HEADER_WORDS or at + count > len(words):
        raise ValueError("a part of its rules lies outside of them")
    return words[at : at + count]


def _bytes(word: int) -> tuple[int, int, int, int]:
    a, b, c, d = struct.pack("<I", word)
    return a, b, c, d


def _axis(words: Sequence[int], head: int) -> Axis:
    at, cells, stride = head & 0xFFFF, head >> 16 & 0xFF, head >> 24
    found: dict[int, list[tuple[int, int]]] = {}
    bounds: list[int] = []
    for k in range(cells):
        last, first, shift, ramps = part(words, at + k * stride, CELL_WORDS)
        bounds += [signed(first), signed(last)]
        if CELL_WORDS + RAMP_WORDS * ramps > stride or shift > 31:
            raise ValueError("a cell of its rules holds more than it has room for")
        for i in range(ramps):
            low, high, slope, number = part(
                words, at + k * stride + CELL_WORDS + RAMP_WORDS * i, RAMP_WORDS
            )
            if number >= MAX_SETS:
                raise ValueError(f"set {number} of its rules; the last one is {MAX_SETS - 1}")
            start = signed(high) << 32 | low
            for n in (signed(first), signed(last)):
                mu = (start + signed(slope) * ((n - signed(first)) << shift)) >> 32
                found.setdefault(number, []).append((n, mu))
    sets = {number: _extent(ends) for number, ends in sorted(found.items())}
    # All integers are in a cell: beyond these ends there is nothing but the outermost ones.
    inner = sorted(bounds)[1:-1] or [0]
    return Axis(sets, (inner[0], inner[-1]))


def _extent(ends: list[tuple[int, int]]) -> tuple[int, int, int]:
    """Of a set that is greatest up to an end of all integers, the other end of that."""
    peak = max(mu for _, mu in ends)
    tops = [n for n, mu in ends if mu == peak]
    low, high = min(tops), max(tops)
    greatest = high if low == LOWEST else low if high == HIGHEST else (low + high) // 2
    return min(n for n, _ in ends), max(n for n, _ in ends), greatest


def _terms(words: Sequence[int], at: int) -> Terms:
    head, _, origin, _, data, _, fraction, _ = part(words, at, OUTPUT_WORDS)
    method, count, _, _ = _bytes(head)
    if not (method <= CENTROID and 1 <= count <= MAX_TERMS and fraction < 32):
        raise ValueError(f"an output of its rules has method {method} and {count} terms")
    values = part(words, data, count)
    if method == CENTROID:
        return Terms((), count)
    return Terms(tuple(signed(origin) + value / 2.0**fraction for value in values), count)


def _rule(words: Sequence[int], outputs: int) -> Rule:
    head = words[0]
    count = head >> 24
    if not 1 <= count <= MAX_CONDITIONS:
        raise ValueError(f"a rule of {count} conditions")
    conditions = [*_bytes(words[1]), *_bytes(words[2])][:count]
    weight = (head & 0xFFFFF) / 2.0 ** (19 + 3 * (head >> 21 & 7))
    return Rule(
        tuple((one >> 3 & 15, one & 7, bool(one >> 7)) for one in conditions),
        tuple(None if term == NO_TERM else term for term in _bytes(words[3])[:outputs]),
        bool(head >> 20 & 1),
        weight,
    )
