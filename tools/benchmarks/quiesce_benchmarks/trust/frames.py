"""Single frames of senders repeated, delayed, inserted and reordered: what they bring about."""

import json
import subprocess
from concurrent.futures import ThreadPoolExecutor

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import build_folder
from quiesce.engine.bench import require_file

PROGRAM = "host/tests/unit/comm/frame_abuse"
FRAMES, QUICK_FRAMES = 10**6, 50_000
# The streams of a part have seeds of their own, one after the other; a part has fewer than this.
SEEDS = 10**6


def measure(seed: int, quick: bool, jobs: int) -> dict[str, float]:
    """frames_with_effect: beyond one cycle of their message."""
    program = require_file(build_folder() / PROGRAM, "the program")
    count = -(-(QUICK_FRAMES if quick else FRAMES) // jobs)
    calls = [(count, 1 + (seed + i) % 900 * SEEDS) for i in range(jobs)]

    def run(call: tuple[int, int]) -> dict[str, int]:
        command = [str(program), *map(str, call)]
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
        if done.returncode not in (0, 1) or not done.stdout:
            raise BenchFailure(f"frame_abuse ended with {done.returncode}: {done.stderr.strip()}")
        found: dict[str, int] = json.loads(done.stdout)
        return found

    with ThreadPoolExecutor(jobs) as pool:
        found = list(pool.map(run, calls))
    return {
        name: float(sum(one[name] for one in found))
        for name in ("frames_abused", "frames_with_effect")
    }
