"""Two workers beside one, by turns, and what a case costs."""

import os
import statistics
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.pools import LOCAL, pool_of
from quiesce.base.progress import Progress
from quiesce.base.table import format_table
from quiesce.campaign.file import Campaign
from quiesce.campaign.worker import Worker

from quiesce_benchmarks.campaign.cases import CASE_s, campaign_in, digest_on
from quiesce_benchmarks.part import Effort, Measured

TITLE = "short cases on one worker and on two"
CASES, QUICK_CASES = 10_000, 1_000
ROUNDS, QUICK_ROUNDS = 3, 1
POOLS = {"pool": None, "dask": LOCAL}
MILLION = 1_000_000
CLUSTERS = (2, 64)  # processors
PRICE_H = 0.05  # assumed, of a processor's hour, in dollars or euros

# Times of a machine that others use, too: judged, but failing no check.
FIGURES = (
    ("efficiency_2_pool", "1", 0.9, "higher", False),
    ("efficiency_2_dask", "1", 0.8, "higher", False),
    ("case_cpu", "ms", None, "lower"),
    ("row_size", "B", None, "lower"),
    ("million_core_hours", "h", None, "lower"),
    ("million_store", "GB", None, "lower"),
    ("million_on_2", "min", None, "lower"),
    ("million_on_64", "min", None, "lower"),
    ("million_price", "1", None, "lower"),
)


@dataclass(frozen=True)
class Run:
    wall_s: float  # with workers that have started
    size_B: int


def case_cpu_ms(folder: Path, cases: int) -> float:
    """Of this process, which makes the cases one after another, and of the bench."""
    campaign, worker = campaign_in(folder, cases), Worker()
    before_s = sum(os.times()[:4])
    for number in range(cases):
        worker.row(campaign.recipe, campaign.design.case(number))
    worker.close()
    return 1e3 * (sum(os.times()[:4]) - before_s) / cases


def timed(folder: Path, dask: str | None, workers: int, cases: int) -> Run:
    """After a small campaign, so that every worker is there."""
    store = folder / f"{dask}_{workers}_{time.monotonic_ns()}.sqlite"
    warm, measured = _two(folder, 40 * workers, cases)
    pool = pool_of(dask, workers)
    try:
        digest_on(warm, folder / f"{store.stem}_warm.sqlite", pool)
        start_s = time.monotonic()
        digest_on(measured, store, pool)
        wall_s = time.monotonic() - start_s
    finally:
        pool.close()
    return Run(wall_s, store.stat().st_size)


def _two(folder: Path, *cases: int) -> list[Campaign]:
    found = []
    for count in cases:
        own = folder / str(count)
        own.mkdir(exist_ok=True)
        found.append(campaign_in(own, count))
    return found


def measure(effort: Effort) -> Measured:
    cases = QUICK_CASES if effort.is_quick else CASES
    rounds = QUICK_ROUNDS if effort.is_quick else ROUNDS
    progress = Progress(2 * rounds * len(POOLS))
    runs: dict[tuple[str, int], list[Run]] = {}
    with tempfile.TemporaryDirectory(prefix="quiesce-") as name:
        for i in range(rounds):
            for pool, dask in POOLS.items():
                for workers in (1, 2):
                    run = timed(Path(name), dask, workers, cases)
                    runs.setdefault((pool, workers), []).append(run)
                    progress.done(f"{pool}, {workers} workers, round {i + 1}")
        cost_ms = case_cpu_ms(Path(name), cases)
    values = {f"efficiency_2_{pool}": efficiency(runs, pool) for pool in POOLS}
    row_B = runs["pool", 1][0].size_B / cases
    hours = cost_ms * 1e-3 * MILLION / 3600.0
    values |= {
        "case_cpu": cost_ms,
        "row_size": row_B,
        "million_core_hours": hours,
        "million_store": row_B * MILLION * 1e-9,
        "million_price": hours * PRICE_H,
    }
    values |= {f"million_on_{cores}": 60.0 * hours / cores for cores in CLUSTERS}
    return Measured(values, {"cases": cases}, (table(runs, cases),))


def efficiency(runs: dict[tuple[str, int], list[Run]], pool: str) -> float:
    """Median over rounds: the two runs of a round met the same other load, more or less."""
    pairs = zip(runs[pool, 1], runs[pool, 2], strict=True)
    return statistics.median(one.wall_s / (2.0 * two.wall_s) for one, two in pairs)


def table(runs: dict[tuple[str, int], list[Run]], cases: int) -> str:
    rows = [
        [pool, str(workers), f"{run.wall_s:.1f}", f"{cases / run.wall_s:.0f}"]
        for (pool, workers), several in runs.items()
        for run in several
    ]
    head = ["on", "workers", "seconds", "cases/s"]
    return f"{cases} cases of {CASE_s} s\n" + format_table(head, rows, left=(0,))
