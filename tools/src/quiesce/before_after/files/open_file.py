"""A recording of whatever kind, told by its name and how it begins."""

from dataclasses import dataclass
from hashlib import file_digest
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.before_after.files.csv_file import CsvFile
from quiesce.before_after.files.source import Source
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
    # Both are slow to import, and asammdf may not be there.
    if suffix in MDF or start.startswith(b"MDF "):
        from quiesce.before_after.files.mdf_file import MdfFile, has_frames

        if not has_frames(file):
            return MdfFile(file)
    elif suffix not in CAN and not start.startswith(CAN_CSV):
        if is_trace(start):
            return TraceFile(file)
        return CsvFile(file, how.time, how.rate_Hz, how.skip_lines)
    from quiesce.before_after.files.can_log import CanLog

    return CanLog(file)


def sha256_of(file: Path) -> str:
    with file.open("rb") as stream:
        return file_digest(stream, "sha256").hexdigest()
