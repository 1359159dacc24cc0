"""Progress on stderr: one line a finished piece of work, with count and time to go."""

import sys
import threading
import time
from collections.abc import Iterable, Iterator
from typing import TypeVar

Item = TypeVar("Item")
# A file that takes no longer says nothing; between two sentences about one.
READING_EVERY_s = 2.0
_READING_LOOKS = 4096  # items from one look at the clock to the next


def say(text: str) -> None:
    """A sentence of progress."""
    print(text, file=sys.stderr, flush=True)


class Progress:
    """Plain lines without control characters, the same on a terminal and in a log."""

    def __init__(self, total: int) -> None:
        self._total = total
        self._done = 0
        self._start_s = time.monotonic()
        self._lock = threading.Lock()

    def skip(self, count: int) -> None:
        """So many pieces need no work."""
        with self._lock:
            self._total -= count

    def done(self, text: str) -> None:
        with self._lock:
            self._done += 1
            elapsed_s = time.monotonic() - self._start_s
            left_s = elapsed_s / self._done * (self._total - self._done)
            eta = f"about {left_s:.0f} s to go" if self._done < self._total else "done"
            count = f"[{self._done:>{len(str(self._total))}}/{self._total}]"
            print(f"{count} {text}  ({eta})", file=sys.stderr, flush=True)


def reading(what: str, items: Iterable[Item], total: int) -> Iterator[Item]:
    """The items of a file, with a line of progress now and then while that takes long."""
    start_s = said_s = time.monotonic()
    for count, item in enumerate(items, 1):
        if count % _READING_LOOKS == 0 and (now_s := time.monotonic()) > said_s + READING_EVERY_s:
            left_s = (now_s - start_s) * (total - count) / count
            say(f"reading {what}: {100 * count // total} %, about {left_s:.0f} s to go")
            said_s = now_s
        yield item
