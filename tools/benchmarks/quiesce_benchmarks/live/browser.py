"""A browser on the page, in a process of its own (drive_page.py)."""

import json
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from shutil import which
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError

from quiesce_benchmarks.fuzzy.peers import BROWSER, PYTHON, built_peer

DRIVE = Path(__file__).with_name("drive_page.py")


class Browser:
    """do() is one line to the driver and its answer."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process
        self.answer()  # it is ready

    def do(self, *words: str | float | Path) -> Any:
        assert self._process.stdin is not None
        self._process.stdin.write(" ".join(map(str, words)) + "\n")
        self._process.stdin.flush()
        return self.answer()

    def answer(self) -> Any:
        assert self._process.stdout is not None and self._process.stderr is not None
        line = self._process.stdout.readline()
        if not line:
            raise BenchFailure(f"the browser ended: {self._process.stderr.read()[-800:]}")
        return json.loads(line)


@contextmanager
def opened(address: str, *options: str) -> Iterator[Browser]:
    """UsageError where the browser or what drives it cannot be had."""
    axe, chromium = built_peer(BROWSER), which("chromium")
    if chromium is None:
        raise UsageError("chromium is not installed; run ./tools/benchmarks/fetch_peers browser")
    command = [str(built_peer(PYTHON)), "-I", str(DRIVE), chromium, address, "--axe", str(axe)]
    pipes = {name: subprocess.PIPE for name in ("stdin", "stdout", "stderr")}
    process = subprocess.Popen([*command, *options], text=True, **pipes)
    try:
        yield Browser(process)
    finally:
        process.communicate()  # no more lines: it closes the browser and ends
