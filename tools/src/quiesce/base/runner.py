"""Runs numbered pieces of work on a pool, in chunks, whoever is lost on the way: what a lost worker
had is done again."""

import math
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from typing import Any, Protocol

from quiesce.base.errors import BenchFailure
from quiesce.base.pools import Pool

# What a chunk is to take: much more than to hand it over, little to lose.
CHUNK_s = 0.5
QUEUED = 2  # chunks of each worker, so that it never waits for the next
MOST_IN_CHUNK = 10_000
# So many losses without a result between them: there is something else that ends all workers.
MOST_LOSSES = 20

Call = tuple[Callable[..., Any], tuple[Any, ...]]  # what a worker is to call, with what


class Size(Protocol):
    def next(self, left: int) -> int:
        """Pieces of the next chunk, of those that are left; at least one."""


class OneByOne:
    """Of pieces that take long each."""

    def next(self, left: int) -> int:
        return 1


class ChunkSize:
    """By the time that pieces took: first one, then as many as fill CHUNK_s."""

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._piece_s: float | None = None

    def note(self, pieces: int, took_s: float) -> None:
        self._piece_s = max(took_s / pieces, 1e-6)

    def next(self, left: int) -> int:
        """The last ones are small, so that workers end together."""
        if self._piece_s is None:
            return 1
        fair = math.ceil(left / (2 * self._workers))
        return max(1, min(round(CHUNK_s / self._piece_s), fair, MOST_IN_CHUNK))


def run_pieces(
    pool: Pool,
    numbers: Iterable[int],
    call: Callable[[list[int]], Call],
    keep: Callable[[list[int], Any], None],
    size: Size,
) -> None:
    """call: what does these pieces; keep: takes its result, in the order of finishing, once for
    each piece. BenchFailure where no worker lives; what a piece raises is raised."""
    left = deque(numbers)
    running: dict[Future[Any], list[int]] = {}
    losses = 0
    while left or running:
        try:
            while left and len(running) < QUEUED * pool.workers:
                chunk = [left.popleft() for _ in range(size.next(len(left)))]
                running[_submitted(pool, call(chunk), chunk, left)] = chunk
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                keep(running[future], future.result())
                del running[future]
                losses = 0
        except pool.lost as error:
            losses += 1
            if losses > MOST_LOSSES:
                raise BenchFailure(f"workers die again and again: {error or 'killed'}") from None
            for future, chunk in running.items():
                future.cancel()
                left.extendleft(reversed(chunk))
            running.clear()
            pool.renew()


def _submitted(pool: Pool, call: Call, chunk: list[int], left: deque[int]) -> Future[Any]:
    """A chunk that nobody takes is left again."""
    task, words = call
    try:
        return pool.submit(task, *words)
    except pool.lost:
        left.extendleft(reversed(chunk))
        raise


def mapped(pool: Pool, task: Callable[[Any], Any], items: Sequence[Any]) -> list[Any]:
    """Results in the order of the items."""
    found: dict[int, Any] = {}
    run_each(pool, [(task, (item,)) for item in items], found.__setitem__)
    return [found[number] for number in range(len(items))]


def run_each(pool: Pool, calls: Sequence[Call], keep: Callable[[int, Any], None]) -> None:
    """Pieces that take long each. keep: a piece's place among them, and its result."""
    run_pieces(
        pool,
        range(len(calls)),
        lambda chunk: calls[chunk[0]],
        lambda chunk, result: keep(chunk[0], result),
        OneByOne(),
    )
