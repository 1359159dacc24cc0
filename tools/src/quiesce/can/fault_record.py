"""The record of a fault as firmware/comm/fault_record.h has it: fetched by pages, read, listed."""

import struct
import time
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.can.services import BUSY, DONE, Reply, Services, no_answer

MESSAGE = "FaultRecord"
REQUEST = "FAULT_RECORD"
CLEAR = "CLEAR_RECORD"
NOTHING = "NOTHING_TO_SEND"
PAGE_BYTES = 6
BUSY_S = 5.0  # a record takes 0.7 s to be complete, more where ticks are slow or lost
QUIET_S = 0.5  # without a page: it is asked for again
MOST_QUIET = 10  # times in a row
MOST_WRONG = 3

MAGIC = b"QFR1"
HEAD = struct.Struct("<4s4BI2H2I4BIi2IHBB")
BINS_HZ = 50
LATCHED = 128
EMPTY = (32767, -32768)


@dataclass(frozen=True)
class Signal:
    """A column of the record: its values are `scale` times the integers on the wire."""

    name: str  # with its unit
    title: str
    unit: str
    scale: float


SIGNALS = (
    Signal("accel_m_s2", "acceleration", "m/s2", 0.002),
    Signal("displacement_mm", "displacement", "mm", 0.01),
    Signal("rms_m_s2", "RMS", "m/s2", 0.001),
    Signal("freq_Hz", "frequency", "Hz", 0.01),
    Signal("current_cmd_A", "command", "A", 0.001),
    Signal("current_law_A", "law's request", "A", 0.001),
    Signal("current_meas_A", "measured current", "A", 0.001),
    Signal("state", "state, 16 + state while the driver is on", "", 1),
)


class WrongRecord(Exception):
    """Bytes that are no record; the text says why."""


@dataclass(frozen=True)
class FaultRecord:
    number: int
    fault: int
    is_latched: bool
    state_before: int
    tick: int
    tick_rate_Hz: int
    fault_bin: int
    param_hash: int
    table_hash: int
    version: str
    interface_version: int
    fault_count: int
    accel_counts: int
    ticks_lost: int
    samples_refused: int
    law: int
    damper: int
    bins: tuple[tuple[tuple[int, int] | None, ...], ...]  # of each signal, None: no value

    @property
    def times_s(self) -> list[float]:
        """Where each bin begins, from the beginning of the fault's on."""
        return [(i - self.fault_bin) / BINS_HZ for i in range(len(self.bins))]


def record_of(data: bytes) -> FaultRecord:
    """WrongRecord where it is none, or damaged."""
    if len(data) < HEAD.size + 4 or data[:4] != MAGIC:
        raise WrongRecord("it is no fault record of a version that is known")
    if zlib.crc32(data[:-4]) != int.from_bytes(data[-4:], "little"):
        raise WrongRecord("its CRC is wrong")
    _, fault, state, fault_bin, count, tick, *rest = HEAD.unpack_from(data)
    _, rate_Hz, params, table, major, minor, patch, interface, *rest = rest
    faults, counts, lost, refused, number, law, damper = rest
    bins = bins_of(data[HEAD.size : -4])
    if len(bins) != count or fault_bin >= count:
        raise WrongRecord(f"{len(bins)} bins instead of {count}, the fault in {fault_bin}")
    return FaultRecord(
        number=number,
        fault=fault,
        is_latched=state >= LATCHED,
        state_before=state % LATCHED,
        tick=tick,
        tick_rate_Hz=rate_Hz,
        fault_bin=fault_bin,
        param_hash=params,
        table_hash=table,
        version=f"{major}.{minor}.{patch}",
        interface_version=interface,
        fault_count=faults,
        accel_counts=counts,
        ticks_lost=lost,
        samples_refused=refused,
        law=law,
        damper=damper,
        bins=bins,
    )


def bins_of(data: bytes) -> tuple[tuple[tuple[int, int] | None, ...], ...]:
    bands = [None if band == EMPTY else band for band in struct.iter_unpack("<hh", data)]
    each = len(SIGNALS)
    return tuple(tuple(bands[i : i + each]) for i in range(0, len(bands), each))


