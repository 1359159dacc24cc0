"""The phase law's table: what the bench runs with, and its size."""

from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import root
from quiesce.tune.phase_table import law_bytes, read_law

LAW = "phase"
SHIPPED = "firmware/plants/squeeze_2012/pulses.phase.toml"
WORDS_FILE = "law.words"


def check(law: str, file: Path | None) -> None:
    if file is not None and law != LAW:
        raise UsageError(f"--table {file}: law {law} has no table; leave --table out")


def law_options(law: str, file: Path | None, folder: Path) -> tuple[str, ...]:
    """Options of the bench, for a table that is not the shipped one; its words go into the folder.

    UsageError where it is no law file.
    """
    check(law, file)
    if file is None:
        return ()
    words = folder / WORDS_FILE
    words.write_bytes(law_bytes(read_law(file)))
    return ("--pulses", str(words))


def table_bytes(law: str, file: Path | None) -> int | None:
    """Of the words in flash; None for a law without a table."""
    if law == LAW and file is None and not (root() / SHIPPED).is_file():
        return None
    return len(law_bytes(read_law(file or root() / SHIPPED))) if law == LAW else None
