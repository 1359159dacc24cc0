"""The benchmark of campaigns: what its figures are made of."""

import random
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest
from quiesce.campaign.store import NAME
from quiesce.campaign.worker import run_chunk
from quiesce_benchmarks.campaign.cases import campaign_in, open_store
from quiesce_benchmarks.campaign.parts import kills, speed


def test_efficiency_is_the_median_of_rounds() -> None:
    walls_s = {("pool", 1): (10.0, 40.0, 10.0), ("pool", 2): (5.0, 25.0, 10.0)}
    runs = {key: [speed.Run(wall_s, 1) for wall_s in several] for key, several in walls_s.items()}
    assert speed.efficiency(runs, "pool") == pytest.approx(0.8)


def test_rows_are_counted_as_they_are_in_the_store(build: Path, tmp_path: Path) -> None:
    assert kills.numbers_in(tmp_path / NAME) == []
    campaign = campaign_in(tmp_path, 5)
    with closing(open_store(campaign, tmp_path / NAME)) as store:
        store.put(run_chunk(campaign.recipe, [campaign.design.case(i) for i in (1, 3)])[0])
    assert kills.numbers_in(tmp_path / NAME) == [1, 3]


def test_a_store_whose_writer_was_killed_in_the_middle_has_its_rows(tmp_path: Path) -> None:
    file = tmp_path / NAME
    writer = f"""
import os, signal, sqlite3
base = sqlite3.connect({str(file)!r})
base.execute("CREATE TABLE cases (number INTEGER PRIMARY KEY, text)")
base.executemany("INSERT INTO cases VALUES (?, ?)", [(i, "") for i in range(7)])
base.commit()
base.execute("PRAGMA cache_size = 1")  # rows reach the file before their commit
base.executemany("INSERT INTO cases VALUES (?, ?)", [(i, "x" * 2000) for i in range(7, 900)])
os.kill(os.getpid(), signal.SIGKILL)
"""
    subprocess.run([sys.executable, "-c", writer], check=False)
    assert file.with_name(f"{NAME}-journal").exists()
    assert kills.numbers_in(file) == list(range(7))


@pytest.mark.slow
def test_a_kill_is_counted_and_the_campaign_ends_whole(build: Path, tmp_path: Path) -> None:
    tally = kills.Tally()
    campaign = campaign_in(tmp_path, kills.CASES, kills.CASE_s)
    kills.run_killed(tmp_path, 1, False, random.Random(1), tally)
    assert (tally.kills, tally.lost, tally.doubled) == (1, 0, 0)
    with closing(open_store(campaign, tmp_path / NAME)) as store:
        assert store.missing(kills.CASES) == []
