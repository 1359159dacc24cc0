"""The same words from the host and from the image, whatever the board, the law and the inputs."""

import sys
import tempfile
from pathlib import Path

import numpy as np
from quiesce.engine.bench import Bench
from quiesce.engine.trace import read_trace

from quiesce_benchmarks.controller.instructions import largest_image
from quiesce_benchmarks.controller.rigs import random_board, random_counts, write_rig

LAWS = ("off", "constant", "fuzzy", "fuzzy_selftune", "phase")
TICKS = 2000
SEED = 1


def mismatched_words(bench: Bench, boards: int) -> tuple[int, int]:
    """Words that differ, of how many: telemetry, report, picture and commands of each tick."""
    differing = compared = 0
    for number in range(boards):
        rng = np.random.default_rng([SEED, number])
        differing_here, compared_here = compare(bench, rng, LAWS[number % len(LAWS)])
        differing += differing_here
        compared += compared_here
    print(f"controller: {boards} boards, {compared} words, {differing} differ", file=sys.stderr)
    return differing, compared


def compare(bench: Bench, rng: np.random.Generator, law: str) -> tuple[int, int]:
    board = random_board(rng)
    counts = random_counts(rng, len(board.sensors), TICKS, lost=float(rng.choice([0.0, 0.01, 0.2])))
    with tempfile.TemporaryDirectory() as folder:
        rig = write_rig(Path(folder), board, counts)
        traces = []
        for name, target in (("host", []), ("mps2", ["--image", largest_image()])):
            trace = Path(folder) / f"{name}.bin"
            options = ["--law", law, "--trace", str(trace), "--target", name, *target]
            bench.call("replay", *rig, *options)
            traces.append(read_trace(trace))
    host, image = traces
    differing = sum(int(np.count_nonzero(host[name] != image[name])) for name in host)
    return differing, sum(values.size for values in host.values())
