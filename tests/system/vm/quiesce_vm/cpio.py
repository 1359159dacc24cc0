"""Writes a cpio archive in the kernel's "newc" form (Documentation/driver-api/early-userspace)."""

import stat
from pathlib import Path

_TRAILER = "TRAILER!!!"
_FOLDER = stat.S_IFDIR | 0o755
_LINK = stat.S_IFLNK | 0o777


class Archive:
    """Files in the order in which they are added, each with the folders above it."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._names: set[str] = set()

    def add_folder(self, name: str) -> None:
        parent = str(Path(name).parent)
        if parent != ".":
            self.add_folder(parent)
        self._add(name, _FOLDER, b"")

    def add_link(self, name: str, target: str) -> None:
        self._add_parent(name)
        self._add(name, _LINK, target.encode())

    def add_file(self, name: str, data: bytes, mode: int = 0o755) -> None:
        self._add_parent(name)
        self._add(name, stat.S_IFREG | mode, data)

    def content(self) -> bytes:
        return b"".join([*self._parts, _entry(len(self._parts) + 1, _TRAILER, 0, b"")])

    def _add_parent(self, name: str) -> None:
        parent = str(Path(name).parent)
        if parent != ".":
            self.add_folder(parent)

    def _add(self, name: str, mode: int, data: bytes) -> None:
        if name not in self._names:
            self._names.add(name)
            self._parts.append(_entry(len(self._parts) + 1, name, mode, data))


def _entry(inode: int, name: str, mode: int, data: bytes) -> bytes:
    """Owner, times and devices are 0: the same files give the same archive."""
    coded = name.encode() + b"\0"
    fields = (inode, mode, 0, 0, 1, 0, len(data), 0, 0, 0, 0, len(coded), 0)
    head = b"070701" + b"".join(b"%08x" % field for field in fields)
    return _padded(head + coded) + _padded(data)


def _padded(data: bytes) -> bytes:
    return data + b"\0" * (-len(data) % 4)
