"""A file that holds whole records only, also when the disk is full."""

from pathlib import Path


class WholeFile:
    """What python-can's writers take for an open file, text or binary.

    Writes are collected until commit(), which appends all of them or, where the disk does not take
    them, none: the file then ends where the last commit did, `error` says why, and later writes
    are dropped.
    """

    def __init__(self, path: Path) -> None:
        """OSError where it cannot be made or exists."""
        self.name = str(path)
        self.error: OSError | None = None
        self.closed = False
        self._file = path.open("xb", buffering=0)
        self._pending = bytearray()
        self._at = 0  # where the pending bytes go
        self._size = 0  # committed

    def write(self, data: str | bytes | bytearray | memoryview) -> int:
        self._pending += data.encode() if isinstance(data, str) else data
        return len(data)

    @property
    def size(self) -> int:
        """Bytes, pending ones included."""
        return max(self._size, self._at + len(self._pending))

    @property
    def pending(self) -> int:
        """Bytes that commit() would write."""
        return len(self._pending)

    def commit(self) -> None:
        pending, self._pending = bytes(self._pending), bytearray()
        is_overwriting = self._at < self._size
        if not pending or (self.error and not is_overwriting):
            return
        try:
            self._write(pending)
        except OSError as error:
            self.error = self.error or error
            if not is_overwriting:
                self._file.truncate(self._size)
                self._file.seek(self._size)
            return
        self._at += len(pending)
        self._size = max(self._size, self._at)

    def _write(self, data: bytes) -> None:
        view = memoryview(data)
        while view:
            view = view[self._file.write(view) :]

    def tell(self) -> int:
        self.commit()
        return self._at

    def seek(self, position: int) -> int:
        self.commit()
        self._at = position
        return self._file.seek(position)

    def seekable(self) -> bool:
        return True

    def flush(self) -> None:
        """Does nothing: a half record may be pending."""

    def close(self) -> None:
        if not self.closed:
            self.commit()
            self.closed = True
            self._file.close()
