"""Any file with columns as a table. A format is a module of recording/formats and a line here."""

from collections.abc import Callable
from pathlib import Path

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown
from quiesce.base.progress import say
from quiesce.recording.formats import hdf5, lvm, mat, mdf, parquet, uff
from quiesce.recording.table import Table, clipped
from quiesce.recording.text import open_text

# By the suffix of the name; any other file is delimited text. What is read needs its library only
# then: the modules import it in their functions.
FORMATS: dict[str, Callable[[Path], Table]] = {
    ".mat": mat.read,
    ".h5": hdf5.read,
    ".hdf5": hdf5.read,
    ".parquet": parquet.read,
    ".uff": uff.read,
    ".unv": uff.read,
    ".lvm": lvm.read,
    ".mf4": mdf.read,
    ".mdf": mdf.read,
}
MOST_BYTES = 2_000_000_000
LONG_BYTES = 20_000_000  # reading more is told


def open_table(file: Path, skip_lines: int = 0, least: int = 2) -> Table:
    """UsageError, in one line, for anything that has no columns. skip_lines: above the header of a
    text. least: columns that a text must have."""
    read = FORMATS.get(file.suffix.lower())
    if read is None:
        return open_text(file, skip_lines, least)
    _require_size(file)
    try:
        return read(file)
    except UsageError:
        raise
    except Exception as error:  # libraries have classes of their own, or none
        reason = clipped(one_line(error) or type(error).__name__, 120)
        raise UsageError(
            f"{shown(file)}: no {file.suffix.lower()} file, or cut off ({reason}); export it again"
        ) from None


def _require_size(file: Path) -> None:
    try:
        size = file.stat().st_size
        if file.is_file():
            file.open("rb").close()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UsageError(f"{clipped(shown(file), 200)}: {reason}; name a recording")
    if not file.is_file():
        raise UsageError(f"{shown(file)}: no file; name a recording")
    if size == 0:
        raise UsageError(f"{shown(file)}: the file is empty; export it again")
    if size > MOST_BYTES:
        raise UsageError(
            f"{shown(file)}: {size / 1e6:.0f} MB; at most {MOST_BYTES / 1e6:.0f} MB are read; cut "
            "the recording or lower its rate"
        )
    if size > LONG_BYTES:
        say(f"reading {shown(file)}")
