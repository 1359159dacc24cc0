"""Pieces of work on threads and processes: each once, whoever is killed; what fails is raised."""

import os
import signal
import time
from contextlib import closing
from pathlib import Path

import pytest
from quiesce.base.errors import BenchFailure
from quiesce.base.pools import Processes, Threads
from quiesce.base.runner import MOST_LOSSES, run_each


def square(number: int) -> int:
    return number * number


def killed_once(folder: str, number: int) -> int:
    """The first worker that comes to a multiple of 3 is killed there."""
    mark = Path(folder) / str(number)
    if number % 3 == 0 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def killed(_: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def refused(number: int) -> int:
    if number == 3:
        raise BenchFailure("piece 3 is refused")
    return number


@pytest.mark.parametrize("make", [Threads, Processes])
def test_results_are_kept_once_each(make) -> None:
    found: list[tuple[int, int]] = []
    with closing(make(2)) as pool:
        run_each(pool, [(square, (n,)) for n in range(20)], lambda *one: found.append(one))
    assert sorted(found) == [(n, n * n) for n in range(20)]


def test_what_a_killed_process_had_is_done_again(tmp_path: Path) -> None:
    found: list[tuple[int, int]] = []
    calls = [(killed_once, (str(tmp_path), n)) for n in range(7)]
    with closing(Processes(2)) as pool:
        run_each(pool, calls, lambda *one: found.append(one))
    assert sorted(found) == [(n, n) for n in range(7)]
    assert sorted(mark.name for mark in tmp_path.iterdir()) == ["0", "3", "6"]


@pytest.mark.slow
def test_a_piece_that_kills_all_workers_ends_it() -> None:
    with closing(Processes(1)) as pool, pytest.raises(BenchFailure, match="die again and again"):
        run_each(pool, [(killed, (n,)) for n in range(MOST_LOSSES)], lambda *_: None)


@pytest.mark.parametrize("make", [Threads, Processes])
def test_what_a_piece_raises_is_raised(make) -> None:
    with closing(make(2)) as pool, pytest.raises(BenchFailure, match="piece 3 is refused"):
        run_each(pool, [(refused, (n,)) for n in range(9)], lambda *_: None)


def test_cancelled_threads_begin_nothing_more() -> None:
    begun: list[int] = []

    def slow(number: int) -> None:
        begun.append(number)
        time.sleep(0.05)

    pool = Threads(1)
    futures = [pool.submit(slow, number) for number in range(50)]
    futures[0].result()
    pool.cancel()
    pool.close()
    assert len(begun) < 5
