"""The recorder of the page: keeps what was just before, waits for triggers, sets markers."""

import csv
import time
from collections import deque
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.can.database import Database
from quiesce.can.mdf import require_mdf
from quiesce.can.recorder import Marker, Preamble
from quiesce.can.roads import ROADS
from quiesce.can.services import REPLY, REQUEST, Services
from quiesce.can.tables import CRC
from quiesce.live.record_plan import FAULT, LEVEL, MOST_BEFORE_S, MOST_S, NOW, STATE, RecordPlan
from quiesce.live.recording import Recording, time_of
from quiesce.live.rings import Ring
from quiesce.live.series import Series

MOST_EVENTS = 131072  # of what was before: a full bus of 500 kbit/s for half a minute
MOST_SAMPLES = 4096  # that a level is looked for in at once
MOST_FILES = 50  # that are told and served, the newest
NONE = "NONE"
IDLE, ARMED, RECORDING, ENDING = "idle", "armed", "recording", "ending"
MARKERS_SUFFIX = ".markers.csv"


class Known:
    """What each file begins with: the desk's preamble, and what was told of the tables."""

    def __init__(self, preamble: Preamble, database: Database) -> None:
        self._preamble = preamble
        self._database = database
        self._request_id = database.by_name[REQUEST].frame_id
        self._reply_id = database.by_name[REPLY].frame_id
        self._operation = database.number(REQUEST, "operation", "TABLE_INFO")
        self._asked: dict[int, Any] = {}  # by the alive counter
        self._tables: dict[int, tuple[Any, Any]] = {}  # request and reply by road

    @property
    def frames(self) -> list[Any]:
        pairs = tuple(self._tables.values())
        return [*self._preamble.frames, *(frame for pair in pairs for frame in pair)]

    @property
    def is_complete(self) -> bool:
        return self._preamble.is_complete

    @property
    def identification(self) -> dict[str, int]:
        return self._preamble.identification

    @property
    def values(self) -> list[int]:
        return self._preamble.values

    def note(self, frame: Any) -> None:
        """Of every frame on the bus, by who reads it."""
        if frame.arbitration_id not in (self._request_id, self._reply_id) or len(frame.data) != 8:
            return
        raw = self._database.raw(frame.arbitration_id, bytes(frame.data))
        if raw["operation"] != self._operation:
            return
        if frame.arbitration_id == self._request_id:
            self._asked[raw["alive"]] = frame if raw["param_value"] == CRC else None
        elif (request := self._asked.pop(raw["alive"], None)) is not None:
            self._tables[raw["param_index"]] = (request, frame)

    def take(self, frame: Any) -> None:
        """The recorder's thread: the desk has taken it."""

    def read_again(self) -> None:
        """The desk does."""


