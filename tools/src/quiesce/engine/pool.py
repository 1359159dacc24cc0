"""Pieces of work on the bench, some at a time."""

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from quiesce.base.pools import Threads
from quiesce.base.progress import Progress
from quiesce.base.runner import run_each
from quiesce.engine.bench import Bench

WORKERS = 2
Work = tuple[str, Callable[[], Any]]  # what to say when it is done, what to do
Done = TypeVar("Done")


def run_all(
    bench: Bench | None, tasks: Sequence[Callable[[], Done]], workers: int = WORKERS
) -> list[Done]:
    """Results in order. Where one fails, those under way are ended and the others left out. bench:
    None where the tasks need none."""
    pool = Threads(workers)
    found: dict[int, Done] = {}
    try:
        run_each(pool, [(task, ()) for task in tasks], found.__setitem__)
    except BaseException:
        pool.cancel()
        if bench:
            bench.stop()
        raise
    finally:
        pool.close()
    return [found[number] for number in range(len(tasks))]


def run_work(bench: Bench | None, pieces: Sequence[Work], workers: int = WORKERS) -> list[Any]:
    """Results in order, progress on stderr."""
    progress = Progress(len(pieces))

    def told(name: str, task: Callable[[], Any]) -> Callable[[], Any]:
        def run() -> Any:
            result = task()
            progress.done(name)
            return result

        return run

    return run_all(bench, [told(*piece) for piece in pieces], workers)
