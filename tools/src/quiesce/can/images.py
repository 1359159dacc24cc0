"""The program of a controller at work over CAN: another image into the place that does not run,
tried at the next start (firmware/comm/image_service.h)."""

import time
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.can.database import Database
from quiesce.can.link import Link
from quiesce.can.services import BUSY, DONE, Reply, Services, no_answer
from quiesce.can.transfer import Channel, TooLarge, TransferFailed, no_room
from quiesce.table.file import table_bytes
from quiesce.table.words import WORD, WORD_BYTES, crc_of, signed, unpacked

PIECE_MAGIC = 0x31504951  # "QIP1"
PIECE_WORDS = 1024
NAME_BYTES = 32  # of a board's name, that its CRC is of
TRIES = 3  # of a piece
BUSY_S = 5.0
SLOW_S = 25.0  # flash is erased: the controller gives it 20 s
# A last frame may be behind its request, which has the higher priority: asked again after that.
BEHIND_S = 0.05
RESTART_S = 30.0  # until the new image answers
CONFIRM_S = 20.0  # until it has confirmed itself: 2 s, on an idle bus
POLL_S = 0.25

# What IMAGE_INFO is asked for.
VERSION, SLOT, MARK, IS_TRIAL, OTHER, BEGIN, ROOM, BOARD, WORDS = range(9)
# States of a place.
STATES = ("empty", "incoming", "rejected", "superseded", "good", "trial")
NO_SUCH_OPERATION, NOTHING_RECEIVED = "NO_SUCH_OPERATION", "NOTHING_RECEIVED"

Progress = Callable[[int, int], None]  # bytes so far, of all


@dataclass(frozen=True)
class Running:
    """What a controller says of its program."""

    version: tuple[int, int, int]
    slot: int
    mark: int  # first word of its seal
    is_trial: bool
    other: str  # state of the other place
    begin: int  # address of the other place
    room: int  # bytes there
    board: int  # CRC of the board's name


def crc_of_board(name: str) -> int:
    return zlib.crc32(name.encode().ljust(NAME_BYTES, b"\0"))


