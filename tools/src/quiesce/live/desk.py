"""What a server knows of its bus. The link's thread reads; all here runs in the server's loop."""

import math
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from quiesce.can.database import Database
from quiesce.can.e2e import JUMPED, OK
from quiesce.can.link import Back, Link, Lost, Sent
from quiesce.can.recorder import Preamble, RawStream
from quiesce.can.services import IDENTIFICATION, REPLY, VERSION_PARTS
from quiesce.can.traffic import Traffic
from quiesce.can.transfer import BACK
from quiesce.live.freeze import FirstFault
from quiesce.live.jobs import Jobs
from quiesce.live.law_view import View
from quiesce.live.protocol import Block
from quiesce.live.recordings import Recordings
from quiesce.live.relay import Relay
from quiesce.live.rings import Ring
from quiesce.live.series import FREQUENCY, RMS, catalogue, preferred
from quiesce.live.spectrum import Spectra, SpectrumPlan
from quiesce.live.stop import Pressed, Stop

RING_SAMPLES = 32768  # half a minute at 1 kHz
MOST_EVENTS = 2000  # a drain: a storm does not keep the loop from a STOP
MOST_SAMPLES = 4096  # of a message in one packet
HISTORY_S = 30.0  # for a viewer that comes
NONE = "NONE"
FLAGS = ("is_enabled", "is_estop", "lock_is_on", "freq_is_valid", "raw_is_streaming", "fault_count")


@dataclass(frozen=True)
class Before:
    """Parameters to revert to: of the last save from here, else those that were found at first."""

    values: list[int] = field(default_factory=list)
    is_saved: bool = False


