"""Pieces of work on the bench, some at a time."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

from quiesce.base.progress import Progress
from quiesce.engine.bench import Bench

WORKERS = 2
Work = tuple[str, Callable[[], Any]]  # what to say when it is done, what to do
Done = TypeVar("Done")


def run_all(
    bench: Bench, tasks: Sequence[Callable[[], Done]], workers: int = WORKERS
) -> list[Done]:
    """Results in order. Where one fails, those under way are ended and the others left out."""
    pool = ThreadPoolExecutor(workers)
    try:
        return [future.result() for future in [pool.submit(task) for task in tasks]]
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        bench.stop()
        raise
    finally:
        pool.shutdown()


def run_work(bench: Bench, pieces: Sequence[Work], workers: int = WORKERS) -> list[Any]:
    """Results in order, progress on stderr."""
    progress = Progress(len(pieces))

    def told(name: str, task: Callable[[], Any]) -> Callable[[], Any]:
        def run() -> Any:
            result = task()
            progress.done(name)
            return result

        return run

    return run_all(bench, [told(*piece) for piece in pieces], workers)