class Recordings:
    """All but close() in the server's loop. begin() and end() say how it went."""

    def __init__(self, folder: Path, database: Database, preamble: Preamble) -> None:
        self.folder = folder
        self._database = database
        self._known = Known(preamble, database)
        self._before: deque[Any] = deque(maxlen=MOST_EVENTS)
        self._plan: RecordPlan | None = None  # that waits for its trigger
        self._current: Recording | None = None
        self._files: deque[dict[str, Any]] = deque(maxlen=MOST_FILES)
        self._said: dict[str, Any] | None = None
        self._seen = 0  # samples of the series whose level is waited for
        self._was_beyond = True
        self._state = self._fault = ""

    # What comes

    def take(self, event: Any) -> None:
        """Every frame received or sent, loss and return of the bus."""
        if hasattr(event, "arbitration_id"):
            self._known.note(event)
        if self._current is not None:
            self._current.feed(event)
        self._before.append(event)

    def reported(self, state: str, fault: str) -> None:
        """Of each Status that can be trusted."""
        before, self._state = self._state, state
        fault_before, self._fault = self._fault, fault
        on = self._plan.trigger.on if self._plan else ""
        if on == FAULT and fault not in (NONE, fault_before) and fault_before:
            self._start(f"fault {fault}")
        elif on == STATE and before and state != before:
            self._start(f"state {before} to {state}")

    def look(self, rings: dict[int, Ring], series: Sequence[Series]) -> None:
        """For a level in what is new, and whether a recording is over."""
        self._forget()
        if self._plan is not None and self._plan.trigger.on == LEVEL:
            one = series[self._plan.trigger.series]
            self._look_at(one, rings[one.frame_id])
        if self._current is not None and self._current.is_over:
            self._finish(self._current)

    def _look_at(self, one: Series, ring: Ring) -> None:
        assert self._plan is not None
        trigger = self._plan.trigger
        first, _, words = ring.read(self._seen, MOST_SAMPLES)
        self._seen = first + len(words)
        for value in one.values(words).tolist():  # NaN is beyond nothing
            is_beyond = value > trigger.level if trigger.is_above else value < trigger.level
            if is_beyond and not self._was_beyond:
                way = "above" if trigger.is_above else "below"
                self._start(f"{one.title} {way} {trigger.level:g}")
                return
            self._was_beyond = is_beyond

    def _forget(self) -> None:
        since_s = time.time() - MOST_BEFORE_S
        while self._before and time_of(self._before[0]) < since_s:
            self._before.popleft()

    # What viewers ask for

    @property
    def state(self) -> str:
        if self._current is not None:
            return ENDING if self._current.is_ending else RECORDING
        return IDLE if self._plan is None else ARMED

    def begin(self, plan: RecordPlan, rings: dict[int, Ring], series: Sequence[Series]) -> str:
        """Starts, or waits for the trigger. UsageError where it cannot."""
        if self.state != IDLE:
            raise UsageError(f"the recorder is {self.state}; stop it first")
        try:
            if plan.format == "mf4":
                require_mdf()
            self._plan = plan
            if plan.trigger.on == NOW:
                return self._start("")
        except UsageError as error:
            self._tell(False, str(error))
            raise
        if plan.trigger.on == LEVEL:
            self._seen = rings[series[plan.trigger.series].frame_id].count
            self._was_beyond = True  # it is to be passed, not to be beyond it
        return "waiting for the trigger"

    def end(self) -> str:
        """What waits waits no more, what is written is completed."""
        self._plan = None
        if self._current is None:
            return "nothing is recorded"
        self._current.end()
        return f"{self._current.path.name} ends"

    def mark(self, text: str) -> str:
        """UsageError where nothing is recorded, or the disk does not take it."""
        current = self._current
        if current is None or current.is_ending:
            raise UsageError("nothing is recorded now: a marker needs a recording")
        now_s = time.time()
        current.markers += 1
        current.feed(Marker(now_s, f"marker {current.markers}: {text}"))
        self._tell(True, f"marker {current.markers}: {text}")
        self._keep(current.path, now_s, text)
        return f"marker {current.markers} set"

    def close(self) -> None:
        """Waits until the last file is complete."""
        self.end()
        if self._current is not None:
            self._current.wait()

    def file(self, name: str) -> Path | None:
        """A finished one."""
        is_known = any(one["name"] == name for one in self._files)
        return self.folder / name if is_known else None

    def told(self) -> dict[str, Any]:
        current = self._current
        return {
            "state": self.state,
            "folder": str(self.folder),
            "file": current.path.name if current else "",
            "bytes": current.size if current else 0,
            "frames": current.frames if current else 0,
            "duration_s": round(current.duration_s, 1) if current else 0.0,
            "markers": current.markers if current else 0,
            "said": self._said,
            "files": list(self._files),
        }

    # Files

    def _start(self, why: str) -> str:
        """UsageError where nobody waits who could be told otherwise."""
        plan, self._plan = self._plan, None
        assert plan is not None
        self._forget()
        since_s = time.time() - plan.before_s
        before = [one for one in self._before if time_of(one) >= since_s]
        try:
            self._current = self._open(plan, before)
        except UsageError as error:
            if plan.trigger.on == NOW:
                raise
            self._tell(False, str(error))
            return str(error)
        text = f"recording {self._current.path.name}" + (f": {why}" if why else "")
        self._tell(True, text)
        if why:
            self._current.feed(Marker(time.time(), f"trigger: {why}"))
            self._keep(self._current.path, time.time(), f"trigger: {why}")
        return text

    def _open(self, plan: RecordPlan, before: list[Any]) -> Recording:
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UsageError(
                f"cannot make {self.folder}: {error.strerror}; start with another --record-folder"
            )
        try:
            path = next(one for one in names(self.folder, plan.format) if not one.exists())
        except OSError as error:
            raise UsageError(
                f"cannot look into {self.folder}: {error.strerror}; start with another "
                "--record-folder"
            )
        most_s = plan.after_s or MOST_S
        return Recording(path, self._database, self._known, before, most_s)

    def _keep(self, path: Path, time_s: float, text: str) -> None:
        """Beside the recording at once: MDF4 has it at the end, CSV has no place for it."""
        beside = path.with_name(path.name + MARKERS_SUFFIX)
        try:
            is_new = not beside.exists()
            with beside.open("a", encoding="utf-8", newline="") as file:
                rows = csv.writer(file, lineterminator="\n")
                if is_new:
                    rows.writerow(("time_s", "text"))
                rows.writerow((f"{time_s:.6f}", text))
        except OSError as error:
            self._tell(False, f"{beside}: {error.strerror}; a marker is missing there")

    def _finish(self, current: Recording) -> None:
        self._current = None
        told = {"bytes": current.size, "duration_s": round(current.duration_s, 1)}
        beside = current.path.with_name(current.path.name + MARKERS_SUFFIX)
        files = [(current.result, told)] + [(beside, {})] * beside.exists()
        for path, more in files:
            size = path.stat().st_size if path.exists() else 0
            self._files.append({"name": path.name, "bytes": size, "duration_s": None, **more})
        text = current.failure or f"{current.result.name} is complete, {current.frames} frames"
        self._tell(not current.failure, text)

    def _tell(self, is_ok: bool, text: str) -> None:
        """All viewers."""
        self._said = {"is_ok": is_ok, "text": text}


def names(folder: Path, suffix: str) -> Iterator[Path]:
    """By the time, and a number where there is one already."""
    stem = time.strftime("quiesce_%Y%m%dT%H%M%S")
    yield folder / f"{stem}.{suffix}"
    number = 2
    while True:
        yield folder / f"{stem}_{number}.{suffix}"
        number += 1


def ask_tables(services: Services) -> str:
    """So that files tell which tables are in use; a firmware without tables says no."""
    for road in range(len(ROADS)):
        services.ask("TABLE_INFO", road, CRC)
    return "asked for the tables"
