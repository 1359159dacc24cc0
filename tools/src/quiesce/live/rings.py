"""The last samples of a message: when it came, and its bytes as one word."""

import numpy as np


class Ring:
    """Samples are numbered from 0 since the start; the oldest make room."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.count = 0  # of all that ever came
        self._times_s = np.zeros(size)
        self._words = np.zeros(size, np.uint64)
        self._last_s = 0.0

    def add(self, time_s: float, data: bytes) -> None:
        """data: at most 8 bytes. A clock that is set back does not turn the order round."""
        self._last_s = max(self._last_s, time_s)
        at = self.count % self.size
        self._times_s[at] = self._last_s
        self._words[at] = int.from_bytes(data, "little")
        self.count += 1

    def first_kept(self, since_s: float = 0.0) -> int:
        """Number of the first sample that is there, and not older than a time."""
        oldest = max(0, self.count - self.size)
        times_s = self._times_s[np.arange(oldest, self.count) % self.size]
        return oldest + int(np.searchsorted(times_s, since_s))

    def read(self, first: int, most: int) -> tuple[int, np.ndarray, np.ndarray]:
        """Copies of at most so many from `first` on, or from the first that is still there: its
        number, times, words."""
        first = max(first, self.count - self.size, 0)
        at = np.arange(first, max(first, min(self.count, first + most))) % self.size
        return first, self._times_s[at], self._words[at]
