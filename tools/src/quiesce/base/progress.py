"""Progress on stderr: one line a finished piece of work, with count and time to go."""

import sys
import threading
import time


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
