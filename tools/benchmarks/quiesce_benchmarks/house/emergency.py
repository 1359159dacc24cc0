"""How long the emergency stop of the command line takes while others hold every lock."""

import fcntl
import os
import select
import subprocess
import time
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from quiesce.base.errors import BenchFailure

LOCKS = ("setup", "build-host", "build-mps2", "build-m32", "build-sanitize")
# EmergencyStop's identifier as SLCAN writes a frame: t, three hexadecimal digits.
FRAME = b"t020"
PATIENCE_S = 120.0


@contextmanager
def all_locks(root: Path) -> Iterator[None]:
    """Held as a build in another window holds them."""
    (root / "build").mkdir(exist_ok=True)
    files = [(root / f"build/.{name}.lock").open("w") for name in LOCKS]
    try:
        for file in files:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError:
        raise BenchFailure("another command is building; stop_s is measured when it has ended")
    finally:
        for file in files:
            file.close()


def stop_s(root: Path) -> float:
    """From the command's start to its frame on the bus, with every lock taken. BenchFailure where
    none comes."""
    master, slave = os.openpty()
    tty.setraw(slave)
    command = [root / "tools/quiesce", "can", "stop", "--yes", "--timeout-s", "1"]
    command += ["--bus", f"slcan:{os.ttyname(slave)}"]
    with all_locks(root):
        start_s = time.monotonic()
        process = subprocess.Popen(
            [str(word) for word in command],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            seen_s = _frame_s(master, start_s + PATIENCE_S)
        finally:
            process.kill()
            process.wait()
            os.close(master)
            os.close(slave)
    if seen_s is None:
        raise BenchFailure(f"'quiesce can stop' sent no frame within {PATIENCE_S:g} s")
    return seen_s - start_s


def _frame_s(master: int, end_s: float) -> float | None:
    seen = b""
    while (left_s := end_s - time.monotonic()) > 0.0:
        ready, _, _ = select.select([master], [], [], left_s)
        if ready:
            seen += os.read(master, 4096)
        if FRAME in seen:
            return time.monotonic()
    return None
