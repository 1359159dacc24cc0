"""Runs the programs of this machine that abuse a controller, several at a time."""

import json
import subprocess
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import build_folder
from quiesce.engine.bench import ending, require_file

FOLDER = "host/tools/benchmarks/host/trust"


def run(
    program: str, words: Sequence[object], folder: str = FOLDER, good: tuple[int, ...] = (0,)
) -> dict[str, Any]:
    """The JSON object that it prints. BenchFailure where its exit code is none of the good ones."""
    file = require_file(build_folder() / folder / program, "the program")
    command = [str(file), *map(str, words)]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode not in good or not done.stdout:
        said = f": {done.stderr.strip()}" if done.stderr.strip() else ""
        raise BenchFailure(
            f"{' '.join([program, *command[1:]])} ended with {ending(done.returncode)}{said}"
        )
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def run_all(
    calls: Sequence[tuple[str, Sequence[object]]],
    jobs: int,
    folder: str = FOLDER,
    good: tuple[int, ...] = (0,),
) -> Iterator[dict[str, Any]]:
    """In the order of the calls."""
    with ThreadPoolExecutor(jobs) as pool:
        yield from pool.map(lambda call: run(*call, folder, good), calls)
