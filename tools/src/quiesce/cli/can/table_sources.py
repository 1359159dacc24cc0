"""What `quiesce can load KIND FILE` sends: a table's file, or one made from its source."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.can.kinds import BY_MAGIC, LAW, LEARNT, TRACKER, Kind
from quiesce.can.table_file import MOST_WORDS, file_bytes, words_of

SUFFIX = ".table"
RULES, PULSES = "rules", "pulses"
# Names of one kind that have sources, and those of all kinds of a road.
WORDS = (RULES, PULSES, LAW, TRACKER, LEARNT)


@dataclass(frozen=True)
class Table:
    kind: Kind
    words: list[int]
    data: bytes  # of its file
    notes: Sequence[str] = ()

    @property
    def crc(self) -> int:
        return self.words[1]


def table_of(word: str, path: Path) -> Table:
    """word: of WORDS. UsageError, in one line, where it is no such table."""
    file = file_in(path) if word == PULSES and path.is_dir() else path
    if file.suffix == SUFFIX:
        table = read_table(file)
    elif word == RULES:
        table = from_rules(file)
    elif word == PULSES:
        table = from_pulses(file)
    else:
        raise UsageError(f"{shown(file)}: not a table's file; its name ends in {SUFFIX}")
    if len(table.words) > MOST_WORDS:
        raise UsageError(
            f"{shown(file)}: {len(table.words)} words; a controller takes {MOST_WORDS}"
        )
    if word not in (table.kind.name, table.kind.road):
        better = table.kind.name if table.kind.name in WORDS else table.kind.road
        raise UsageError(
            f"{shown(file)}: {table.kind.name}, not a table for '{word}': quiesce can load "
            f"{better} {shown(file)}"
        )
    return table


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


def read_table(file: Path) -> Table:
    try:
        data = file.read_bytes()
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name a table's file")
    try:
        words = words_of(data)
    except ValueError as error:
        raise UsageError(f"{shown(file)}: {error}")
    kind = BY_MAGIC.get(words[0])
    if kind is None:
        raise UsageError(f"{shown(file)}: a table of no known kind, it begins 0x{words[0]:08x}")
    return Table(kind, words, data)


def from_rules(file: Path) -> Table:
    from quiesce.cli.rules.formats import compiled_for_controller
    from quiesce.rules.formats.files import read_rules
    from quiesce.rules.integers.table import table_words

    compiled = compiled_for_controller(read_rules(file))
    return made(table_words(compiled), compiled.notes)


def from_pulses(file: Path) -> Table:
    from quiesce.tune.phase_table import law_words, read_law

    return made(law_words(read_law(file)))


def made(words: list[int], notes: Sequence[str] = ()) -> Table:
    return Table(BY_MAGIC[words[0]], words, file_bytes(words), notes)
