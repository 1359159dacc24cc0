"""Tables of a controller at work over CAN: sent whole, checked, used; told, taken back, fetched."""

import time
from dataclasses import dataclass
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.can.database import Database
from quiesce.can.link import Link
from quiesce.can.roads import ROADS
from quiesce.can.services import BUSY, DONE, Reply, Services, no_answer
from quiesce.can.transfer import Channel, Progress, TooLarge, TransferFailed, no_room
from quiesce.table.file import read_data
from quiesce.table.words import WORD, opened, signed

TRIES = 3  # of a whole transfer
BUSY_S = 5.0
STORE_S = 3.0  # the controller gives its store 2 s
# A last frame may be behind its check, which has the higher priority: asked again after this time.
BEHIND_S = 0.05

REFUSED, NOTHING_RECEIVED = "TABLE_REFUSED", "NOTHING_RECEIVED"
NOTHING, STORE_FAILED = "NOTHING_TO_SEND", "STORE_FAILED"
NO_SUCH_TABLE = "NO_SUCH_TABLE"

# What TABLE_INFO is asked for.
CRC, MAGIC, STORED, SOURCE, BOARD, WRITES, REFUSAL, RECORD = range(8)
# Where a table in use came from.
SOURCES = ("none", "ships", "loaded", "stored", "file")
# How the controller's start found a record.
RECORDS = ("whole", "older", "lost")


class Refused(BenchFailure):
    """The controller's checker took it not."""

    def __init__(self, verdict: int) -> None:
        super().__init__(f"refused with verdict {verdict}")
        self.verdict = verdict


@dataclass(frozen=True)
class State:
    """What is on one road."""

    road: str
    crc: int  # 0: no table
    magic: int
    source: str
    stored_crc: int  # 0: nothing stored
    writes: int  # of its record
    refusal: int  # verdict of the last refusal, 0: none
    record: str | None  # None: firmware that does not tell


class Tables:
    """Every method: BenchFailure where the controller does not answer, or does not do it."""

    def __init__(self, link: Link, database: Database, progress: Progress | None = None) -> None:
        self._link = link
        self._channel = Channel(link, database, progress)
        self.services = Services(link, database, self._channel.take)

    def info(self, road: str, what: int) -> int:
        return self._must("TABLE_INFO", road, what).param_value % WORD

    def state(self, road: str) -> State:
        source = self.info(road, SOURCE)
        return State(
            road=road,
            crc=self.info(road, CRC),
            magic=self.info(road, MAGIC),
            source=SOURCES[source] if source < len(SOURCES) else str(source),
            stored_crc=self.info(road, STORED),
            writes=self.info(road, WRITES),
            refusal=self.info(road, REFUSAL),
            record=self.record(road),
        )

    def record(self, road: str) -> str | None:
        """How a road's record was found. None where the firmware does not tell."""
        reply = self._ask("TABLE_INFO", ROADS.index(road), RECORD)
        if reply.result == NO_SUCH_TABLE:
            return None
        number = self._done(reply).param_value
        return RECORDS[number] if number < len(RECORDS) else str(number)

    def send(self, data: bytes, crc: int) -> None:
        """A table's file; nothing is used. crc: the table's own. Refused by the checker."""
        why = ""
        for _ in range(TRIES):
            try:
                self._channel.send(data)
            except TransferFailed as error:
                why = str(error)
                continue
            except TooLarge:
                raise self._failure(no_room(len(data)))
            if self._is_whole(crc):
                return
            why = "the controller did not get all of it"
        raise self._failure(f"{TRIES} transfers failed, the last one because {why}")

    def commit(self, road: str, crc: int) -> None:
        """Uses what was sent. Refused."""
        reply = self._ask("TABLE_COMMIT", 0, signed(crc))
        # Its answer was late and it was asked again: then there is nothing any more to commit.
        if reply.result == NOTHING_RECEIVED and self.info(road, CRC) == crc:
            return
        self._done(reply)

    def save(self, road: str) -> None:
        self._done(self._ask("TABLE_SAVE", ROADS.index(road), reply_s=STORE_S, tries=2))

    def revert(self, road: str) -> None:
        """To the table before. Asked twice it changes nothing more."""
        before = self.info(road, CRC)
        reply = self._ask("TABLE_REVERT", ROADS.index(road))
        if reply.result == NOTHING and self.info(road, CRC) == before:
            raise self._failure("there is no earlier table to go back to")
        if reply.result != NOTHING:
            self._done(reply)

    def ship(self, road: str) -> None:
        """To the table that ships, or none."""
        self._must("TABLE_SHIP", road)

    def fetch(self, road: str) -> bytes:
        """The file of what is in use: what comes is read, and asked for again where it is none."""
        why = ""
        for _ in range(TRIES):
            try:
                self._channel.begin()
                reply = self._ask("TABLE_SEND", ROADS.index(road))
                if reply.result == NOTHING:
                    raise self._failure(f"there is nothing to fetch: road {road} has no table")
                data = self._channel.receive(self._done(reply).param_value % WORD)
                opened(read_data(data).words)
                return data
            except (TransferFailed, ValueError) as error:
                why = str(error)
        raise self._failure(f"{TRIES} transfers failed, the last one because {why}")

    def restore(self) -> None:
        """What was learnt, from the controller's own record. Refused."""
        reply = self._ask("LEARNT_RESTORE")
        if reply.result == NOTHING:
            raise self._failure("nothing that was learnt is stored")
        self._done(reply)

    def forget(self) -> None:
        self._done(self._ask("LEARNT_FORGET"))

    def _is_whole(self, crc: int) -> bool:
        """Whether a table of this CRC has come. Refused where it is not taken."""
        for _ in range(TRIES):
            reply = self._ask("TABLE_CHECK", 0, signed(crc))
            if reply.result != NOTHING_RECEIVED:
                self._done(reply)
                return True
            self.services.wait(BEHIND_S)
        return False

    def _must(self, operation: str, road: str, value: int = 0) -> Reply:
        return self._done(self._ask(operation, ROADS.index(road), value))

    def _done(self, reply: Reply) -> Reply:
        if reply.result == REFUSED:
            raise Refused(reply.param_value)
        if reply.result != DONE:
            raise self._failure(REASONS.get(reply.result, f"refused: {reply.result}"))
        return reply

    def _ask(self, operation: str, index: int = 0, value: int = 0, **patience: Any) -> Reply:
        """Waits for a controller that is busy."""
        end_s = time.monotonic() + BUSY_S
        while True:
            reply = self.services.ask(operation, index, value, **patience)
            if reply is None:
                raise BenchFailure(no_answer(self._link))
            if reply.result != BUSY or time.monotonic() > end_s:
                return reply
            self.services.wait(0.1)

    def _failure(self, why: str) -> BenchFailure:
        return BenchFailure(f"{self._link.bus.name}: {why}")


REASONS = {
    BUSY: "the controller is busy with another table; try again",
    STORE_FAILED: "the controller could not store it",
    NOTHING_RECEIVED: "the controller has received no whole table",
    NOTHING: "the controller has nothing of it",
    "NO_SUCH_OPERATION": "this controller's firmware takes no tables over CAN",
    NO_SUCH_TABLE: "this controller's firmware knows no such table",
}
