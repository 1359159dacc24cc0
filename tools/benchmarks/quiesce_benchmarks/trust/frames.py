"""Single frames of senders repeated, delayed, inserted and reordered: what they bring about."""

from quiesce_benchmarks.trust.programs import run_all

FOLDER, PROGRAM = "host/tests/unit/comm", "frame_abuse"
DONE, FOUND_ONE = 0, 1  # its exit codes
FRAMES, QUICK_FRAMES = 10**6, 50_000
# The streams of a part have seeds of their own, one after the other; a part has fewer than this.
SEEDS = 10**6


def measure(seed: int, quick: bool, jobs: int) -> dict[str, float]:
    """frames_with_effect: beyond one cycle of their message."""
    count = -(-(QUICK_FRAMES if quick else FRAMES) // jobs)
    calls = [(PROGRAM, (count, 1 + (seed + i) % 900 * SEEDS)) for i in range(jobs)]
    found = list(run_all(calls, jobs, FOLDER, (DONE, FOUND_ONE)))
    return {
        name: float(sum(one[name] for one in found))
        for name in ("frames_abused", "frames_with_effect")
    }
