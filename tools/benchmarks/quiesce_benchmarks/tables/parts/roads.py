"""Each kind of table on each target: loaded, used, saved, in use again after a power cut, taken
back; by the tools' own client and by one that knows the messages alone."""

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.base.table import format_table
from quiesce.can.database import shipped
from quiesce.can.tables import CRC, MAGIC, SOURCE, SOURCES, STORED

from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.tables.client import Client, client_of
from quiesce_benchmarks.tables.foreign import ForeignClient, Silence
from quiesce_benchmarks.tables.samples import Sample, all_samples
from quiesce_benchmarks.tables.targets import TARGETS, Mps2Node, SlowMps2Node, Target, running

TITLE = "roads: every kind of table into every target, its memory, and back"
FIGURES = (
    ("table_roads", "kinds x targets", None, "higher"),
    ("table_roads_ok", "kinds x targets", 36.0, "higher"),
    ("table_foreign_client_ok", "kinds x targets", 36.0, "higher"),
    ("table_roads_again", "kinds x targets", None, "lower"),
)


@dataclass(frozen=True)
class Row:
    kind: str
    target: str
    why: str  # empty: it did all that it has to
    foreign_why: str
    again: str  # why one of them was gone a second time; empty: none was


def require(holds: bool, what: str) -> None:
    if not holds:
        raise BenchFailure(f"not so: {what}")


def in_use(client: Client, road: str, words: list[int], source: str) -> None:
    tables = client.tables
    require(tables.info(road, CRC) == words[1], f"{words[1]:08x} is in use")
    require(tables.info(road, MAGIC) == words[0], "its kind is told")
    require(SOURCES[tables.info(road, SOURCE)] == source, f"it is {source}")


def prepare(client: Client, sample: Sample) -> None:
    """With the law and what else it needs, all kept."""
    client.set(sample.settings)
    if sample.before is not None:
        road = "tracker" if sample.road == "law" else "law"
        client.use(road, sample.before)
        client.tables.save(road)


def travel(target: Target, sample: Sample) -> None:
    """BenchFailure where a step of the way is not as it must be."""
    road = sample.road
    (first, first_mA), (second, second_mA) = sample.first, sample.second
    with client_of(target.line) as client:
        prepare(client, sample)
        before = client.tables.info(road, CRC)
        client.use(road, first)
        in_use(client, road, first, "loaded")
        client.arm()
        client.see(first_mA)
        client.use(road, second)
        in_use(client, road, second, "loaded")
        client.see(second_mA)
        if road != "learnt":
            client.tables.revert(road)
            in_use(client, road, first, "loaded")
            client.see(first_mA)
            client.use(road, second)
        client.tables.save(road)
        require(client.tables.info(road, STORED) == second[1], "it is stored")
        target.restart()
        in_use(client, road, second, "stored")
        client.arm()
        client.see(second_mA)
        take_back(client, road, before)
        client.line.is_to_arm = False
    target.restart()
    with client_of(target.line) as client:
        require(client.tables.info(road, CRC) == before, "what was before is back after a start")


def take_back(client: Client, road: str, before: int) -> None:
    """To what was there before, for good."""
    if road == "learnt":
        client.tables.forget()
    else:
        client.tables.ship(road)
    require(client.tables.info(road, CRC) == before, "what was before is back")
    client.tables.save(road)


def travel_foreign(target: Target, sample: Sample) -> None:
    """The same by messages alone, after the tools have chosen law and tracker."""
    road = ("law", "tracker", "learnt").index(sample.road)
    first, second = sample.first[0], sample.second[0]
    with client_of(target.line) as client:
        prepare(client, sample)
    host = ForeignClient(shipped(), target.line)
    before = host.info(road, 0)
    for words in (first, second):
        require(host.load(words) == "DONE", "it is taken")
        require(host.info(road, 0) == words[1], f"{words[1]:08x} is in use")
    require(host.fetch(road) == second, "what is fetched is what was loaded")
    if road != 2:
        require(host.ask("TABLE_REVERT", road)[0] == "DONE", "it goes back")
        require(host.info(road, 0) == first[1], "the one before is in use")
        require(host.load(second) == "DONE", "it is taken again")
    require(host.ask("TABLE_SAVE", road)[0] == "DONE", "it is stored")
    target.restart()
    require(host.info(road, 0) == second[1], "it is in use after a start")
    require(host.info(road, 3) == SOURCES.index("stored"), "it is the stored one")
    back = "LEARNT_FORGET" if road == 2 else "TABLE_SHIP"
    require(host.ask(back, road)[0] == "DONE", "it is taken back")
    require(host.info(road, 0) == before, "what was before is back")


WAYS = (travel, travel_foreign)


def why_not(kind: type[Target], sample: Sample, way: Callable[[Target, Sample], None]) -> str:
    """Empty where it went all the way."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            with running(kind, Path(folder) / "target") as target:
                way(target, sample)
        except (BenchFailure, UsageError, Silence, AssertionError) as error:
            return one_line(str(error)) or type(error).__name__
    return ""


def row_of(kind: type[Target], sample: Sample) -> Row:
    """A machine with other work may break off a road: it is gone once more, and that is told."""
    first = [why_not(kind, sample, way) for way in WAYS]
    slow = SlowMps2Node if kind is Mps2Node else kind
    last = [why and why_not(slow, sample, way) for way, why in zip(WAYS, first, strict=True)]
    return Row(sample.name, kind.name, *last, again="; ".join(filter(None, first)))


def measure(effort: Effort) -> Measured:
    rows = [row_of(kind, sample) for kind in TARGETS for sample in all_samples()]
    values = {
        "table_roads": float(len(rows)),
        "table_roads_ok": float(sum(not row.why for row in rows)),
        "table_foreign_client_ok": float(sum(not row.foreign_why for row in rows)),
        "table_roads_again": float(sum(bool(row.again) for row in rows)),
    }
    return Measured(values, {"rows": [vars(row) for row in rows]}, (table_of(rows),))


def table_of(rows: list[Row]) -> str:
    cells = [
        [row.kind, row.target, row.why or "ok", row.foreign_why or "ok", row.again] for row in rows
    ]
    head = ["kind", "target", "road", "by messages alone", "gone again, because"]
    return format_table(head, cells, (0, 1, 2, 3, 4))
