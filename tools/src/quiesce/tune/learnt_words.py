"""What law phase has learnt as words that a controller keeps (firmware/law/phase/adapt_store.h)."""

from collections.abc import Sequence
from dataclasses import dataclass

from quiesce.base.table import format_table
from quiesce.table.words import HEAD_WORDS, crc_of
from quiesce.tune.phase_table import MOST_POINTS, SETTINGS

MAGIC = 0x31444151
OWNER, TRIMS = 2, 4  # first words of both
WORDS = TRIMS + 2 * MOST_POINTS
HALF_TURN_deg, HALF_TURN, LEVEL_ONE = 180.0, 1 << 16, 1 << 15


@dataclass(frozen=True)
class Trim:
    """What is changed of a pulse, at the point of this number in its table, from 1."""

    point: int
    on_deg: float  # later is positive
    off_deg: float
    level_part: float  # by which it is lowered, of the table's; <= 0
    is_whole: bool  # without its gap


@dataclass(frozen=True)
class Learnt:
    table_crc: int  # of the pulses that it belongs to
    setting: str
    trims: tuple[Trim, ...]  # those that are not zero


def _signed(half: int) -> int:
    return half - (1 << 16) if half >= 1 << 15 else half


def _trim(point: int, edges: int, rest: int) -> Trim:
    on, off = _signed(edges & 0xFFFF), _signed(edges >> 16)
    return Trim(
        point,
        HALF_TURN_deg * on / HALF_TURN,
        HALF_TURN_deg * off / HALF_TURN,
        _signed(rest & 0xFFFF) / LEVEL_ONE,
        rest >> 16 != 0,
    )


def learnt_of_words(table: Sequence[int]) -> Learnt:
    """ValueError where they are not a whole record of it."""
    words = table[HEAD_WORDS:]
    if len(words) != WORDS or words[0] != MAGIC:
        raise ValueError("not what this version's law phase learns")
    if words[1] != crc_of(words[OWNER:]):
        raise ValueError("damaged: what was learnt has another CRC than it says")
    if words[OWNER + 1] >= len(SETTINGS):
        raise ValueError(f"setting {words[OWNER + 1]}, expected 0 to {len(SETTINGS) - 1}")
    pairs = enumerate(zip(words[TRIMS::2], words[TRIMS + 1 :: 2], strict=True), 1)
    trims = tuple(_trim(point, *pair) for point, pair in pairs if any(pair))
    return Learnt(words[OWNER], SETTINGS[words[OWNER + 1]], trims)


def described_learnt(learnt: Learnt) -> str:
    owner = f"of the pulses with CRC 0x{learnt.table_crc:08x}, setting {learnt.setting}"
    if not learnt.trims:
        return f"{owner}: nothing yet"
    rows = [
        (one.point, one.on_deg, one.off_deg, 100.0 * one.level_part,
         "without" if one.is_whole else "with")
        for one in learnt.trims
    ]  # fmt: skip
    head = ["point", "on||+.2f deg", "off||+.2f deg", "level||+.2f %", "gap"]
    return f"{owner}\n{format_table(head, rows, ())}"
