"""A recording: files that rotate, each with the controller's identity and parameters first."""

import copy
import json
import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from quiesce import __version__
from quiesce.base.errors import BenchFailure, UsageError
from quiesce.can.configuration import Configuration
from quiesce.can.database import Database
from quiesce.can.link import Back, Link, Lost, Sent
from quiesce.can.parameters import hash_of, name_of
from quiesce.can.services import ReadAll, Requests, misunderstood
from quiesce.can.traffic import Traffic
from quiesce.can.writers import PART_SUFFIX, LogFile, MdfFile, open_log

# For the controller's identity, sent once a second, and all its parameters.
PREAMBLE_S = 3.0
READ_AGAIN_S = 5.0
# A raw stream ends by itself so long after the last request for it.
RAW_S = 10
RAW_AGAIN_S = 4.0
IDLE_S = 0.005
COMMIT_S = 0.5  # what a crash may lose


@dataclass(frozen=True)
class Plan:
    """What to record into which files."""

    out: Path
    rotate_bytes: int | None
    rotate_s: float | None
    asks: bool  # request the parameters; False: never send anything
    streams_raw: bool = False  # keep asking for every sample

    @property
    def rotates(self) -> bool:
        return self.rotate_bytes is not None or self.rotate_s is not None

    def file(self, number: int) -> Path:
        """Of the file with that number, from 1."""
        if not self.rotates:
            return self.out
        return self.out.with_name(f"{self.out.stem}_{number:04d}{self.out.suffix}")

    def stale(self) -> Path | None:
        """A file that an earlier recording of that name left, where this one might get to."""
        if not self.rotates or not self.out.parent.is_dir():
            return None
        stem, suffix = re.escape(self.out.stem), re.escape(self.out.suffix)
        series = re.compile(rf"{stem}_\d{{4,}}{suffix}({re.escape(PART_SUFFIX)})?")
        found = (one for one in self.out.parent.iterdir() if series.fullmatch(one.name))
        return min(found, default=None)


@dataclass(frozen=True)
class Marker:
    """What somebody says of that time."""

    time_s: float
    text: str


class Known(Protocol):
    """What every file begins with, kept up to date by somebody."""

    @property
    def is_complete(self) -> bool: ...
    @property
    def frames(self) -> list[Any]: ...
    @property
    def values(self) -> list[int]: ...
    @property
    def identification(self) -> dict[str, int]: ...
    def take(self, frame: Any) -> None: ...
    def read_again(self) -> None: ...


class Preamble:
    """Identity and parameters of the controller, kept up to date: what every file begins with."""

    def __init__(self, link: Link, database: Database) -> None:
        self._link = link
        self._requests = Requests(database)
        self._reader = ReadAll(self._requests)
        self._started_s = time.monotonic()
        self._parameters: list[Any] = []
        self.values: list[int] = []
        self.identity: Any = None  # the frame
        self.identification: dict[str, int] = {}

    @property
    def is_complete(self) -> bool:
        return bool(self.values) and self.identity is not None

    @property
    def is_over(self) -> bool:
        """No request is under way."""
        return self._reader.is_over

    @property
    def misunderstood(self) -> str:
        """Why this controller is asked nothing; empty where it may be, or is not known yet."""
        if not self.identification:
            return ""
        return misunderstood(self._requests.database, self.identification)

    @property
    def may_ask(self) -> bool:
        return bool(self.identification) and not self.misunderstood

    def make_room(self, now_s: float) -> bool:
        """Whether another request may be sent now; then no parameter is asked for meanwhile."""
        if not self.may_ask or self._reader.is_waiting(now_s):
            return False
        self._reader.hold(now_s)
        return True

    @property
    def frames(self) -> list[Any]:
        return [self.identity] * (self.identity is not None) + self._parameters

    def text(self) -> str:
        """What files begin with, for people."""
        if self.misunderstood:
            return f"{self.misunderstood}; the log has its frames, and no parameters"
        if not self.values:
            return "no controller answers: the log has no parameters"
        version = "an unknown version"
        if self.identification:
            parts = ("version_major", "version_minor", "version_patch")
            version = "version " + ".".join(str(self.identification[one]) for one in parts)
        return f"every file begins with the controller's {len(self.values)} parameters, {version}"

    def poll(self) -> None:
        """Sends the next request where one is due. Nothing goes to a controller that has not told
        yet that it understands."""
        data = self._reader.poll(time.monotonic()) if self.may_ask else None
        if data is not None:
            self._link.send(self._requests.request_id, data)

    def take(self, frame: Any) -> None:
        self._reader.take(frame)
        if self._reader.is_complete and self._reader.frames is not self._parameters:
            self._parameters, self.values = self._reader.frames, self._reader.values
        identification = self._requests.identification_in(frame)
        if identification is not None:
            self.identity, self.identification = frame, identification
            if self._reader.is_over and identification["param_hash"] != hash_of(self.values):
                self._read_on()

    def _read_on(self) -> None:
        """Where it was given up from there, else from the start; not without a pause."""
        if time.monotonic() - self._started_s < READ_AGAIN_S:
            return
        if self._reader.is_complete:
            self.read_again()
        else:
            self._reader.go_on()
            self._started_s = time.monotonic()

    def read_again(self) -> None:
        """The parameters may be others now."""
        self._reader = ReadAll(self._requests)
        self._started_s = time.monotonic()


