"""Progress of a campaign: a bar on a terminal, a line now and then elsewhere."""

import sys
import time
from types import TracebackType
from typing import Any

from quiesce.base.progress import say

EVERY_s = 5.0


class CampaignProgress:
    """A context; done() as rows come in. known: rows that were there before."""

    def __init__(self, total: int, known: int, failed: int) -> None:
        self._total, self._known = total, known
        self._done, self._failed = known, failed
        self._start_s = self._said_s = time.monotonic()
        self._bar: Any = None
        self._task: Any = None

    def __enter__(self) -> "CampaignProgress":
        if self._known:
            say(f"{self._known} of {self._total} cases are there already")
        if sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

            self._bar = Progress(
                TextColumn("{task.completed:,.0f}/{task.total:,.0f} cases"),
                BarColumn(),
                TextColumn("{task.fields[told]}"),
                TimeRemainingColumn(),
                console=Console(stderr=True),
            )
            self._bar.start()
            self._task = self._bar.add_task("", total=self._total, completed=self._done, told="")
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.stop()

    def done(self, rows: int, failed: int) -> None:
        self._done += rows
        self._failed += failed
        now_s = time.monotonic()
        rate = (self._done - self._known) / max(now_s - self._start_s, 1e-3)
        bad = f", {self._failed} failed" if self._failed else ""
        told = f"{rate:.0f}/s{bad}"
        if self._bar is not None:
            self._bar.update(self._task, completed=self._done, told=told)
        elif now_s > self._said_s + EVERY_s or self._done == self._total:
            self._said_s = now_s
            left_s = (self._total - self._done) / rate
            eta = f"about {left_s:.0f} s to go" if left_s > 0.0 else "done"
            say(f"[{self._done}/{self._total}] {told}  ({eta})")
