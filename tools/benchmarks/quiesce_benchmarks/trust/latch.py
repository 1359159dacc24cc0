"""A latched fault under a controller that is killed, on a full disk, and on a read-only one."""

import json
import subprocess
import sys

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import root

PROGRAM = "tests/python/linux/latch_kills.py"
QUICK_EVERY = 20  # system calls


def measure(quick: bool) -> dict[str, float]:
    """latch_kills: at each system call once. latch_lost: latches that it had told of and that the
    next start does not find, whatever took them. BenchFailure where no small disk can be mounted.
    """
    command = [sys.executable, str(root() / PROGRAM), "--every", str(QUICK_EVERY if quick else 1)]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
        raise BenchFailure(f"latch_kills.py ended with {done.returncode}: {last}")
    found = json.loads(done.stdout)
    if "latch_read_only_lost" not in found:
        raise BenchFailure("a small disk can be mounted by root only")
    lost = ("latch_lost", "latch_full_lost", "latch_read_only_lost")
    refused = ("latch_full_refused", "latch_read_only_refused")
    return {
        "latch_kills": found["latch_kills"],
        "latch_told": found["latch_told"],
        "latch_lost": sum(found[name] for name in lost),
        "latch_starts_not_refused": sum(not found[name] for name in refused),
    }
