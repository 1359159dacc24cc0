"""A recording of whatever kind, told by its name and how it begins."""

from dataclasses import dataclass
from hashlib import file_digest
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.before_after.files.source import Source
from quiesce.before_after.files.table_file import TableFile
from quiesce.before_after.files.trace_file import TraceFile, is_trace

MDF = (".mf4", ".mdf", ".dat")
CAN = (".log", ".asc", ".blf", ".trc")
CAN_CSV = b"timestamp,arbitration_id"  # how those of `quiesce can record` begin


@dataclass(frozen=True)
class How:
    """What only a user knows of a CSV file."""

    time: str | None = None
    rate_Hz: float | None = None
    skip_lines: int = 0


def open_file(file: Path, how: How) -> Source:
    """UsageError, in one line, for whatever is no recording."""
    try:
        with file.open("rb") as stream:
            start = stream.read(200)
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name a recording")
    if not start.strip():
        raise UsageError(f"{shown(file)}: the file is empty; name a recording")
    suffix = file.suffix.lower()
    if suffix in MDF or start.startswith(b"MDF "):
        return _open_mdf(file)
    if suffix in CAN or start.startswith(CAN_CSV):
        from quiesce.before_after.files.can_log import CanLog  # slow to import

        return CanLog(file)
    if is_trace(start):
        return TraceFile(file)
    return TableFile(file, how.time, how.rate_Hz, how.skip_lines)


def _open_mdf(file: Path) -> Source:
    """Imports late what is slow to import, and asammdf, which may not be there."""
    from quiesce.before_after.files.can_log import CanLog, NoSamples
    from quiesce.before_after.files.mdf_file import MdfFile, is_bus_log

    if not is_bus_log(file):
        return MdfFile(file)
    try:
        return CanLog(file)
    except NoSamples:
        other = MdfFile(file)  # of another bus, whose database is in the file
        if not any(other.scales.values()):
            raise
        return other


def sha256_of(file: Path) -> str:
    with file.open("rb") as stream:
        return file_digest(stream, "sha256").hexdigest()