class Desk:
    """drain() takes what has come; the rest answers what viewers ask. Of a link that echoes what is
    sent, recordings have that, too."""

    def __init__(
        self,
        link: Link,
        database: Database,
        is_raw: bool = False,
        record_folder: Path = Path("recordings"),
        relay: Relay | None = None,
    ) -> None:
        self.database = database
        self.series = catalogue(database)
        self._link = link
        self._relay = relay
        self.stop = Stop(link, database)
        self.preamble = Preamble(link, database)
        self.jobs = Jobs(link, database, self.preamble)
        self.recordings = Recordings(record_folder, database, self.preamble)
        self.first_fault = FirstFault(database)
        self.traffic = Traffic(database)
        self.newest_s = math.nan  # arrival of the newest frame that can be trusted
        self.before = Before()
        self.law: View | None = None  # the law's table, as it was fetched last
        self.rings = {one.frame_id: Ring(RING_SAMPLES) for one in self.series}
        self.spectra = Spectra(self.series, self.rings)
        self._raw = RawStream(link, database, self.preamble) if is_raw else None
        self._status: dict[str, Any] = {}
        self._status_s = math.nan
        self._faults: dict[str, int] = {}  # how often each was entered since the start
        self._lost = ""
        self._losses = 0
        ids = {name: database.by_name[name].frame_id for name in ("Status", REPLY, IDENTIFICATION)}
        self._status_id = ids.pop("Status")
        self._asked_ids = set(ids.values())
        self._flow_id = database.by_name[BACK].frame_id

    # What comes

    def drain(self) -> None:
        for _ in range(MOST_EVENTS):
            event = self._link.receive_now()
            if event is None:
                break
            self.take(event)
        self.recordings.look(self.rings, self.series)
        self.stop.poll()
        if not self.jobs.is_asking:
            self._ask()
        values = self.preamble.values
        if len(self.before.values) != len(values):  # of no controller yet, or another one
            self.before = Before(list(values))

    def _ask(self) -> None:
        """One request at a time."""
        if self._raw is None or self._raw.poll() is None:
            self.preamble.poll()

    def take(self, event: Any) -> None:
        """A frame, one of our own, the loss or return of the bus, or a mark of STOP."""
        if isinstance(event, Pressed):
            self.stop.passed(event)
            return
        if isinstance(event, Sent):
            self.recordings.take(event.message)
            return
        self.recordings.take(event)
        if self._relay is not None:
            self._relay.pass_on(event)
        if isinstance(event, Lost):
            self._lost, self._losses = event.reason, self._losses + 1
            self.jobs.tap.feed(event)
        elif isinstance(event, Back):
            self._lost = ""
            self.traffic.forget()
            self.preamble.read_again()
            self.jobs.tap.feed(event)
        elif self.traffic.take(event) in (OK, JUMPED):
            self._take_trusted(event)

    def _take_trusted(self, frame: Any) -> None:
        frame_id, data = frame.arbitration_id, bytes(frame.data)
        self.newest_s = frame.timestamp
        if frame_id in self.rings:
            self.rings[frame_id].add(frame.timestamp, data)
        if frame_id == self._status_id:
            self._take_status(frame.timestamp, data)
        elif frame_id in self._asked_ids:
            self.preamble.take(frame)
            self.jobs.tap.feed(frame)
        elif frame_id == self._flow_id:
            self.jobs.tap.feed(frame)
        else:
            self.first_fault.take(frame_id, data)

    def _take_status(self, time_s: float, data: bytes) -> None:
        before = self._status.get("fault", NONE)
        self._status, self._status_s = self.database.decode(self._status_id, data), time_s
        fault = str(self._status["fault"])
        self.stop.reported(fault)
        self.recordings.reported(str(self._status["state"]), fault)
        if fault == NONE:
            self.first_fault.healthy()
        elif fault != str(before):
            self._faults[fault] = self._faults.get(fault, 0) + 1

    # What viewers are told

    @property
    def heard(self) -> set[int]:
        """Ids of the messages that the bus carries and that can be drawn."""
        return {frame_id for frame_id, ring in self.rings.items() if ring.count}

    def fault_names(self) -> list[str]:
        """In the order of their numbers, without NONE."""
        signals = {one.name: one for one in self.database.signals(self._status_id)}
        choices = signals["fault"].choices or {}
        return [str(choices[number]) for number in sorted(choices) if str(choices[number]) != NONE]

    def start_of_history(self) -> dict[int, int]:
        """Where a viewer that comes begins, a sample's number by id."""
        since_s = time.time() - HISTORY_S
        return {frame_id: ring.first_kept(since_s) for frame_id, ring in self.rings.items()}

    def blocks(self, shown: tuple[int, ...], cursors: dict[int, int]) -> Iterator[Block]:
        """What is new of the series since the cursors, which move on."""
        for frame_id in dict.fromkeys(self.series[number].frame_id for number in shown):
            ring = self.rings[frame_id]
            first, times_s, words = ring.read(cursors[frame_id], MOST_SAMPLES)
            cursors[frame_id] = first + len(times_s)
            if len(times_s):
                mine = (one for one in shown if self.series[one].frame_id == frame_id)
                columns = [(one, self.series[one].values(words)) for one in mine]
                yield Block(frame_id, first, times_s, columns)

    def spectrum_told(self, plan: SpectrumPlan) -> dict[str, Any]:
        """With the frequency that the controller reports; None where it has none."""
        return {**self.spectra.of(plan), "freq_Hz": self._freq_Hz()}

    def _freq_Hz(self) -> float | None:
        return self._newest(FREQUENCY) if self._status.get("freq_is_valid") else None

    def _newest(self, signal: tuple[str, str]) -> float | None:
        """In the unit that people read; None where none has come."""
        reported = next(one for one in self.series if (one.message, one.signal) == signal)
        ring = self.rings[reported.frame_id]
        _, _, words = ring.read(ring.count - 1, 1)
        return round(float(reported.values(words)[0]) * reported.scale, 3) if len(words) else None

    def show_law(self, view: View) -> None:
        self.law = view

    def told(self) -> dict[str, Any]:
        """All that is no sample, as values of JSON."""
        return {
            "bus": self._bus_told(),
            "controller": self._controller_told(),
            "faults": self._faults,
            "first_fault": self.first_fault.frame,
            "later_faults": self.first_fault.later,
            "stop": self.stop.told(),
            "job": self.jobs.name,
            "recorder": self.recordings.told(),
            "heard": sorted(self.heard),
            "preferred": preferred(self.series, self.heard),
        }

    def _bus_told(self) -> dict[str, Any]:
        now_s = time.time()
        return {
            "name": self._link.bus.name,
            "is_up": self._link.is_up,
            "lost": self._lost,
            "losses": self._losses,
            "age_s": age_of(self.newest_s, now_s),
            "status_age_s": age_of(self._status_s, now_s),
            "frames": self.traffic.frames,
            "frames_lost": self.traffic.total("lost"),
            "wrong_crc": self.traffic.total("wrong_crc"),
            "malformed": self._link.malformed + self.traffic.total("wrong_length"),
        }

    def _controller_told(self) -> dict[str, Any]:
        identity: Mapping[str, int] = self.preamble.identification
        parts = [str(identity[f"version_{part}"]) for part in VERSION_PARTS] if identity else []
        return {
            "version": ".".join(parts),
            "misunderstood": self.preamble.misunderstood,
            "state": str(self._status.get("state", "")),
            "fault": str(self._status.get("fault", "")),
            "freq_Hz": self._freq_Hz(),
            "rms_m_s2": self._newest(RMS),
            **{name: self._status.get(name) for name in FLAGS},
        }


def age_of(time_s: float, now_s: float) -> float | None:
    """None where there was nothing. Rounded to ms."""
    return None if math.isnan(time_s) else round(max(0.0, now_s - time_s), 3)
