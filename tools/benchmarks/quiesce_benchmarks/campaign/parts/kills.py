"""Commands, workers and benches killed at random moments; what is left in the store."""

import os
import random
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

from quiesce.base.pools import LOCAL, pool_of
from quiesce.base.progress import Progress
from quiesce.campaign.store import NAME

from quiesce_benchmarks.campaign.cases import campaign_in, digest_on, open_store
from quiesce_benchmarks.part import Effort, Measured

TITLE = "commands, workers and benches killed"
KILLS, QUICK_KILLS = 50, 10
OF_ONE = 5  # kills of a campaign; each second campaign is on Dask
CASES, CASE_s = 300, 1.0
MOST_WAIT_s = 1.0  # from the first new row to the kill

FIGURES = (
    ("kills", "1", None, "higher"),
    ("rows_lost", "1", 0.0, "lower"),
    ("rows_doubled", "1", 0.0, "lower"),
    ("hash_equal", "1", 1.0, "higher"),
)


@dataclass
class Tally:
    by_target: dict[str, int] = field(default_factory=dict)
    lost: int = 0
    doubled: int = 0

    @property
    def kills(self) -> int:
        return sum(self.by_target.values())


def numbers_in(store: Path) -> list[int]:
    """Of all rows; none where there is no store yet. Opened for writing, as whoever is killed in
    the middle of a chunk leaves a journal that only a writer can roll back."""
    if not store.exists():
        return []
    with closing(sqlite3.connect(f"file:{store}?mode=rw", uri=True, timeout=30.0)) as base:
        try:
            return [number for (number,) in base.execute("SELECT number FROM cases")]
        except sqlite3.OperationalError as error:
            if "no such table" in str(error):
                return []
            raise


def descendants(pid: int) -> list[int]:
    found: list[int] = []
    for tasks in Path(f"/proc/{pid}/task").glob("*/children"):
        try:
            own = [int(word) for word in tasks.read_text().split()]
        except OSError:  # it ended meanwhile
            continue
        found += [*own, *(one for child in own for one in descendants(child))]
    return found


def name_of(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/comm").read_text().strip()
    except OSError:
        return ""


def start(folder: Path, is_dask: bool) -> subprocess.Popen[bytes]:
    words = ["campaign", str(folder / "measured.toml"), "--out", str(folder), "--workers", "2"]
    words += ["--dask", LOCAL] if is_dask else []
    return subprocess.Popen(
        [sys.executable, "-m", "quiesce", *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )


def kill_one(process: subprocess.Popen[bytes], rng: random.Random, tally: Tally) -> None:
    """The command, or one of the processes under it."""
    below = descendants(process.pid)
    benches = [pid for pid in below if name_of(pid) == "quiesce_bench"]
    workers = [pid for pid in below if pid not in benches]
    targets = {"command": [process.pid], "worker": workers, "bench": benches}
    target = rng.choice([name for name, pids in targets.items() if pids])
    try:
        os.kill(rng.choice(targets[target]), signal.SIGKILL)
    except ProcessLookupError:
        return
    tally.by_target[target] = tally.by_target.get(target, 0) + 1
    if target == "command":
        process.wait()


def run_killed(folder: Path, wanted: int, is_dask: bool, rng: random.Random, tally: Tally) -> None:
    """One campaign to its end, with kills on the way until there are as many as wanted."""
    store, seen = folder / NAME, set[int]()
    process = start(folder, is_dask)
    while process.poll() is None or len(seen) < CASES:
        if process.poll() is not None:
            process = start(folder, is_dask)
        now = numbers_in(store)
        tally.lost += len(seen - set(now))
        is_further = len(now) > len(seen)
        seen |= set(now)
        if tally.kills < wanted and is_further and len(seen) < CASES:
            time.sleep(rng.uniform(0.0, MOST_WAIT_s))
            kill_one(process, rng, tally)
        time.sleep(0.05)
    end = numbers_in(store)
    tally.lost += CASES - len(set(end))
    tally.doubled += len(end) - len(set(end))


def measure(effort: Effort) -> Measured:
    kills = QUICK_KILLS if effort.is_quick else KILLS
    rng, tally, digests, count = random.Random(effort.seed), Tally(), set[str](), 0
    progress = Progress(kills)
    with tempfile.TemporaryDirectory(prefix="quiesce-") as name:
        while tally.kills < kills:
            folder = Path(name) / str(count)
            folder.mkdir()
            campaign = campaign_in(folder, CASES, CASE_s)
            before = tally.kills
            wanted = min(kills, tally.kills + OF_ONE)
            run_killed(folder, wanted, count % 2 == 1, rng, tally)
            for _ in range(tally.kills - before):
                progress.done(f"campaign {count + 1}")
            with closing(open_store(campaign, folder / NAME)) as store:
                digests.add(store.digest())
            count += 1
        digests |= unharmed(Path(name))
    values: dict[str, float | None] = {
        "kills": tally.kills,
        "rows_lost": tally.lost,
        "rows_doubled": tally.doubled,
        "hash_equal": float(len(digests) == 1),
    }
    return Measured(values, {"campaigns": count, "killed": tally.by_target})


def unharmed(folder: Path) -> set[str]:
    """Digests of the same campaign on 1, 2 and 4 workers and on Dask."""
    folder = folder / "unharmed"
    folder.mkdir()
    campaign = campaign_in(folder, CASES, CASE_s)
    found = set()
    for dask, workers in ((None, 1), (None, 2), (None, 4), (LOCAL, 2)):
        pool = pool_of(dask, workers)
        try:
            found.add(digest_on(campaign, folder / f"{dask}_{workers}.sqlite", pool))
        finally:
            pool.close()
    return found
