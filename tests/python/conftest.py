"""What the tests of the command line share. They build nothing: ./tools/test does that first.

QUIESCE_BUILD names another folder with the builds host/ and mps2/.
"""

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

Result = subprocess.CompletedProcess[str]

# What is started in the background ignores Ctrl-C, and so would every command that a test starts.
signal.signal(signal.SIGINT, signal.default_int_handler)


def require(path: Path) -> Path:
    if not path.exists():
        pytest.fail(f"{path} is not built; run ./tools/test (or ./tools/hil) first", pytrace=False)
    return path


@pytest.fixture(scope="session")
def build() -> Path:
    """Folder of the builds, with the bench in it."""
    folder = Path(os.environ.get("QUIESCE_BUILD", ROOT / "build")).resolve()
    require(folder / "host/sim_hil/quiesce_bench")
    return folder


@pytest.fixture(scope="session")
def image(build: Path) -> Path:
    """The image that runs in QEMU."""
    return require(build / "mps2/targets/mps2/quiesce_mps2_shm.elf")


def run_quiesce(folder: Path, *arguments: str | Path, **env: str) -> Result:
    """`./tools/quiesce ARGUMENTS` with `folder` as the current one, without its build."""
    module, words = "quiesce", list(map(str, arguments))
    if words[:1] == ["bench"]:
        module, words = "quiesce_benchmarks", words[1:]
    path = os.pathsep.join(str(ROOT / name) for name in ("tools/src", "tools/benchmarks"))
    return subprocess.run(
        [sys.executable, "-m", module, *words],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": path, **env},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=300,
    )


@pytest.fixture
def quiesce(tmp_path: Path, build: Path) -> Callable[..., Result]:
    """Runs the command line in an empty folder."""
    return lambda *arguments, **env: run_quiesce(tmp_path, *arguments, **env)


@pytest.fixture
def refused(quiesce, tmp_path: Path) -> Callable[..., str]:
    """Runs a command that must refuse its input: exit code 2, one line, nothing written."""

    def check(*arguments: str | Path, **env: str) -> str:
        before = sorted(tmp_path.rglob("*"))
        result = quiesce(*arguments, **env)
        assert result.returncode == 2, result.stdout + result.stderr
        assert result.stdout == ""
        assert len(result.stderr.splitlines()) == 1, result.stderr
        assert result.stderr.startswith(("quiesce: ", "benchmark: "))
        assert "Traceback" not in result.stderr
        assert sorted(tmp_path.rglob("*")) == before
        return result.stderr

    return check
