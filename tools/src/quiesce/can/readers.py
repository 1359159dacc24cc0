"""CAN logs of every format, and one line for whatever is wrong with one."""

import io
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.can.python_can import can

from can.util import CAN_FD_DLC  # isort: skip

CSV_HEADER = "timestamp,arbitration_id,extended,remote,error,dlc,data"
FORMATS = ".log (candump), .asc, .blf, .csv, .mf4, .trc"
MAX_STANDARD_ID = 0x7FF
MAX_EXTENDED_ID = 0x1FFFFFFF


class Lines(io.TextIOWrapper):
    """A text file that knows which line it is at."""

    number = 0

    def __next__(self) -> str:
        line = super().__next__()
        self.number += 1
        return line


class Place:
    """Where in a file the reader is."""

    def __init__(self) -> None:
        self.lines: Lines | None = None
        self.frames = 0

    def __str__(self) -> str:
        if self.lines is not None and self.lines.number:
            return f"line {self.lines.number}"
        return f"frame {self.frames + 1}"


def check_log(file: Path) -> None:
    """UsageError where its kind is unknown or it is empty, OSError where it is not there."""
    if file.suffix.lower() not in READERS:
        raise UsageError(f"{file}: unknown kind of log; there are {FORMATS}")
    if file.stat().st_size == 0:
        raise UsageError(f"{file}: empty")


def read_log(file: Path) -> Iterator[Any]:
    """The frames of a log, as can.Message, one after the other.

    UsageError, after the frames before it, where something is malformed or the file is cut off.
    """
    check_log(file)
    suffix = file.suffix.lower()
    place = Place()
    messages = READERS[suffix](file, place)
    while True:
        try:
            message = next(messages)
            check_frame(message)
        except StopIteration:
            return
        except OSError:
            raise
        except Exception as error:  # every parser has its own classes
            raise UsageError(f"{file}: {place}: {HINTS[suffix]} ({reason_of(error)})")
        place.frames += 1
        yield message


Reader = Callable[[Path, Place], Iterator[Any]]


def reason_of(error: Exception) -> str:
    return one_line(error)[:120] or type(error).__name__


def check_frame(message: Any) -> None:
    """ValueError where it cannot have been on a bus."""
    largest = MAX_EXTENDED_ID if message.is_extended_id else MAX_STANDARD_ID
    if message.is_error_frame:
        return
    if not 0 <= message.arbitration_id <= largest:
        raise ValueError(f"id {message.arbitration_id:X} is beyond {largest:X}")
    if not message.is_remote_frame and len(message.data) != message.dlc:
        raise ValueError(f"{message.dlc} bytes announced, {len(message.data)} there")
    if message.dlc > 8 and not message.is_fd:
        raise ValueError(f"{message.dlc} bytes in a classic frame")
    if message.is_fd and message.dlc not in CAN_FD_DLC:
        raise ValueError(f"{message.dlc} bytes in a CAN FD frame")
    if not abs(message.timestamp) < float("inf"):
        raise ValueError("time stamp is not finite")


def open_lines(file: Path) -> Lines:
    return Lines(file.open("rb"), encoding="utf-8")


def text_reader(make: Callable[[Any], Any], begins: tuple[str, ...] = ()) -> Reader:
    """A reader of lines; the first line has to begin with one of `begins`."""

    def read(file: Path, place: Place) -> Iterator[Any]:
        with open_lines(file) as lines:
            place.lines = lines
            first = lines.readline()
            if begins and not first.startswith(begins):
                raise ValueError(f"the first line is {first.strip()[:40]!r}")
            lines.seek(0)
            yield from make(lines)

    return read


class TrcReader(can.TRCReader):
    """python-can's leaves out lines that are cut off; here they are errors."""

    def _parse_line(self, line: str) -> Any:
        if not line or line.startswith(";"):
            return None
        return self._parse_cols(tuple(line.split(maxsplit=self._num_columns)))


def read_blf(file: Path, _: Place) -> Iterator[Any]:
    size = file.stat().st_size
    with file.open("rb") as opened:
        reader = can.BLFReader(opened)
        yield from reader
        if reader.file_size > size:
            raise ValueError(f"{size} of {reader.file_size} bytes are there")


def read_mf4(file: Path, _: Place) -> Iterator[Any]:
    from quiesce.can.mdf import read_mdf

    yield from read_mdf(file)


READERS: dict[str, Reader] = {
    ".log": text_reader(can.CanutilsLogReader),
    ".asc": text_reader(
        lambda lines: can.ASCReader(lines, relative_timestamp=False), ("date", "base", "//")
    ),
    ".blf": read_blf,
    ".csv": text_reader(can.CSVReader, (CSV_HEADER,)),
    ".mf4": read_mf4,
    ".trc": text_reader(TrcReader, (";",)),
}
HINTS = {
    ".log": "expected '(SECONDS) CHANNEL ID#DATA', as 'candump -L' writes it",
    ".asc": "not an ASC log, or cut off",
    ".blf": "not a BLF log, or cut off",
    ".csv": f"expected the columns {CSV_HEADER}",
    ".mf4": "not an MDF4 log of CAN frames, or cut off",
    ".trc": "not a TRC log, or cut off",
}
