"""Runs of campaigns: whoever is killed, every case has one row, and rows are the same bits."""

import os
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from campaign_files import HEAD, SAMPLING, SMALL, write
from quiesce.base.errors import UsageError
from quiesce.base.pools import LOCAL, Pool, Processes, pool_of
from quiesce.base.runner import ChunkSize
from quiesce.campaign.facts import facts_of
from quiesce.campaign.file import Campaign, read_campaign
from quiesce.campaign.run import run_missing
from quiesce.campaign.store import NAME, Store, claimed
from quiesce.campaign.worker import TRIES, Worker, run_chunk

MANY = SMALL.replace("cases = 24", "cases = 400")


def store_of(campaign: Campaign, file: Path) -> Store:
    names = [factor.name for factor in campaign.design.factors]
    return Store(file, names, campaign.recipe.figures, facts_of(campaign))


@contextmanager
def processes(count: int) -> Iterator[Processes]:
    pool = Processes(count)
    try:
        yield pool
    finally:
        pool.close()


def here(campaign: Campaign, file: Path) -> str:
    """Digest of all rows, made one after the other in this process."""
    store = store_of(campaign, file)
    cases = [campaign.design.case(i) for i in range(len(campaign.design))]
    store.put(run_chunk(campaign.recipe, cases)[0])
    digest = store.digest()
    store.close()
    return digest


def finished(campaign: Campaign, file: Path, pool: Pool, tell=lambda rows, failed: None) -> str:
    store = store_of(campaign, file)
    run_missing(campaign, store, pool, tell)
    digest = store.digest()
    assert store.missing(len(campaign.design)) == []
    assert store.count() == len(campaign.design)
    store.close()
    return digest


def children(pid: int) -> list[int]:
    found = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        found += [int(word) for word in task.read_text().split()]
    return found


def test_workers_and_benches_that_are_killed_cost_no_row(build: Path, tmp_path: Path) -> None:
    campaign = read_campaign(write(tmp_path, MANY))
    killed: list[str] = []
    with processes(2) as pool:

        def kill(rows: int, failed: int) -> None:
            assert failed == 0
            workers = list((pool._pool._processes or {}).keys())
            benches = [one for worker in workers for one in children(worker)]
            if len(killed) < 2 and benches:
                os.kill(benches[0], signal.SIGKILL)
                killed.append("bench")
            elif len(killed) == 2:
                os.kill(workers[-1], signal.SIGKILL)
                killed.append("worker")

        digest = finished(campaign, tmp_path / "a.sqlite", pool, kill)
    assert killed == ["bench", "bench", "worker"]
    assert digest == here(campaign, tmp_path / "b.sqlite")


def command(folder: Path, *words: str) -> list[str]:
    return [sys.executable, "-m", "quiesce", "campaign", str(folder / "small.toml"),
            "--out", str(folder / "out"), "--workers", "2", *words]  # fmt: skip


def rows_in(file: Path) -> int:
    if not file.exists():
        return 0
    try:
        with sqlite3.connect(f"file:{file}?mode=rw", uri=True) as base:
            return int(base.execute("SELECT count(*) FROM cases").fetchone()[0])
    except sqlite3.OperationalError:  # not made yet
        return 0


@pytest.mark.parametrize(
    "how", [signal.SIGINT, pytest.param(signal.SIGKILL, marks=pytest.mark.slow)]
)
def test_command_that_ends_halfway_goes_on(build: Path, tmp_path: Path, how: int) -> None:
    campaign = read_campaign(write(tmp_path, MANY, duration_s=1.0))
    store = tmp_path / "out" / NAME
    process = subprocess.Popen(command(tmp_path), stderr=subprocess.PIPE, text=True)
    while rows_in(store) == 0 and process.poll() is None:
        time.sleep(0.01)
    workers = children(process.pid)
    process.send_signal(how)
    _, err = process.communicate()
    half = rows_in(store)
    assert 0 < half < 400
    if how == signal.SIGINT:
        assert process.returncode == 130
        told = err.splitlines()[-1]
        assert told.startswith(f"quiesce: interrupted; {half} of 400 cases are in ")
        assert told.endswith("the same command goes on")
        assert "Traceback" not in err
    for _ in range(200):  # workers end with their parent, however it ends
        alive = [pid for pid in workers if Path(f"/proc/{pid}/fd/0").exists()]
        if not alive:
            break
        time.sleep(0.1)
    assert alive == []
    again = subprocess.run(command(tmp_path), capture_output=True, text=True, check=True)
    assert f"{half} of 400 cases are there already" in again.stderr
    found = store_of(campaign, store)
    assert found.digest() == here(campaign, tmp_path / "b.sqlite")
    found.close()


