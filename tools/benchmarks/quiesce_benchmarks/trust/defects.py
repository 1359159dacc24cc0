"""The defects that probing found, and whether the tests that answer them pass."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import BenchFailure

from quiesce_benchmarks.trust.named_tests import parts

TABLE = Path(__file__).with_name("defects.toml")
LONGEST_S = 600  # of one test; the longest takes half a minute


@dataclass(frozen=True)
class Part:
    """Of a defect; open where no test answers it."""

    number: int
    text: str
    tests: tuple[str, ...]


def load() -> list[Part]:
    rows = tomllib.loads(TABLE.read_text())["defect"]
    return [Part(row["number"], row["part"], tuple(row["tests"])) for row in rows]


def passes(command: list[str], folder: Path) -> tuple[bool, str]:
    """Whether a runner ends well and in time, and what it printed. What it started ends with it."""
    with subprocess.Popen(
        command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, text=True, start_new_session=True,
    ) as process:  # fmt: skip
        try:
            said, _ = process.communicate(timeout=LONGEST_S)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            said, _ = process.communicate()
        except BaseException:  # interrupted: its session would outlive this one
            os.killpg(process.pid, signal.SIGKILL)
            raise
        return process.returncode == 0, said


class Runner:
    """Runs named tests from the built trees, each program once."""

    def __init__(self, root: Path, build: Path) -> None:
        self._root = root
        self._build = build
        self._said: dict[Path, str] = {}

    def _program(self, file: str, stems: tuple[str, ...]) -> Path:
        folder = Path(file).parent
        for tree in ("host", "mps2"):
            for at in (folder, folder.parent):
                for stem in stems:
                    program = self._build / tree / at / stem
                    if program.is_file():
                        return program
        raise BenchFailure(f"{file}: its program is not built")

    def _unity(self, file: str, name: str) -> bool:
        stem = Path(file).stem
        # Of the image's blocks the program has the area in its name.
        long = stem.replace("test_", f"test_{Path(file).parent.name}_", 1)
        program = self._program(file, (stem, f"{stem}.elf", f"{long}.elf"))
        if program not in self._said:
            tree = self._build / program.relative_to(self._build).parts[0]
            command = ["ctest", "--test-dir", str(tree), "-V", "-R", f"^{program.stem}$"]
            self._said[program] = passes(command, self._root)[1]
        return f":{name}:PASS" in self._said[program]

    def _google(self, file: str, name: str) -> bool:
        program = self._program(file, ("test_quiesced",))
        with tempfile.TemporaryDirectory() as folder:
            found = Path(folder) / "found.json"
            words = [f"--gtest_filter=*{name}*", f"--gtest_output=json:{found}"]
            is_good, _ = passes([str(program), *words], self._root)
            return is_good and json.loads(found.read_text())["tests"] > 0

    def _python(self, file: str, name: str) -> bool:
        words = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "-n", "0", f"{file}::{name}"]
        return passes([sys.executable, *words], self._root)[0]

    def passes(self, test: str) -> bool:
        file, name = parts(test)
        run: dict[str, Callable[[str, str], bool]] = {
            ".c": self._unity,
            ".cpp": self._google,
            ".py": self._python,
        }
        return run[Path(file).suffix](file, name)


def measure(root: Path, build: Path) -> tuple[dict[str, float], list[str]]:
    """Figures, and a line for each part that is open: it has no test, or one that fails."""
    runner = Runner(root, build)
    rows = load()
    left = []
    for row in rows:
        failed = [test for test in row.tests if not runner.passes(test)]
        if failed or not row.tests:
            left.append(f"{row.number}: {row.text} ({', '.join(failed) or 'no test'})")
    return {"defects": len(rows), "defects_closed": len(rows) - len(left)}, left
