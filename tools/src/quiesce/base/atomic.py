"""Output files that appear complete or not at all."""

import errno
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from quiesce.base.errors import UsageError

# A full disk, a quota, a limit of a file's size, a file system that takes no writing.
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS)


@contextmanager
def output_files(folder: Path) -> Iterator[Path]:
    """Yields an empty folder to write into; at the end its files move into `folder`, those of its
    folders into folders there.

    Nothing reaches `folder`, and it is not created, where the block raises. Into a device or pipe
    of a file's name it is written. UsageError where `folder` cannot be made or written, or its disk
    is full.
    """
    parent = folder
    while not parent.exists():
        parent = parent.parent
    try:
        staging = Path(tempfile.mkdtemp(prefix=".quiesce-", dir=parent))
    except OSError as error:
        raise UsageError(f"cannot write to {folder}: {error.strerror}; choose another --out")
    try:
        yield staging
        folder.mkdir(parents=True, exist_ok=True)
        for file in staging.iterdir():
            _put(file, folder / file.name)
    except OSError as error:
        if error.errno not in FULL:
            raise
        raise UsageError(f"cannot write {folder / _newest(staging)}: {error.strerror}")
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def _put(file: Path, place: Path) -> None:
    """A device or a pipe takes what is written and stays what it is; a folder keeps what it has."""
    if file.is_dir() and place.is_dir():
        for inner in file.iterdir():
            _put(inner, place / inner.name)
    elif place.exists() and not place.is_file():
        place.write_bytes(file.read_bytes())
    else:
        file.replace(place)


def _newest(staging: Path) -> str:
    """Name of the file that was being written; empty where there is none yet."""
    files = sorted(staging.iterdir(), key=lambda file: file.stat().st_mtime_ns)
    return files[-1].name if files else ""