@pytest.mark.slow
def test_one_two_and_four_workers_and_dask_make_the_same_rows(build: Path, tmp_path: Path) -> None:
    campaign = read_campaign(write(tmp_path))
    wanted = here(campaign, tmp_path / "here.sqlite")
    for workers in (1, 2, 4):
        with processes(workers) as pool:
            assert finished(campaign, tmp_path / f"{workers}.sqlite", pool) == wanted
    cluster = pool_of(LOCAL, 2)
    try:
        assert finished(campaign, tmp_path / "dask.sqlite", cluster) == wanted
    finally:
        cluster.close()


@pytest.mark.slow
def test_dask_address_where_nobody_answers_is_refused(refused, tmp_path: Path) -> None:
    write(tmp_path)
    told = refused("campaign", "small.toml", "--dask", "nonsense", "--out", "no/out")
    assert "--dask nonsense" in told


def test_a_case_that_fails_is_a_row_with_its_reason(build: Path, tmp_path: Path) -> None:
    text = HEAD + SAMPLING.replace("monte_carlo", "grid").replace("24", "1") + (
        '[[factor]]\nname = "gap"\nkey = "plant.damper.gap_m"\nvalues = [0.002, -1.0, 0.003]\n'
        '[[factor]]\nkey = "parameter.law_that_is_none"\nvalues = [1]\n'
    )  # fmt: skip
    campaign = read_campaign(write(tmp_path, text.rsplit("[[factor]]", 1)[0]))
    rows = [Worker().row(campaign.recipe, campaign.design.case(i)) for i in range(3)]
    assert [row.reason == "" for row in rows] == [True, False, True]
    # The same words in every process: no path of a file in memory, the case's own file by name.
    assert rows[1].reason.startswith("plant:")
    assert "gap_m" in rows[1].reason and "/proc/" not in rows[1].reason
    assert (rows[1].crc32, rows[1].figures) == (None, ())
    other = read_campaign(write(tmp_path, text))
    assert "law_that_is_none" in Worker().row(other.recipe, other.design.case(0)).reason


def test_a_bench_that_dies_of_a_case_is_told_after_a_few_tries(tmp_path: Path, monkeypatch) -> None:
    build = tmp_path / "host/sim_hil"
    build.mkdir(parents=True)
    bench = build / "quiesce_bench"
    bench.write_text(f"#!/bin/sh\necho >>{tmp_path / 'tries'}\nread line\nkill -SEGV $$\n")
    bench.chmod(0o755)
    monkeypatch.setenv("QUIESCE_BUILD", str(tmp_path))
    campaign = read_campaign(write(tmp_path))
    row = Worker().row(campaign.recipe, campaign.design.case(0))
    assert row.reason == "quiesce_bench ended with signal SIGSEGV"
    assert len((tmp_path / "tries").read_text()) == TRIES


def test_a_store_of_another_campaign_is_refused(build: Path, tmp_path: Path) -> None:
    file = tmp_path / "a.sqlite"
    store_of(read_campaign(write(tmp_path)), file).close()
    with pytest.raises(UsageError, match=r"made otherwise \(file\)"):
        store_of(read_campaign(write(tmp_path, SMALL.replace("1.2", "1.3"))), file)
    with pytest.raises(UsageError, match=r"made otherwise \(input scenario.toml\)"):
        store_of(read_campaign(write(tmp_path, duration_s=0.2)), file)
    store_of(read_campaign(write(tmp_path)), file).close()


def test_a_file_that_is_no_store_is_refused(build: Path, tmp_path: Path) -> None:
    file = tmp_path / "a.sqlite"
    file.write_bytes(b"no database at all, but long enough to be taken for one" * 40)
    with pytest.raises(UsageError, match="name another --out"):
        store_of(read_campaign(write(tmp_path)), file)


def test_two_campaigns_in_one_folder_are_refused(tmp_path: Path) -> None:
    with (
        claimed(tmp_path),
        pytest.raises(UsageError, match="another campaign is at work"),
        claimed(tmp_path),
    ):
        pass
    with claimed(tmp_path):
        pass


def test_a_row_never_comes_twice(build: Path, tmp_path: Path) -> None:
    campaign = read_campaign(write(tmp_path))
    store = store_of(campaign, tmp_path / "a.sqlite")
    rows, _ = run_chunk(campaign.recipe, [campaign.design.case(i) for i in (0, 1)])
    store.put(rows[:1])
    with pytest.raises(sqlite3.IntegrityError):
        store.put(rows[::-1])
    assert store.count() == 1  # all of a chunk or nothing of it
    assert store.missing(24) == list(range(1, 24))
    store.close()


def test_chunks_follow_the_time_that_cases_take_and_end_small() -> None:
    size = ChunkSize(workers=2)
    assert size.next(10_000) == 1
    size.note(1, 0.001)
    assert size.next(10_000) == 500
    assert size.next(100) == 25
    assert size.next(3) == 1
    size.note(500, 500.0)
    assert size.next(10_000) == 1
