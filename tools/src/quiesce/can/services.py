"""Requests to a controller (ServiceRequest, ServiceReply): one at a time, answered or given up."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.can.database import Database
from quiesce.can.e2e import ALIVE_PERIOD, alive_of, frame_crc, protect
from quiesce.can.link import Link

REQUEST = "ServiceRequest"
REPLY = "ServiceReply"
IDENTIFICATION = "Identification"
DONE = "DONE"
NO_SUCH_PARAMETER = "NO_SUCH_PARAMETER"
BUSY = "BUSY"
# A reply takes a tick and the way there and back; adapters on USB and UARTs add milliseconds. Tried
# for 1.5 s: a computer under load may leave a controller on it without time for as long.
REPLY_S = 0.15
TRIES = 10
MAX_PARAMETERS = 256  # the index has 8 bits
# Identification comes once a second; two may be lost.
IDENTIFIED_S = 3.5
SILENT_S = 3.5  # a bus on which nothing at all comes for so long has nobody to answer
MOST_LATE = 4096  # events that had come before the time was over
VERSION_PARTS = ("major", "minor", "patch")


@dataclass(frozen=True)
class Reply:
    result: str  # label of the DBC
    param_index: int
    param_value: int


class Requests:
    """Packs requests and knows their replies. The alive counter tells replies apart."""

    def __init__(self, database: Database) -> None:
        self.database = database
        self.request_id = database.by_name[REQUEST].frame_id
        self.reply_id = database.by_name[REPLY].frame_id
        self.identification_id = database.by_name[IDENTIFICATION].frame_id
        self._alive = time.monotonic_ns() // 1000 % ALIVE_PERIOD
        self._apply = database.number(REQUEST, "operation", "APPLY")
        self._operation = 0
        self._index = 0

    def make(self, operation: str, index: int = 0, value: int = 0) -> bytes:
        """Data of the next request."""
        self._alive = (self._alive + 1) % ALIVE_PERIOD
        self._operation = self.database.number(REQUEST, "operation", operation)
        self._index = index
        data = self.database.encode(
            REQUEST, operation=self._operation, param_index=index, param_value=value
        )
        layout = self.database.by_name[REQUEST].protection
        assert layout is not None
        return protect(layout, self._alive, data)

    def reply_in(self, frame: Any, tries: int = 1) -> Reply | None:
        """The reply to the last request, or to one of the last `tries` that asked the same; None
        where the frame is something else, such as a late reply about another index. APPLY alone
        answers with one of its own: of the parameter that is at fault."""
        message = self.database.by_id[self.reply_id]
        data = bytes(frame.data)
        if frame.arbitration_id != self.reply_id or len(data) != message.length:
            return None
        layout = message.protection
        assert layout is not None
        age = (self._alive - alive_of(layout, data)) % ALIVE_PERIOD
        if data[-1] != frame_crc(self.reply_id, data) or age >= tries:
            return None
        raw = self.database.raw(self.reply_id, data)
        is_ours = raw["param_index"] == self._index or self._operation == self._apply
        if raw["operation"] != self._operation or not is_ours:
            return None
        result = self.database.label(REPLY, "result", raw["result"])
        return Reply(result, raw["param_index"], raw["param_value"])

    def identification_in(self, frame: Any) -> dict[str, int] | None:
        message = self.database.by_id[self.identification_id]
        if frame.arbitration_id != self.identification_id or len(frame.data) != message.length:
            return None
        return self.database.raw(self.identification_id, bytes(frame.data))


class ReadAll:
    """Reads every parameter, a step at a time: poll() says what to send, take() gets every frame.

    Ends at the first index that the controller does not have, or when it answers no more: then
    go_on() asks for what is missing. A late reply counts as well as one in time.
    """

    def __init__(self, requests: Requests) -> None:
        self.requests = requests
        delay_ms = requests.database.by_name[REQUEST].delay_ms
        self._least_s = delay_ms / 1000.0
        self.values: list[int] = []
        self.frames: list[Any] = []  # the replies
        self.is_complete = False
        self.is_given_up = False
        self._due_s = 0.0
        self._tries = 0

    @property
    def is_over(self) -> bool:
        return self.is_complete or self.is_given_up

    def go_on(self) -> None:
        """Where it has given up."""
        self.is_given_up = False
        self._tries = 0

    def is_waiting(self, now_s: float) -> bool:
        """Whether a request is under way that may be answered yet."""
        return not self.is_over and now_s < self._due_s

    def hold(self, now_s: float) -> None:
        """Somebody else asks something now."""
        self._due_s = max(self._due_s, now_s + self._least_s)

    def poll(self, now_s: float) -> bytes | None:
        """A request that is due now. now_s: of a monotonic clock."""
        if self.is_over or now_s < self._due_s:
            return None
        if self._tries == TRIES:
            self.is_given_up = True
            return None
        self._tries += 1
        self._sent_s = now_s
        self._due_s = now_s + REPLY_S
        return self.requests.make("READ", len(self.values))

    def take(self, frame: Any) -> bool:
        """Returns whether the frame is an awaited reply."""
        reply = self.requests.reply_in(frame, self._tries) if not self.is_complete else None
        if reply is None or reply.param_index != len(self.values):
            return False
        self._due_s = self._sent_s + self._least_s
        if reply.result == DONE:
            self._tries = 0
            self.values.append(reply.param_value)
            self.frames.append(frame)
        self.is_complete = reply.result == NO_SUCH_PARAMETER or len(self.values) == MAX_PARAMETERS
        return True


class Services:
    """Asks and waits, so many times. Everything else that arrives meanwhile goes to `on_event`.

    ask() and read_all() say nothing before the controller has told that its messages are ours.
    """

    def __init__(
        self,
        link: Link,
        database: Database,
        on_event: Callable[[Any], None] | None = None,
        tries: int = TRIES,
    ) -> None:
        self.link = link
        self._tries = tries
        self.requests = Requests(database)
        self.identification: dict[str, int] | None = None
        self._least_s = database.by_name[REQUEST].delay_ms / 1000.0
        self.next_s = 0.0
        self.on_event = on_event or (lambda _: None)
        self._is_understood = False
        self._heard = 0  # frames, since the last request

    def understand(self) -> None:
        """Waits until the controller identifies itself. UsageError where its messages are of
        another version than the database's, BenchFailure where nobody does."""
        end_s = time.monotonic() + IDENTIFIED_S
        while self.identification is None and (left_s := end_s - time.monotonic()) > 0.0:
            event = self.link.receive(left_s)
            if event is not None:
                self.take(event)
        if self.identification is None:
            raise BenchFailure(no_answer(self.link))
        why = misunderstood(self.requests.database, self.identification)
        if why:
            raise UsageError(f"{self.link.bus.name}: {why}")
        self._is_understood = True

    def ask(
        self,
        operation: str,
        index: int = 0,
        value: int = 0,
        reply_s: float = REPLY_S,
        tries: int | None = None,
    ) -> Reply | None:
        """None where no reply comes. A busy controller is asked again; a late answer to an earlier
        try is one. A try in which nothing came at all does not count while that is not long: then
        this computer, or what the controller runs on, had no time."""
        if not self._is_understood:
            self.understand()
        most, counted, asked, heard_s = tries or self._tries, 0, 0, time.monotonic()
        while True:
            asked, self._heard = asked + 1, 0
            reply = self.ask_once(operation, index, value, reply_s, asked)
            if reply is not None and reply.result != BUSY:
                return reply
            if self._heard:
                heard_s = time.monotonic()
            counted += bool(self._heard)
            if counted >= most or time.monotonic() - heard_s > SILENT_S:
                return reply

    def ask_once(
        self,
        operation: str,
        index: int = 0,
        value: int = 0,
        reply_s: float = REPLY_S,
        tries: int = 1,
    ) -> Reply | None:
        """tries: that have asked just this, with this one; an answer to any of them will do. What
        has come by the end of the time is looked at, however late that is."""
        self.wait(max(0.0, self.next_s - time.monotonic()))
        now_s = time.monotonic()
        self.next_s = now_s + self._least_s
        self.link.send(self.requests.request_id, self.requests.make(operation, index, value))
        end_s, most_late = now_s + reply_s, MOST_LATE
        while True:
            left_s = end_s - time.monotonic()
            event = self.link.receive(max(left_s, 0.0))
            most_late -= left_s <= 0.0
            if event is None or most_late < 0:
                return None
            self.take(event)
            if hasattr(event, "arbitration_id"):
                reply = self.requests.reply_in(event, min(tries, ALIVE_PERIOD - 1))
                if reply is not None:
                    return reply

    def read_all(self) -> list[int]:
        """Values in index order. BenchFailure where nobody answers."""
        if not self._is_understood:
            self.understand()
        reader = ReadAll(self.requests)
        while not reader.is_over:
            request = reader.poll(time.monotonic())
            if request is not None:
                self.link.send(self.requests.request_id, request)
            event = self.link.receive(0.002)
            if event is not None:
                self.take(event)
                if hasattr(event, "arbitration_id"):
                    reader.take(event)
        if not reader.is_complete:
            raise BenchFailure(no_answer(self.link))
        return reader.values

    def wait_hash(self, expected: int, wait_s: float) -> bool:
        """Whether an Identification that comes from now on tells this param_hash."""
        end_s = time.monotonic() + wait_s
        while (left_s := end_s - time.monotonic()) > 0.0:
            self.identification = None
            self.wait(min(left_s, 0.05))
            seen: dict[str, int] | None = self.identification
            if seen is not None and seen["param_hash"] == expected:
                return True
        return False

    def wait(self, wait_s: float) -> None:
        """Takes what arrives for so long."""
        end_s = time.monotonic() + wait_s
        while (left_s := end_s - time.monotonic()) > 0.0:
            event = self.link.receive(left_s)
            if event is not None:
                self.take(event)

    def take(self, event: Any) -> None:
        if hasattr(event, "arbitration_id"):
            self._heard += 1
            self.identification = self.requests.identification_in(event) or self.identification
        self.on_event(event)


def misunderstood(database: Database, identification: dict[str, int]) -> str:
    """Why frames of this controller must not be read by this database; empty: they may."""
    theirs, ours = identification["interface_version"], database.version
    if theirs == ours:
        return ""
    number = ".".join(str(identification[f"version_{part}"]) for part in VERSION_PARTS)
    return (
        f"the controller (firmware {number}) has version {theirs} of the CAN messages, these tools "
        f"have {ours}; use the tools of its firmware's release"
    )


def no_answer(link: Link) -> str:
    state = "the bus is down" if not link.is_up else "is one on this bus, at this bit rate?"
    return f"{link.bus.name}: no controller answers; {state}"