class RawStream:
    """Keeps the controller sending every sample."""

    def __init__(self, link: Link, database: Database, preamble: Preamble) -> None:
        self._link = link
        self._requests = Requests(database)
        self._preamble = preamble
        self._due_s = 0.0

    def poll(self) -> Any:
        """Asks where it is time to, between two requests for parameters: reading all may take long
        on a bus that loses frames. Returns the frame."""
        now_s = time.monotonic()
        if now_s < self._due_s or not self._preamble.make_room(now_s):
            return None
        self._due_s = now_s + RAW_AGAIN_S
        return self._ask(RAW_S)

    def end(self) -> Any:
        return self._ask(0)

    def _ask(self, seconds: int) -> Any:
        data = self._requests.make("RAW_STREAM", value=seconds)
        return self._link.send(self._requests.request_id, data)


class Recorder:
    """Takes everything from the link until told to stop; run() is all there is to do. A link that
    the plan asks through echoes, so that requests are in their places. known: what files begin
    with, where somebody else reads it; the plan does not ask then."""

    def __init__(
        self,
        link: Any,
        database: Database,
        plan: Plan,
        say: Callable[[str], None],
        known: Known | None = None,
    ) -> None:
        self.plan = plan
        self.traffic = Traffic(database)
        self.preamble = Preamble(link, database)
        self.known: Known = known or self.preamble
        self.raw = RawStream(link, database, self.preamble) if plan.streams_raw else None
        self.files: list[LogFile] = []
        self._number = 0  # of the last file
        self._is_warned = False
        self._link = link
        self._database = database
        self._say = say
        self._held: list[Any] | None = []  # until the preamble is there; None: no more
        self._started_s = time.monotonic()
        self._file_started_s = self._committed_s = 0.0
        self._configuration = Configuration(database)

    @property
    def file(self) -> LogFile:
        return self.files[-1]

    def open(self) -> None:
        """OSError where the file cannot be made, or is the first and exists."""
        while True:
            self._number += 1
            try:
                file = open_log(self.plan.file(self._number), self._attachments)
                break
            except FileExistsError:
                # Somebody made it since the start: neither theirs nor what comes may be lost.
                if not self.files:
                    raise
        self.files.append(file)
        self._file_started_s = time.monotonic()

    def run(self, stop: Any, until_s: float | None, every_s: float, tell: Any) -> None:
        """Until `stop` is set or for until_s; tell() every so often. BenchFailure where the disk
        does not take more. The files are complete in any case."""
        told_s = time.monotonic()
        try:
            while not stop.is_set() and not self._is_over(until_s):
                self.step()
                if time.monotonic() - told_s >= every_s:
                    told_s = time.monotonic()
                    tell()
            self._drain()
        finally:
            self.close()
        self._check_disk()

    def _is_over(self, until_s: float | None) -> bool:
        return until_s is not None and time.monotonic() - self._started_s >= until_s

    def step(self) -> None:
        self._ask()
        event = self._link.receive(IDLE_S)
        if event is None or time.monotonic() - self._committed_s >= COMMIT_S:
            self.file.commit()
            self._committed_s = time.monotonic()
        while event is not None:
            self.take(event)
            event = self._link.receive_now()
        self._check_disk()
        self._warn()
        self._rotate_if_due()

    def _ask(self) -> None:
        """One request at a time."""
        sent = self.raw.poll() if self.raw is not None else None
        if sent is None and self.plan.asks:
            self.preamble.poll()

    def _drain(self) -> None:
        """What has arrived already."""
        if self.raw is not None and self.preamble.may_ask:
            self.raw.end()
        while (event := self._link.receive_now()) is not None:
            self.take(event)
        if self.plan.asks:
            for message in self._link.untold():
                self.keep(message)

    def take(self, event: Any) -> None:
        if isinstance(event, Sent):
            self.keep(event.message)
        elif isinstance(event, Lost):
            self._note(f"bus lost: {event.reason}", event.time_s)
        elif isinstance(event, Back):
            self._note(f"bus back after {event.gap_s:.3f} s; frames are missing", event.time_s)
            self.traffic.forget()
            self.known.read_again()
        elif isinstance(event, Marker):
            self._note(event.text, event.time_s)
        else:
            self.traffic.take(event)
            self.known.take(event)
            self.keep(event)

    def keep(self, frame: Any) -> None:
        self._configuration.take(frame)
        if self._held is None:
            self.file.write(frame)
            return
        self._held.append(frame)
        is_late = time.monotonic() - self._started_s > PREAMBLE_S
        if self.known.is_complete or not self.plan.asks or is_late:
            self._begin()

    def _begin(self) -> None:
        """The first file gets its preamble, then what was held."""
        held, self._held = self._held or [], None
        first = self.known.frames
        known = {id(frame) for frame in first}
        self._write_preamble(held[0].timestamp if held else time.time())
        for frame in held:
            if id(frame) not in known:
                self.file.write(frame)
        if self.plan.asks:
            self._say(self.preamble.text())

    def _write_preamble(self, time_s: float) -> None:
        for frame in self.known.frames:
            self._configuration.take(frame)
            stamped = copy.copy(frame)
            stamped.timestamp = time_s
            self.file.write(stamped)

    def _rotate_if_due(self) -> None:
        plan, age_s = self.plan, time.monotonic() - self._file_started_s
        is_large = plan.rotate_bytes is not None and self.file.size >= plan.rotate_bytes
        is_old = plan.rotate_s is not None and age_s >= plan.rotate_s
        if self._held is not None or not (is_large or is_old):
            return
        last_s = self.file.last_s
        self.file.close()
        try:
            self.open()
        except OSError as error:
            raise BenchFailure(f"{error.filename}: {error.strerror}; the files before are complete")
        self._write_preamble(last_s)

    def _note(self, text: str, time_s: float) -> None:
        self._say(text)
        self.file.note(text, time_s)

    def _warn(self) -> None:
        """At once and once, where the format cannot hold what comes; totals follow at the end."""
        if not self._is_warned and self.file.failure:
            self._is_warned = True
            self._say(self.file.failure)

    def _check_disk(self) -> None:
        file = self.file
        if file.error is not None:
            last = time.strftime("%H:%M:%S", time.localtime(file.last_s))
            raise BenchFailure(
                f"{file.path}: {file.error.strerror}; recording ended at {last}, what was written "
                "is readable"
            )

    def close(self) -> None:
        """All files are complete afterwards."""
        if self._held is not None:
            self._begin()
        self.file.close()
        for file in self.files:
            if isinstance(file, MdfFile):
                file.finish()
            if file.failure:
                self._say(file.failure)

    def _attachments(self) -> list[tuple[str, bytes, str]]:
        """The database and the configuration, for formats that take files."""
        dump = {
            "tools": __version__,
            "identification": self.known.identification,
            "parameters": {name_of(i): value for i, value in enumerate(self.known.values)},
            "tables": {road: f"{crc:08X}" for road, crc in self._configuration.tables.items()},
        }
        return [
            (self._database.file.name, self._database.source.encode(), "application/octet-stream"),
            ("parameters.json", json.dumps(dump, indent=1).encode(), "application/json"),
        ]


def open_first(recorder: Recorder) -> None:
    """UsageError where the first file cannot be made, or files of an earlier series are there."""
    path = recorder.plan.file(1)
    stale = recorder.plan.stale()
    if stale is not None:
        raise UsageError(f"{stale} exists, of an earlier recording; choose another --out")
    try:
        recorder.open()
    except FileExistsError as error:
        raise UsageError(f"{error.filename} exists; choose another --out")
    except OSError as error:
        raise UsageError(f"cannot write {path}: {error.strerror}; choose another --out")
