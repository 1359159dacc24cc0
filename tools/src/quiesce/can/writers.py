"""CAN logs as files that are whole at any moment, whatever ends the recording.

ASC, BLF, candump and CSV are written by python-can into a WholeFile. MDF4 cannot be written as it
comes: a candump log beside it takes the frames and is turned into the MDF4 file at the end; where
that fails, the candump log stays.
"""

import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from quiesce.base.errors import one_line
from quiesce.can.mdf_maker import Order, make
from quiesce.can.python_can import can
from quiesce.can.whole_file import WholeFile

# Uncompressed bytes of a BLF container: what a power cut loses.
BLF_CONTAINER_BYTES = 16 * 1024
COMMIT_BYTES = 64 * 1024
PART_SUFFIX = ".log"  # after .mf4: the frames until that file is made
CANFD_BRS = 0x01
CANFD_ESI = 0x02
# As candump has it: CAN_ERR_FLAG and CAN_ERR_BUSERROR, no detail.
ERROR_FRAME = "20000080#0000000000000000"

Attachment = tuple[str, bytes, str]  # file name, content, MIME type


class LogFile:
    """One file of a recording. Notes go where the format has a place for them."""

    def __init__(self, path: Path) -> None:
        """OSError where it cannot be made or exists."""
        self.path = path
        self.frames = 0
        self.first_s: float | None = None
        self.last_s = 0.0
        self.is_closed = False
        self.file = WholeFile(path)
        self._writer = self._open()

    def _open(self) -> Any:
        raise NotImplementedError

    @property
    def size(self) -> int:
        return self.file.size

    @property
    def error(self) -> OSError | None:
        """Why nothing more can be written."""
        return self.file.error

    @property
    def failure(self) -> str:
        """What is not in the file that should be; empty: nothing."""
        return ""

    @property
    def result(self) -> Path:
        """The file that is there in the end."""
        return self.path

    def write(self, frame: Any) -> None:
        self._writer.on_message_received(frame)
        self.file.mark()
        self.frames += 1
        if self.first_s is None:
            self.first_s = frame.timestamp
        self.last_s = frame.timestamp
        if self.file.pending > COMMIT_BYTES:
            self.commit()

    def commit(self) -> None:
        self.file.commit()

    def note(self, text: str, time_s: float) -> None:
        """Something that is no frame happened."""

    def close(self) -> None:
        """The file is complete afterwards."""
        if not self.is_closed:
            self.is_closed = True
            self._writer.stop()


class Candump(can.CanutilsLogWriter):
    """As 'candump -L' writes it."""

    def on_message_received(self, msg: Any) -> None:
        self.file.write(f"({msg.timestamp:.6f}) can0 {candump_text(msg)}{self.direction(msg)}\n")

    def direction(self, _: Any) -> str:
        """Of the direction. None: Wireshark takes it for an error."""
        return ""


class MarkedCandump(Candump):
    """With what was received (R) and sent (T), as python-can has it."""

    def direction(self, msg: Any) -> str:
        return "" if msg.is_error_frame else " R" if msg.is_rx else " T"


def candump_text(msg: Any) -> str:
    """ID#DATA, ID##FLAGSDATA for CAN FD, ID#RLENGTH for remote frames."""
    if msg.is_error_frame:
        return ERROR_FRAME
    frame_id = f"{msg.arbitration_id:0{8 if msg.is_extended_id else 3}X}"
    if msg.is_remote_frame:
        return f"{frame_id}#R{msg.dlc or ''}"
    flags = ""
    if msg.is_fd:
        flags = f"#{msg.bitrate_switch * CANFD_BRS | msg.error_state_indicator * CANFD_ESI:X}"
    return f"{frame_id}#{flags}{bytes(msg.data).hex().upper()}"


class CandumpFile(LogFile):
    def _open(self) -> Any:
        return Candump(self.file)


class CsvFile(LogFile):
    """python-can's columns cannot tell CAN FD: such frames are left out, and that is told."""

    def __init__(self, path: Path) -> None:
        self._left_out = 0
        super().__init__(path)

    def _open(self) -> Any:
        return can.CSVWriter(self.file)

    def write(self, frame: Any) -> None:
        if frame.is_fd:
            self._left_out += 1
        else:
            super().write(frame)

    @property
    def failure(self) -> str:
        if not self._left_out:
            return ""
        return (
            f"{self.path}: .csv cannot hold CAN FD frames, {self._left_out} left out; record them "
            "into .log, .asc, .blf or .mf4"
        )


class AscFile(LogFile):
    def _open(self) -> Any:
        return can.ASCWriter(self.file)

    def write(self, frame: Any) -> None:
        super().write(with_channel(frame, 0))

    def note(self, text: str, time_s: float) -> None:
        self.file.write(f"// {time_s:.6f} {one_line(text)}\n")


class BlfFile(LogFile):
    def _open(self) -> Any:
        writer = can.BLFWriter(self.file)
        writer.max_container_size = BLF_CONTAINER_BYTES
        return writer

    def write(self, frame: Any) -> None:
        super().write(with_channel(frame, 0))

    @property
    def size(self) -> int:
        return self._writer.file_size()

    def note(self, text: str, time_s: float) -> None:
        ascii_text = one_line(text).encode("ascii", "replace").decode()
        self._writer.log_event(ascii_text, time_s)


class MdfFile(LogFile):
    """attachments: what goes along; called when the file is closed."""

    def __init__(self, path: Path, attachments: Callable[[], Sequence[Attachment]]) -> None:
        if path.exists():
            raise FileExistsError(17, "File exists", str(path))
        self.target = path
        self._failure = ""
        self._is_made = False
        self._attachments = attachments
        self._notes: list[str] = []
        self._thread: threading.Thread | None = None
        super().__init__(path.with_name(path.name + PART_SUFFIX))

    def _open(self) -> Any:
        return MarkedCandump(self.file)

    @property
    def failure(self) -> str:
        """After finish(): why there is only the candump log, or what only that one holds."""
        return self._failure

    @property
    def result(self) -> Path:
        return self.target if self._is_made else self.path

    def note(self, text: str, time_s: float) -> None:
        self._notes.append(f"{time_s:.6f} {one_line(text)}")

    def close(self) -> None:
        """Returns at once; finish() waits for the MDF4 file."""
        if self.is_closed:
            return
        super().close()
        attachments = self._attachments()
        self._thread = threading.Thread(target=self._convert, args=(attachments,))
        self._thread.start()

    def finish(self) -> None:
        """Waits for the MDF4 file."""
        if self._thread is not None:
            self._thread.join()

    def _convert(self, attachments: Sequence[Attachment]) -> None:
        comment = "\n".join(self._notes)
        made = make(Order(self.path, self.target, self.frames > 0, attachments, comment))
        self._is_made, self._failure = made.is_made, made.failure


def with_channel(frame: Any, channel: Any) -> Any:
    """The drivers' own channel names (a path, a multicast group) are none in a log."""
    frame.channel = channel
    return frame


FORMATS = (".log", ".asc", ".blf", ".csv", ".mf4")


def open_log(path: Path, attachments: Callable[[], Sequence[Attachment]]) -> LogFile:
    """By the suffix, one of FORMATS. OSError where it cannot be made or exists."""
    suffix = path.suffix.lower()
    if suffix == ".mf4":
        return MdfFile(path, attachments)
    kinds: dict[str, type[LogFile]] = {
        ".log": CandumpFile,
        ".asc": AscFile,
        ".blf": BlfFile,
        ".csv": CsvFile,
    }
    return kinds[suffix](path)