def pieces_of(payload: bytes) -> list[tuple[bytes, int]]:
    """Files of TableData, with the CRC of each."""
    words = unpacked(payload.ljust(-(-len(payload) // WORD_BYTES) * WORD_BYTES, b"\xff"))
    found = []
    for at in range(0, len(words), PIECE_WORDS):
        part = words[at : at + PIECE_WORDS]
        rest = [len(part) + 4, at, *part]
        found.append((table_bytes([PIECE_MAGIC, crc_of(rest), *rest]), crc_of(rest)))
    return found


class Images:
    """Every method: BenchFailure where the controller does not answer, or does not do it."""

    def __init__(self, link: Link, database: Database) -> None:
        self._link = link
        self._channel = Channel(link, database)
        self._services = Services(link, database, self._channel.take)

    def running(self) -> Running:
        version = self._info(VERSION)
        other = self._info(OTHER)
        return Running(
            version=(version >> 16, version >> 8 & 0xFF, version & 0xFF),
            slot=self._info(SLOT),
            mark=self._info(MARK),
            is_trial=bool(self._info(IS_TRIAL)),
            other=STATES[other] if other < len(STATES) else str(other),
            begin=self._info(BEGIN),
            room=self._info(ROOM),
            board=self._info(BOARD),
        )

    def install(self, payload: bytes, progress: Progress) -> None:
        """Into the other place, to be tried at the next start."""
        self._done(self._ask("IMAGE_PREPARE", reply_s=SLOW_S, tries=2))
        done = 0
        for data, crc in pieces_of(payload):
            self._send_piece(data, crc)
            done = min(done + PIECE_WORDS * WORD_BYTES, len(payload))
            progress(done, len(payload))
        self._done(self._ask("IMAGE_FINISH", reply_s=SLOW_S, tries=2))

    def restart(self) -> None:
        """It may have begun though no reply has come."""
        end_s = time.monotonic() + BUSY_S
        while True:
            reply = self._services.ask_once("IMAGE_START")
            if reply is None and not self._asked(WORDS):
                return
            is_late = time.monotonic() > end_s
            if reply is not None and (reply.result != BUSY or is_late):
                self._done(reply)
                return
            if is_late:
                raise BenchFailure(no_answer(self._link))
            self._services.wait(0.1)

    def comes_back_as(self, mark: int, before: int) -> bool:
        """After a restart: whether the image of that mark has confirmed itself, rather than that of
        the mark before run again. BenchFailure where neither has come about in time."""
        # Until then it tells of what was written.
        if not self._wait_for(lambda: self._asked(WORDS) == 0, RESTART_S):
            raise self._failure(f"nothing answers, {RESTART_S:g} s after the restart")
        if self._info(MARK) == before:
            return False
        if not self._wait_for(lambda: self._asked(IS_TRIAL) == 0, CONFIRM_S):
            raise self._failure("the new image runs and has not confirmed itself")
        return self._info(MARK) == mark

    def _send_piece(self, data: bytes, crc: int) -> None:
        why = ""
        for _ in range(TRIES):
            try:
                self._channel.send(data)
            except TransferFailed as error:
                why = str(error)
                continue
            except TooLarge:
                raise self._failure(no_room(len(data)))
            if self._took_piece(crc):
                return
            why = "the controller did not get all of it"
        raise self._failure(f"{TRIES} transfers of a piece failed, the last one because {why}")

    def _took_piece(self, crc: int) -> bool:
        for _ in range(TRIES):
            reply = self._ask("IMAGE_PIECE", 0, signed(crc), reply_s=SLOW_S, tries=2)
            if reply.result != NOTHING_RECEIVED:
                self._done(reply)
                return True
            self._services.wait(BEHIND_S)
        return False

    def _info(self, what: int) -> int:
        return self._done(self._ask("IMAGE_INFO", what)).param_value % WORD

    def _asked(self, what: int) -> int | None:
        """None where nobody answers, as while it restarts."""
        reply = self._services.ask_once("IMAGE_INFO", what)
        return reply.param_value % WORD if reply is not None and reply.result == DONE else None

    def _wait_for(self, holds: Callable[[], bool], wait_s: float) -> bool:
        end_s = time.monotonic() + wait_s
        while time.monotonic() < end_s:
            if holds():
                return True
            self._services.wait(POLL_S)
        return False

    def _done(self, reply: Reply) -> Reply:
        if reply.result != DONE:
            raise self._failure(REASONS.get(reply.result, f"refused: {reply.result}"))
        return reply

    def _ask(self, operation: str, index: int = 0, value: int = 0, **patience: Any) -> Reply:
        """Waits for a controller that is busy."""
        end_s = time.monotonic() + BUSY_S
        while True:
            reply = self._services.ask(operation, index, value, **patience)
            if reply is None:
                raise BenchFailure(no_answer(self._link))
            if reply.result != BUSY or time.monotonic() > end_s:
                return reply
            self._services.wait(0.1)

    def _failure(self, why: str) -> BenchFailure:
        return BenchFailure(f"{self._link.bus.name}: {why}")


REASONS = {
    BUSY: "the controller is busy with another request; try again",
    "IS_ARMED": "the controller is armed; disable it first",
    "FAULT_IS_LATCHED": "a fault is latched, which the restart would forget; acknowledge it first",
    "STORE_FAILED": "the controller could not write its flash",
    "IMAGE_REFUSED": "the controller refused it: not whole, not for it, or an update is on trial",
    NOTHING_RECEIVED: "the controller has given the update up; begin anew",
    "OUT_OF_RANGE": "the controller expects another piece; begin anew",
    NO_SUCH_OPERATION: "this controller has no second place for an image: flash NAME.updatable.bin "
    "once (quiesce firmware flash --updatable)",
}
