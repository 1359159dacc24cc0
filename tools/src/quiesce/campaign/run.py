"""Runs what a store lacks."""

from collections.abc import Callable
from typing import Any

from quiesce.base.pools import Pool
from quiesce.base.runner import Call, ChunkSize, run_pieces
from quiesce.campaign.file import Campaign
from quiesce.campaign.store import Store
from quiesce.campaign.worker import run_chunk

Tell = Callable[[int, int], None]  # rows done now, those of them that failed


def run_missing(campaign: Campaign, store: Store, pool: Pool, tell: Tell) -> None:
    """Every chunk is stored as it is finished. BenchFailure where no worker lives."""
    size = ChunkSize(pool.workers)

    def call(numbers: list[int]) -> Call:
        return run_chunk, (campaign.recipe, [campaign.design.case(number) for number in numbers])

    def keep(_: list[int], result: Any) -> None:
        rows, took_s = result
        store.put(rows)
        size.note(len(rows), took_s)
        tell(len(rows), sum(bool(row.reason) for row in rows))

    run_pieces(pool, store.missing(len(campaign.design)), call, keep, size)
