"""Bytes to and from a controller by ISO-TP (ISO 15765-2): TableData goes out, TableFlow comes in.

can-isotp keeps the protocol; it is run in the caller's loop, without threads of its own.
"""

import logging
import time
from collections import deque
from collections.abc import Callable, Iterator
from typing import Any

from quiesce.can.database import Database
from quiesce.can.link import Link, Lost

OUT, BACK = "TableData", "TableFlow"
# Of what we receive, as the controller's own of what it receives.
BLOCK_FRAMES = 32
GAP_MS = 2
# Longest silence: no flow control, no next frame, no first one.
SILENCE_MS = 1000
# Flow controls in a row that ask to wait.
MOST_WAITS = 10
# The largest transfer takes 2.4 s and its silences; a bus that makes it wait has this long.
LONGEST_S = 60.0
UP_S = 10.0  # for a bus that is away to come back
STEP_S = 0.02

Progress = Callable[[int, int], None]  # bytes so far, of all


class TransferFailed(Exception):
    """Worth another try."""


class TooLarge(Exception):
    """The receiver has no room for it: no other try at once will help."""


def no_room(count: int) -> str:
    return (
        f"the controller has no room for {count} bytes at a time; where it is still storing a "
        "table, try again once it has"
    )


class Channel:
    """One transfer at a time. Whoever else reads the link gives take() all events."""

    def __init__(self, link: Link, database: Database, progress: Progress | None = None) -> None:
        self.link = link
        self._out_id = database.by_name[OUT].frame_id
        self._back_id = database.by_name[BACK].frame_id
        self._progress = progress or (lambda done, total: None)
        self._frames: deque[bytes] = deque()
        self._lost = ""
        self._errors: list[Exception] = []
        self._given = 0  # bytes of what is sent

    def take(self, event: Any) -> None:
        if isinstance(event, Lost):
            self._lost = event.reason
        elif getattr(event, "arbitration_id", None) == self._back_id and not event.is_extended_id:
            self._frames.append(bytes(event.data))

    def begin(self) -> None:
        """Forgets what came before. TransferFailed where the bus stays away."""
        end_s = time.monotonic() + UP_S
        while not self.link.is_up and time.monotonic() < end_s:
            time.sleep(STEP_S)
        while self.link.receive_now() is not None:
            pass
        self._frames.clear()
        self._lost = ""
        if not self.link.is_up:
            raise TransferFailed("the bus is down")

    def send(self, data: bytes) -> None:
        """TransferFailed where it did not go out, TooLarge. That it arrived is not known."""
        self.begin()
        layer = self._layer(len(data))
        self._given = 0
        layer.send((self._counted(data), len(data)))
        self._run(layer, len(data), layer.transmitting, lambda: self._given)

    def receive(self, size: int) -> bytes:
        """A transfer that began after begin(). TransferFailed where it is not whole, or not of so
        many bytes."""
        layer = self._layer(size)
        silent_s = time.monotonic() + SILENCE_MS / 1000.0

        def is_under_way() -> bool:
            if not (layer.is_rx_active() or layer.available()) and time.monotonic() > silent_s:
                raise TransferFailed("nothing came")
            return not layer.available()

        self._run(layer, size, is_under_way, lambda: len(layer.rx_buffer))
        found = bytes(layer.recv() or b"")
        if len(found) != size:
            raise TransferFailed(f"{len(found)} bytes came, not {size}")
        return found

    def _run(
        self, layer: Any, total: int, is_under_way: Callable[[], bool], done: Callable[[], int]
    ) -> None:
        end_s = time.monotonic() + LONGEST_S
        while is_under_way():
            self._progress(done(), total)
            layer.process(STEP_S if (due_s := layer.next_cf_delay()) is None else due_s)
            if self._errors:
                raise failure_of(self._errors[0])
            if time.monotonic() > end_s:
                raise TransferFailed(f"it was not over after {LONGEST_S:g} s")
        self._progress(total, total)

    def _layer(self, most_bytes: int) -> Any:
        isotp = library()
        ids = {"txid": self._out_id, "rxid": self._back_id}
        self._errors = []
        return isotp.TransportLayerLogic(
            rxfn=self._next_frame,
            txfn=self._send_frame,
            address=isotp.Address(isotp.AddressingMode.Normal_11bits, **ids),
            error_handler=self._note,
            params={
                "tx_data_min_length": 8,
                "blocksize": BLOCK_FRAMES,
                "stmin": GAP_MS,
                "rx_flowcontrol_timeout": SILENCE_MS,
                "rx_consecutive_frame_timeout": SILENCE_MS,
                "wftmax": MOST_WAITS,
                "max_frame_size": most_bytes,
            },
        )

    def _counted(self, data: bytes) -> Iterator[int]:
        for self._given, byte in enumerate(data, 1):
            yield byte

    def _next_frame(self, wait_s: float) -> Any:
        """A frame of the transfer; None where none comes in time, whatever else does."""
        end_s = time.monotonic() + wait_s
        while not self._frames:
            event = self.link.receive(end_s - time.monotonic())
            if event is None:
                return None
            self.take(event)
            if self._lost:
                raise TransferFailed(f"the bus was lost: {self._lost}")
        data = self._frames.popleft()
        return library().CanMessage(arbitration_id=self._back_id, dlc=len(data), data=data)

    def _send_frame(self, frame: Any) -> None:
        if self.link.send(frame.arbitration_id, bytes(frame.data)) is None:
            raise TransferFailed("the bus takes no frames")

    def _note(self, error: Exception) -> None:
        """Frames of an earlier try, late, are no error of this one."""
        errors = library().errors
        if not isinstance(
            error,
            (
                errors.UnexpectedFlowControlError,
                errors.UnexpectedConsecutiveFrameError,
                errors.ReceptionInterruptedWithFirstFrameError,
            ),
        ):
            self._errors.append(error)


def failure_of(error: Exception) -> Exception:
    errors = library().errors
    silence = f"for {SILENCE_MS / 1000.0:g} s"
    known = {
        errors.FlowControlTimeoutError: f"the controller gave no flow control {silence}",
        errors.ConsecutiveFrameTimeoutError: f"no frame came {silence}",
        errors.WrongSequenceNumberError: "a frame was lost or came twice",
        errors.MaximumWaitFrameReachedError: "the controller asks to wait, again and again",
        errors.InvalidCanDataError: "a frame came that is none of ISO-TP",
        errors.FrameTooLongError: "more bytes came than were said",
    }
    if isinstance(error, errors.OverflowError):
        return TooLarge(str(error))
    return TransferFailed(known.get(type(error), str(error)))


def library() -> Any:
    """can-isotp, quiet; it imports python-can, which has to be there as we import it."""
    import quiesce.can.python_can

    assert quiesce.can.python_can
    import isotp

    logging.getLogger("isotp").setLevel(logging.CRITICAL + 1)
    return isotp
