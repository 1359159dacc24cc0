"""What a new user waits for: the two commands of the README in a fresh clone."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import root

from quiesce_benchmarks.house.timed import Timed, run_timed

TOUCHED = "firmware/sense/rms.c"


@contextmanager
def fresh_clone(parent: Path | None = None) -> Iterator[Path]:
    """A clone of the last commit, with a space in its name and a compiler cache of its own."""
    with TemporaryDirectory(dir=parent, prefix="quiesce-") as folder:
        clone = Path(folder) / "a clone"
        command = ["git", "clone", "--quiet", str(root()), str(clone)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise BenchFailure(f"git clone: {done.stderr.strip()}")
        yield clone


def told(done: Timed, what: str) -> Timed:
    """As it is; BenchFailure where the command failed."""
    print(f"      {what}: {done.wall_s:.0f} s, {done.cpu_s:.0f} s of CPU", file=sys.stderr)
    if done.code != 0:
        raise BenchFailure(f"{what} ended with {done.code}: {done.last_line}")
    return done


def fresh_figures() -> dict[str, float]:
    """hil_fresh_cpu_s: set-up and build included, nothing in the compiler cache; test_fresh_s: of
    another clone, likewise; test_warm_s: once more; edit_s: after a line in firmware/sense."""
    values: dict[str, float] = {}
    with fresh_clone() as clone:
        cache = {"CCACHE_DIR": str(clone.parent / "cache")}
        hil = told(run_timed(["./tools/hil"], clone, cache), "hil in a fresh clone")
        values["hil_fresh_cpu_s"] = hil.cpu_s
    with fresh_clone() as clone:
        cache = {"CCACHE_DIR": str(clone.parent / "cache")}
        test = told(run_timed(["./tools/test"], clone, cache), "test in a fresh clone")
        values["test_fresh_s"] = test.wall_s
        values["test_warm_s"] = told(run_timed(["./tools/test"], clone, cache), "test").wall_s
        file = clone / TOUCHED
        file.write_text(file.read_text() + "\n// A line more.\n")
        edit = run_timed(["./tools/test", "edit"], clone, cache)
        values["edit_s"] = told(edit, "test edit").wall_s
    return values
