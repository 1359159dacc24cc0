"""4 kB over a bus of 500 kbit/s beside full telemetry: how long it takes, and what the controller's
ticks say of it."""

import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.base.table import format_table
from quiesce.can.bus_load import load_pct
from quiesce.can.database import load
from quiesce.table.file import table_bytes

from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.tables import largest
from quiesce_benchmarks.tables.bus import BITRATE, Bus
from quiesce_benchmarks.tables.bus_model import beside, transfer_s
from quiesce_benchmarks.tables.client import Client, client_of
from quiesce_benchmarks.tables.targets import Mps2Node, Quiesced, Target, running

TITLE = "load: 4 kB over 500 kbit/s beside full telemetry"
FIGURES = (
    ("load_s", "s", 3.0, "lower"),
    ("load_ticks_late", "ticks", 0.0, "lower"),
)
WORDS = 1020  # with the file's head 4096 bytes
LOADS, QUICK_LOADS = 5, 3
TIMING_ID = 0x130
RAW_S = 3600


def overruns(client: Client) -> int:
    """Lost ticks since the start, of a report that comes from now on: one a second."""
    found = client.line.listen((TIMING_ID,))
    client.line.wait(lambda: not found.empty(), 5000, "LoopTiming")
    data = bytes.fromhex(found.get()[5:].decode())
    return int(load().raw(TIMING_ID, data)["overruns"])


def one_load(client: Client, words: list[int]) -> dict[str, Any]:
    """Ticks that it took, those that were lost meanwhile, and in as long a time without it."""
    line = client.line
    before = overruns(client)
    begin, begin_s = line.ticks, time.monotonic()
    client.use("law", words)
    ticks, took_s = line.ticks - begin, time.monotonic() - begin_s
    after = overruns(client)
    end = line.ticks + ticks
    line.wait(lambda: line.ticks >= end, 2 * ticks + 5000, "as much time again")
    return {
        "ticks": ticks,
        "took_s": took_s,
        "lost": after - before,
        "lost_without": overruns(client) - after,
    }


def least_late(rows: Sequence[dict[str, Any]]) -> int:
    """A transfer that costs ticks costs them every time; what this machine loses, it loses now and
    then, without one as well."""
    return min(max(0, row["lost"] - row["lost_without"]) for row in rows)


def on_target(kind: type[Target], loads: int) -> dict[str, Any]:
    """What loads while it runs took. BenchFailure, UsageError."""
    tables = [largest.rules(WORDS, seed) for seed in range(2)]
    with (
        tempfile.TemporaryDirectory() as folder,
        running(kind, Path(folder) / "target", Bus()) as target,
        client_of(target.line) as client,
    ):
        client.set({"law": "fuzzy"})
        client.arm()
        reply = client.tables.services.ask("RAW_STREAM", 0, RAW_S)
        if reply is None or reply.result != "DONE":
            raise BenchFailure("it does not stream raw samples")
        rows = [one_load(client, tables[number % 2]) for number in range(loads)]
        bits = target.line.bus.bits if target.line.bus else 0
        return {
            "target": kind.name,
            "load_s": 1e-3 * max(row["ticks"] for row in rows),
            "late": least_late(rows),
            "lost": sum(row["lost"] for row in rows),
            "lost_without": sum(row["lost_without"] for row in rows),
            "bus_pct": 100.0 * bits / (target.line.ticks * BITRATE / 1000),
            "loads": len(rows),
        }


def measure(effort: Effort) -> Measured:
    database = load()
    size = len(table_bytes(largest.rules(WORDS)))
    model_s = transfer_s(database, size)
    rows, absent = [], []
    for kind in (Mps2Node, Quiesced):
        try:
            rows.append(on_target(kind, QUICK_LOADS if effort.is_quick else LOADS))
        except (BenchFailure, UsageError) as error:
            absent.append(f"{kind.name}: {one_line(str(error))}")
    reported = {
        "bytes": size,
        "model_s": model_s,
        "beside_pct": load_pct(beside(database), BITRATE),
        "rows": rows,
        "absent": absent,
    }
    if absent:
        return Measured({}, reported, (text_of(reported), *absent))
    values: dict[str, float | None] = {
        "load_s": max(model_s, *(row["load_s"] for row in rows)),
        "load_ticks_late": float(max(row["late"] for row in rows)),
    }
    return Measured(values, reported, (text_of(reported),))


def text_of(reported: dict[str, Any]) -> str:
    cells = [
        [
            row["target"], f"{row['load_s']:.2f}", str(row["loads"]), str(row["late"]),
            str(row["lost"]), str(row["lost_without"]),
            f"{row['bus_pct']:.0f}",
        ]
        for row in reported["rows"]
    ]  # fmt: skip
    head = ["target", "s", "loads", "ticks late", "lost in all", "in as long without", "bus %"]
    return (
        f"computed: {reported['model_s']:.2f} s for {reported['bytes']} bytes beside "
        f"{reported['beside_pct']:.0f} % of the bus\n{format_table(head, cells, (0,))}"
    )
