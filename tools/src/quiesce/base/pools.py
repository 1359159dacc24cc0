"""Where pieces of work run: threads or processes of this machine, or a Dask cluster's workers."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from typing import Any, Protocol

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.base.extras import extra

LOCAL = "local"  # a cluster of Dask on this machine
CLOSING_s = 20.0


class Pool(Protocol):
    """workers: how many pieces run at a time. lost: what a future raises whose worker is gone."""

    workers: int
    lost: tuple[type[BaseException], ...]

    def submit(self, task: Callable[..., Any], *words: Any) -> Future[Any]: ...

    def renew(self) -> None:
        """After a loss. BenchFailure where there is nobody left to work."""

    def close(self) -> None:
        """Ends what is under way."""


class Threads:
    """Of this process, which starts programs that do the work. None is lost."""

    lost: tuple[type[BaseException], ...] = ()

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._pool = ThreadPoolExecutor(workers)

    def submit(self, task: Callable[..., Any], *words: Any) -> Future[Any]:
        return self._pool.submit(task, *words)

    def renew(self) -> None:
        raise AssertionError("no thread is lost")

    def cancel(self) -> None:
        """What has not begun never does."""
        self._pool.shutdown(wait=False, cancel_futures=True)

    def close(self) -> None:
        self._pool.shutdown(cancel_futures=True)


class Processes:
    """Of this machine. One that is killed takes the others' chunks with it; all are started
    again."""

    lost = (BrokenProcessPool,)

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._pool = self._made()

    def _made(self) -> ProcessPoolExecutor:
        context = multiprocessing.get_context("spawn")
        return ProcessPoolExecutor(self.workers, context, _begin)

    def submit(self, task: Callable[..., Any], *words: Any) -> Future[Any]:
        with _without_interrupts():
            return self._pool.submit(task, *words)

    def renew(self) -> None:
        self.close()
        self._pool = self._made()

    def close(self) -> None:
        processes = list((self._pool._processes or {}).values())
        self._pool.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.terminate()
        self._pool.shutdown()


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Processes that start meanwhile do not see Ctrl-C before they can ignore it."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin() -> None:
    """In a worker: Ctrl-C is its parent's affair, with which it ends, however that ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def follow() -> None:
        assert parent is not None
        parent.join()
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


class Cluster:
    """Of Dask: the scheduler at an address, or one of this machine."""

    def __init__(self, address: str, workers: int) -> None:
        """workers: of one of this machine. UsageError where nobody answers at the address."""
        with extra("cluster", "--dask"):
            from distributed import Client, LocalCluster
            from distributed.scheduler import KilledWorker

        self.lost = (KilledWorker, CancelledError)
        self._local = None
        try:
            if address == LOCAL:
                self._local = LocalCluster(
                    n_workers=workers, threads_per_worker=1, dashboard_address=None
                )
            self._client = Client(self._local or address, timeout="10s")
        except (OSError, ValueError) as error:
            raise UsageError(f"--dask {address}: no scheduler of Dask answers there: {error}")
        self._executor = self._client.get_executor(pure=False)
        self.workers = workers if self._local else self._threads()

    def _threads(self) -> int:
        found = sum(self._client.nthreads().values())
        if not found:
            self.close()
            raise UsageError("--dask: the scheduler has no workers yet; start some")
        return int(found)

    def submit(self, task: Callable[..., Any], *words: Any) -> Future[Any]:
        return self._executor.submit(task, *words)  # type: ignore[no-any-return]

    def renew(self) -> None:
        if self._client.status != "running":
            raise BenchFailure("the scheduler of Dask was lost; the same command goes on")

    def close(self) -> None:
        with suppress(TimeoutError):  # of a machine that has more to do; all ends with this process
            self._client.close(timeout=CLOSING_s)
            if self._local is not None:
                self._local.close(timeout=CLOSING_s)


def pool_of(dask: str | None, workers: int) -> Pool:
    """dask: an address, LOCAL, or None for processes of this machine."""
    return Processes(workers) if dask is None else Cluster(dask, workers)
