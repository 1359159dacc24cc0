"""Five unlike structures, each from a few numbers to rules of its own at work in the Linux
controller, by the commands of docs/howto/own-plant.md."""

import json
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.base.table import format_table

from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.tables.client import client_of
from quiesce_benchmarks.tables.line import RUNNING
from quiesce_benchmarks.tables.own_plant_page import of_structure, page, with_value
from quiesce_benchmarks.tables.targets import QuiescedOnBoard, running

TITLE = "own_plant: five structures, from a few numbers to rules at work"
FIGURES = (("own_plant_ok", "structures", 5.0, "higher"),)
# Of the mean over the steps of RMS acceleration at the first accelerometer, against 0 A.
MOST_LEFT_PCT = 95.0
PULSES_OF = "mount"  # of the full run: its tuning is the quickest
QUICK_SEARCH = {"--population": "6", "--generations": "2"}
RUN_TICKS = 30_000


@dataclass(frozen=True)
class Way:
    """From a structure's files to a table in the controller, by words of the page."""

    law: str
    make: list[str]
    run: list[str]
    load: list[str]


def quiesce(folder: Path, words: Sequence[str]) -> dict[str, Any]:
    """What `quiesce WORDS --json` prints. BenchFailure where it fails."""
    command = [sys.executable, "-I", "-m", "quiesce", *words, "--json"]
    done = subprocess.run(
        command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True
    )
    if done.returncode != 0:
        last = (done.stderr.strip() or "nothing said").splitlines()[-1]
        raise BenchFailure(f"quiesce {' '.join(words[:2])}: {last}")
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def rules_way(name: str, is_quick: bool) -> Way:
    make, run = of_structure(page().search, name), of_structure(page().run_rules, name)
    if is_quick:
        for option, value in QUICK_SEARCH.items():
            make = with_value(make, option, value)
        run = [*run, "--quick"]  # it repeats less for its real-time factor
    return Way("fuzzy", make, run, of_structure(page().load_rules, name))


def pulses_way(name: str, made: dict[str, Any]) -> Way:
    """Over the structure's own range of frequencies."""
    make = of_structure(page().tune, name)
    freqs_Hz = [step["freq_Hz"] for step in made["steps"]]
    make = with_value(make, "--from-Hz", f"{freqs_Hz[0]:g}")
    make = with_value(make, "--to-Hz", f"{freqs_Hz[-1]:g}")
    run, load = of_structure(page().run_pulses, name), of_structure(page().load_pulses, name)
    return Way("phase", make, run, load)


def left_pct(metrics: dict[str, Any], law: str, body: str) -> list[float]:
    """RMS acceleration of a body in each step, of that at 0 A."""
    key = "accel_rms_mm_s2_reduction_pct"
    rows = [row["bodies"][body] for row in metrics["rigs"] if row["law"] == law]
    return [100.0 - row[key] for row in rows]


def at_work(folder: Path, name: str, way: Way) -> str:
    """CRC of the table that is in use after a restart of quiesced. BenchFailure where none is."""
    target_of = partial(QuiescedOnBoard, folder / name / "board.toml", way.law)
    with running(target_of, folder / name / f"quiesced_{way.law}") as target:
        bus = ["--bus", f"slcan:{target.line.client}"]
        with client_of(target.line) as client:
            client.set({"law": way.law})
        loaded = quiesce(folder, [*way.load, *bus])
        require_run(target.line)
        target.restart()
        roads = quiesce(folder, ["can", "tables", *bus])["roads"]
        law = next(one for one in roads if one["road"] == "law")
        if (law["crc"], law["source"]) != (loaded["crc"], "stored"):
            raise BenchFailure(f"after a restart {law['crc']} is in use, {law['source']}")
        require_run(target.line)
    return str(loaded["crc"])


def require_run(line: Any) -> None:
    with client_of(line) as client:
        client.arm()
        line.wait(lambda: line.state in RUNNING, RUN_TICKS, "it runs")
        client.disarm()


def travel(folder: Path, name: str, body: str, way: Way) -> dict[str, Any]:
    quiesce(folder, way.make)
    out = ["--out", f"{name}/hil_{way.law}"]
    left = left_pct(quiesce(folder, [*way.run, *out]), way.law, body)
    mean = sum(left) / len(left)
    if mean > MOST_LEFT_PCT:
        raise BenchFailure(f"{mean:.1f} % of the acceleration is left")
    return {"left_pct": mean, "worst_pct": max(left), "crc": at_work(folder, name, way)}


def first_body(folder: Path) -> str:
    board = tomllib.loads((folder / "board.toml").read_text(encoding="utf-8"))
    tracked = next(one for one in board["sensor"] if one["name"] == board["tracked"])
    return str(tracked["of"])


def row_of(name: str, what: str, work: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    row = {"structure": name, "table": what, "left_pct": None, "worst_pct": None, "crc": ""}
    print(f"tables: own_plant: {name}, {what}", file=sys.stderr, flush=True)
    try:
        return {**row, **work(), "why": ""}
    except (BenchFailure, UsageError) as error:
        return {**row, "why": one_line(str(error))}


def of_structure_rows(folder: Path, name: str, is_quick: bool) -> list[dict[str, Any]]:
    try:
        made = quiesce(folder, page().new[name])
    except BenchFailure as error:
        return [row_of(name, "rules", partial(_fail, error))]
    body = first_body(folder / name)
    ways = {"rules": rules_way(name, is_quick)}
    if not is_quick and name == PULSES_OF:
        ways["pulses"] = pulses_way(name, made)
    return [
        row_of(name, what, partial(travel, folder, name, body, way)) for what, way in ways.items()
    ]


def _fail(error: BenchFailure) -> dict[str, Any]:
    raise error


def measure(effort: Effort) -> Measured:
    rows = []
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        (folder / "small.toml").write_text(page().damper, encoding="utf-8")
        for name in page().new:
            rows += of_structure_rows(folder, name, effort.is_quick)
    done = {row["structure"] for row in rows if not row["why"]}
    return Measured({"own_plant_ok": float(len(done))}, {"rows": rows}, (table_of(rows),))


def table_of(rows: Sequence[dict[str, Any]]) -> str:
    def number(value: float | None) -> str:
        return "-" if value is None else f"{value:.1f}"

    cells = [
        [
            row["structure"], row["table"], number(row["left_pct"]), number(row["worst_pct"]),
            row["crc"], row["why"] or "ok",
        ]
        for row in rows
    ]  # fmt: skip
    head = ["structure", "", "acceleration left, %", "worst step", "in use after a restart", ""]
    return format_table(head, cells, (0, 1, 4, 5))
