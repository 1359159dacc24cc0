"""What `quiesce can load KIND FILE` sends: a table's file, or one made from its source."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.can.roads import LAW, LEARNT, TRACKER, road_of
from quiesce.table.file import SUFFIX, read_file, table_bytes
from quiesce.table.kinds import KINDS, PULSES, RULES, Kind
from quiesce.table.words import opened

# Kinds that have sources, and all kinds of a road.
WORDS = (RULES.name, PULSES.name, LAW, TRACKER, LEARNT)


@dataclass(frozen=True)
class Table:
    kind: Kind
    words: list[int]
    data: bytes  # of its file
    notes: Sequence[str] = ()

    @property
    def crc(self) -> int:
        return self.words[1]

    @property
    def road(self) -> str:
        return road_of(self.kind)


def table_of(word: str, path: Path) -> Table:
    """word: of WORDS. UsageError, in one line, where it is no such table."""
    file = file_in(path) if word == PULSES.name and path.is_dir() else path
    try:
        table = made_of(word, file)
    except ValueError as error:
        raise UsageError(f"{shown(file)}: {error}")
    except RecursionError:
        raise UsageError(f"{shown(file)}: nested too deeply to be a table's source")
    if word not in (table.kind.name, table.road):
        better = table.kind.name if table.kind.name in WORDS else table.road
        raise UsageError(
            f"{shown(file)}: {table.kind.name}, not a table for '{word}': quiesce can load "
            f"{better} {shown(file)}"
        )
    return table


def made_of(word: str, file: Path) -> Table:
    """ValueError where a controller would not take so many words, or such ones."""
    if file.suffix == SUFFIX:
        found = read_file(file)
        opened(found.words)
        if found.words[0] not in KINDS:
            raise ValueError(f"a table of no known kind, it begins 0x{found.words[0]:08x}")
        return Table(KINDS[found.words[0]], found.words, table_bytes(found.words, found.board))
    if word == RULES.name:
        return from_rules(file)
    if word == PULSES.name:
        return from_pulses(file)
    raise ValueError(f"not a table's file; its name ends in {SUFFIX}")


def file_in(folder: Path) -> Path:
    """The law file that `quiesce tune` wrote there, else its table."""
    for pattern in ("*.phase.toml", f"*{SUFFIX}"):
        found = sorted(folder.glob(pattern))
        if len(found) == 1:
            return found[0]
        if found:
            names = ", ".join(one.name for one in found)
            raise UsageError(f"{shown(folder)}: which of {names}?")
    raise UsageError(f"{shown(folder)}: no NAME.phase.toml of 'quiesce tune' in it")


def from_rules(file: Path) -> Table:
    from quiesce.rules.controller import controller_table

    made = controller_table(file)
    return Table(RULES, made.words, table_bytes(made.words), made.notes)


def from_pulses(file: Path) -> Table:
    from quiesce.tune.phase_table import read_law
    from quiesce.tune.phase_words import law_words

    words = law_words(read_law(file))
    return Table(PULSES, words, table_bytes(words))
