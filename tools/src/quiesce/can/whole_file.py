"""A file that holds whole records only, also when the disk is full."""

from pathlib import Path


class WholeFile:
    """What python-can's writers take for an open file, text or binary.

    Writes are collected until commit(). Where the disk does not take all of them, the file is cut
    after the last record (mark()) that fits, `error` says why, and later writes are dropped.
    """

    def __init__(self, path: Path) -> None:
        """OSError where it cannot be made or exists."""
        self.name = str(path)
        self.error: OSError | None = None
        self.closed = False
        self._file = path.open("xb", buffering=0)
        self._pending = bytearray()
        self._marks = [0]  # ends of records in the pending bytes
        self._at = 0  # where the pending bytes go
        self._size = 0  # committed

    def write(self, data: str | bytes | bytearray | memoryview) -> int:
        self._pending += data.encode() if isinstance(data, str) else data
        return len(data)

    def mark(self) -> None:
        """A record ends here."""
        self._marks.append(len(self._pending))

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
        marks, self._marks = self._marks, [0]
        is_overwriting = self._at < self._size
        if not pending or (self.error and not is_overwriting):
            return
        written = self._write(pending)
        if written < len(pending) and not is_overwriting:
            written = max(mark for mark in marks if mark <= written)
            self._file.truncate(self._size + written)
            self._file.seek(self._size + written)
        self._at += written
        self._size = max(self._size, self._at)

    def _write(self, data: bytes) -> int:
        """Returns how many bytes the disk took; sets `error` where that is not all."""
        view = memoryview(data)
        try:
            while view:
                view = view[self._file.write(view) :]
        except OSError as error:
            self.error = self.error or error
        return len(data) - len(view)

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
