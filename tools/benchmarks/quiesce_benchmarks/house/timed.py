"""Commands as a person starts them: processor time of the whole tree, wall time, exit code."""

import os
import resource
import subprocess
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Timed:
    cpu_s: float  # user and system, with all children that ended
    wall_s: float
    code: int
    output: str  # both streams

    @property
    def last_line(self) -> str:
        lines = self.output.strip().splitlines()
        return lines[-1] if lines else "it said nothing"


def run_timed(
    command: Sequence[str | Path], folder: Path, env: Mapping[str, str] | None = None
) -> Timed:
    """Runs it to its end. Children of this process must not end meanwhile."""
    before, start_s = _children_cpu_s(), time.monotonic()
    done = subprocess.run(
        [str(word) for word in command],
        cwd=folder,
        env={**os.environ, **(env or {})},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
    )
    wall_s = time.monotonic() - start_s
    return Timed(_children_cpu_s() - before, wall_s, done.returncode, done.stdout)


def _children_cpu_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
