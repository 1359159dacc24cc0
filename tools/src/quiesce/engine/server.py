"""The bench as a server: many runs in one process, for those who have thousands of short ones."""

import json
import subprocess
from collections.abc import Sequence
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.engine.bench import bench_file, ending

TAB = "\t"


class BenchServer:
    """One process; it ends with this one, however that ends. A call at a time."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [str(bench_file()), "serve"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            encoding="utf-8",
        )

    def run(self, words: Sequence[str]) -> dict[str, Any]:
        """What `quiesce_bench run WORDS` prints. UsageError with the bench's own line where it
        refuses, BenchFailure where it dies; this server is of no use then."""
        if any(TAB in word or "\n" in word for word in words):
            raise UsageError("a name with a tab or a line break in it: rename the file")
        assert self._process.stdin and self._process.stdout
        try:
            self._process.stdin.write(TAB.join(words) + "\n")
            self._process.stdin.flush()
            answer = self._process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if not answer.endswith("\n"):
            raise BenchFailure(f"quiesce_bench ended with {ending(self._process.wait())}")
        found: dict[str, Any] = json.loads(answer)
        if "refused" in found:
            raise UsageError(found["refused"])
        return found

    def close(self) -> None:
        self._process.kill()
        self._process.communicate()
