"""The current at the moment at which an armed controller takes another table: no step beyond the
slew limit."""

import tempfile
from itertools import pairwise
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.base.table import format_table

from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.tables.client import SETTINGS, Client, SLEW_mA, client_of
from quiesce_benchmarks.tables.counted import order, run_image
from quiesce_benchmarks.tables.line import RUNNING
from quiesce_benchmarks.tables.parts.roads import prepare
from quiesce_benchmarks.tables.samples import Sample, all_samples
from quiesce_benchmarks.tables.targets import HostNode, running

TITLE = "bump: the current where an armed controller takes another table"
FIGURES = (("bump_mA", "mA", 0.0, "lower"),)
CHANGES, QUICK_CHANGES = 8, 4
# On the image, each at another tick of a vibration of 100 ticks; every eighth change is to what
# ships, and where that is nothing the controller waits in its safe state for the next one.
PHASES, QUICK_PHASES = 400, 100
AFTER_TICKS = 250
LEAST_CHANGE_mA = 250


def steps_mA(demands: list[tuple[int, int, int]]) -> list[int]:
    """From tick to tick. BenchFailure where one is missing or the output was let go."""
    if any((after[2] - before[2]) % 16 != 1 for before, after in pairwise(demands)):
        raise BenchFailure("a demand is missing")
    if any(one[1] not in RUNNING for one in demands):
        raise BenchFailure("it did not run throughout")
    return [abs(after[0] - before[0]) for before, after in pairwise(demands)]


def change(client: Client, sample: Sample, number: int) -> list[int]:
    """Steps while a table comes, and after it is used; every fourth time it goes back instead."""
    line, road = client.line, sample.road
    begin = len(line.demands) - 1
    if number % 4 == 3 and road != "learnt":
        client.tables.revert(road)
    else:
        client.use(road, (sample.first, sample.second)[number % 2][0])
    end = len(line.demands) + AFTER_TICKS
    line.wait(lambda: len(line.demands) >= end, 10 * AFTER_TICKS, "ticks after a change")
    return steps_mA(line.demands[begin:])


def of_kind(sample: Sample, changes: int) -> dict[str, Any]:
    """On the node of this machine, as its demands tell."""
    with (
        tempfile.TemporaryDirectory() as folder,
        running(HostNode, Path(folder) / "target") as target,
        client_of(target.line) as client,
    ):
        prepare(client, sample)
        client.use(sample.road, sample.second[0])
        client.arm()
        client.see(sample.second[1])
        steps = [step for number in range(changes) for step in change(client, sample, number)]
    return row_of(sample, "host", changes, max(steps))


def of_phases(sample: Sample, changes: int) -> dict[str, Any]:
    """On the image, a change at a phase of the motion each. BenchFailure where one of them is not
    done, or the tables make no difference."""
    data = order(changes, AFTER_TICKS, sample, sample.second[0], SETTINGS)
    found = run_image("table_bump", data)["printed"]
    if found["done"] != changes or found["most_mA"] - found["least_mA"] < LEAST_CHANGE_mA:
        raise BenchFailure(f"{sample.name}: not all changes show: {found}")
    return row_of(sample, "image", changes, found["largest_step_mA"], found["not_run"])


def row_of(
    sample: Sample, target: str, changes: int, step_mA: int, not_run: int = 0
) -> dict[str, Any]:
    beyond_mA = max(0, step_mA - SLEW_mA)
    return {
        "kind": sample.name,
        "target": target,
        "changes": changes,
        "largest_step_mA": step_mA,
        "beyond_mA": beyond_mA,
        "not_run_ticks": not_run,
    }


def measure(effort: Effort) -> Measured:
    changes = QUICK_CHANGES if effort.is_quick else CHANGES
    phases = QUICK_PHASES if effort.is_quick else PHASES
    rows = [of_kind(sample, changes) for sample in all_samples()]
    rows += [of_phases(sample, phases) for sample in all_samples()]
    values: dict[str, float | None] = {"bump_mA": float(max(row["beyond_mA"] for row in rows))}
    return Measured(values, {"rows": rows, "slew_mA": SLEW_mA}, (table_of(rows),))


def table_of(rows: list[dict[str, Any]]) -> str:
    cells = [[str(value) for value in row.values()] for row in rows]
    head = ["kind", "target", "changes", "largest step, mA", f"beyond {SLEW_mA} mA a tick"]
    return format_table([*head, "ticks without a table"], cells, (0, 1))
