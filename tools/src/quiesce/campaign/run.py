"""Runs what a store lacks, in chunks, whoever is lost on the way."""

import math
from collections import deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, wait
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.campaign.file import Campaign
from quiesce.campaign.pools import Pool
from quiesce.campaign.store import Store
from quiesce.campaign.worker import run_chunk

# What a chunk is to take: much more than to hand it over, little to lose.
CHUNK_s = 0.5
QUEUED = 2  # chunks of each worker, so that it never waits for the next
MOST_IN_CHUNK = 10_000
# So many losses without a row between them: there is something else that ends all workers.
MOST_LOSSES = 20

Tell = Callable[[int, int], None]  # rows done now, those of them that failed


class ChunkSize:
    """By the time that cases took: first one, then as many as fill CHUNK_s."""

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._case_s: float | None = None

    def note(self, cases: int, took_s: float) -> None:
        self._case_s = max(took_s / cases, 1e-6)

    def next(self, left: int) -> int:
        """The last ones are small, so that workers end together."""
        if self._case_s is None:
            return 1
        fair = math.ceil(left / (2 * self._workers))
        return max(1, min(round(CHUNK_s / self._case_s), fair, MOST_IN_CHUNK))


def run_missing(campaign: Campaign, store: Store, pool: Pool, tell: Tell) -> None:
    """Every chunk is stored as it is finished. BenchFailure where no worker lives."""
    left = deque(store.missing(len(campaign.design)))
    size = ChunkSize(pool.workers)
    running: dict[Future[Any], list[int]] = {}
    losses = 0
    while left or running:
        try:
            while left and len(running) < QUEUED * pool.workers:
                numbers = [left.popleft() for _ in range(size.next(len(left)))]
                running[_submitted(campaign, pool, numbers, left)] = numbers
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                rows, took_s = future.result()
                store.put(rows)
                del running[future]
                size.note(len(rows), took_s)
                tell(len(rows), sum(bool(row.reason) for row in rows))
                losses = 0
        except pool.lost as error:
            losses += 1
            if losses > MOST_LOSSES:
                raise BenchFailure(f"workers die again and again: {error or 'killed'}") from None
            for future, numbers in running.items():
                future.cancel()
                left.extendleft(reversed(numbers))
            running.clear()
            pool.renew()


def _submitted(campaign: Campaign, pool: Pool, numbers: list[int], left: deque[int]) -> Future[Any]:
    """A chunk that nobody takes is left again."""
    cases = [campaign.design.case(number) for number in numbers]
    try:
        return pool.submit(run_chunk, campaign.recipe, cases)
    except pool.lost:
        left.extendleft(reversed(numbers))
        raise