def csv_lines(record: FaultRecord) -> Iterator[str]:
    """A row a bin; empty cells where there was no value."""
    yield ",".join(["time_s", *(f"{s.name}_{end}" for s in SIGNALS for end in ("min", "max"))])
    for time_s, bands in zip(record.times_s, record.bins, strict=True):
        cells = [f"{time_s:.2f}"]
        for signal, band in zip(SIGNALS, bands, strict=True):
            cells += ["", ""] if band is None else [f"{value * signal.scale:g}" for value in band]
        yield ",".join(cells)


@dataclass(frozen=True)
class Fetched:
    data: bytes
    later: int  # faults since that were not recorded


class Collector:
    """Takes frames, keeps the pages of one record."""

    def __init__(self, database: Any) -> None:
        self._database = database
        self._message = database.by_name[MESSAGE]
        self._number: int | None = None
        self.total = 0
        self.pages: dict[int, bytes] = {}

    def take(self, event: Any) -> None:
        """Any frame. Pages of another record than those so far begin anew."""
        if getattr(event, "arbitration_id", None) != self._message.frame_id:
            return
        data = bytes(event.data)
        if len(data) != self._message.length:
            return
        raw = self._database.raw(self._message.frame_id, data)
        if raw["record_number"] != self._number:
            self._number = raw["record_number"]
            self.pages.clear()
        self.pages[raw["record_page"]] = data[-PAGE_BYTES:]

    def missing(self) -> tuple[int, int] | None:
        """First page of the first gap, and how many; None: all are there."""
        gap = [page for page in range(self.total) if page not in self.pages]
        if not gap:
            return None
        count = next((i for i, page in enumerate(gap) if page != gap[0] + i), len(gap))
        return gap[0], count

    def data(self) -> bytes:
        return b"".join(self.pages[page] for page in range(self.total))


class Fetch:
    """Asks a controller for its record, again for pages that are lost."""

    def __init__(
        self, link: Any, database: Any, progress: Callable[[int, int], None] | None = None
    ) -> None:
        self._link = link
        self._collector = Collector(database)
        self._services = Services(link, database, self._collector.take)
        self._progress = progress or (lambda done, total: None)

    def record(self) -> tuple[FaultRecord, Fetched]:
        """BenchFailure where nobody answers, there is none, or it stays wrong."""
        for _ in range(MOST_WRONG):
            fetched = self._fetch()
            try:
                return record_of(fetched.data), fetched
            except WrongRecord as error:
                why = str(error)
        raise BenchFailure(f"{self._link.bus.name}: the fault record cannot be used: {why}")

    def clear(self) -> None:
        # Nothing left: it was forgotten, and the answer that said so was late.
        self._ask(CLEAR, 0, (DONE, NOTHING))

    def _ask(self, operation: str, value: int, good: tuple[str, ...] = (DONE,)) -> Reply:
        """Waits for a record that is being taken."""
        end_s = time.monotonic() + BUSY_S
        while True:
            reply = self._services.ask(operation, value=value)
            if reply is None:
                raise BenchFailure(no_answer(self._link))
            if reply.result in good:
                return reply
            if reply.result != BUSY or time.monotonic() > end_s:
                raise BenchFailure(f"{self._link.bus.name}: {refused(reply.result)}")
            self._services.wait(0.1)

    def _fetch(self) -> Fetched:
        self._collector.pages.clear()
        value = self._ask(REQUEST, 0).param_value
        self._collector.total = value & 0xFFFF
        quiet = 0
        while (gap := self._collector.missing()) is not None:
            before = len(self._collector.pages)
            self._services.wait(QUIET_S)
            self._progress(len(self._collector.pages), self._collector.total)
            if len(self._collector.pages) != before:
                quiet = 0
                continue
            quiet += 1
            if quiet > MOST_QUIET:
                raise BenchFailure(f"{self._link.bus.name}: pages of the fault record stay away")
            first, count = gap
            value = self._ask(REQUEST, first | count << 16).param_value
        return Fetched(self._collector.data(), value >> 16 & 0xFFFF)


def refused(result: str) -> str:
    known = {
        NOTHING: "the controller has no fault record",
        "NO_SUCH_OPERATION": "this controller keeps no fault record",
        BUSY: "the fault record is not complete yet; ask again",
    }
    return known.get(result, f"the fault record is refused: {result}")
