"""Output files that appear complete or not at all."""

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from quiesce.base.errors import UsageError


@contextmanager
def output_files(folder: Path) -> Iterator[Path]:
    """Yields an empty folder to write into; at the end its files move into `folder`.

    Nothing reaches `folder`, and it is not created, where the block raises. UsageError where
    `folder` cannot be made or written.
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
            file.replace(folder / file.name)
    finally:
        shutil.rmtree(staging, ignore_errors=True)
