"""The phase law's table: what the bench runs with, and its size."""

from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import root
from quiesce.table.file import table_bytes
from quiesce.table.words import WORD_BYTES
from quiesce.tune.phase_table import read_law
from quiesce.tune.phase_words import law_words

LAW = "phase"
SHIPPED = "firmware/plants/squeeze_2012/pulses.phase.toml"
TABLE_FILE = "law.table"


def check(law: str, file: Path | None) -> None:
    if file is not None and law != LAW:
        raise UsageError(f"--table {file}: law {law} has no table; leave --table out")


def law_options(law: str, file: Path | None, folder: Path) -> tuple[str, ...]:
    """Options of the bench, for a table that is not the shipped one; its file goes into the folder.

    UsageError where it is no law file.
    """
    check(law, file)
    if file is None:
        return ()
    table = folder / TABLE_FILE
    table.write_bytes(table_bytes(law_words(read_law(file))))
    return ("--pulses", str(table))


def bytes_in_flash(law: str, file: Path | None) -> int | None:
    """Of the table; None for a law without a table."""
    if law == LAW and file is None and not (root() / SHIPPED).is_file():
        return None
    return WORD_BYTES * len(law_words(read_law(file or root() / SHIPPED))) if law == LAW else None
