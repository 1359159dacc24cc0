"""Commands that need nothing compiled start at once: no build, no lock, whatever else runs."""

import fcntl
import os
import pty
import re
import resource
import select
import shutil
import signal
import subprocess
import time
import tty
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from quiesce.can.database import load
from quiesce.cli.main import COMMANDS

ROOT = Path(__file__).resolve().parents[3]
LOCKS = ("setup", "build-host", "build-mps2")
RULES = ROOT / "tools/benchmarks/rules/reference_singleton.fcl"


class Clone:
    """The scripts and a complete environment in a folder of their own; no build."""

    def __init__(self, root: Path) -> None:
        self.root = root
        shutil.copytree(ROOT / "tools/lib", root / "tools/lib")
        for name in "benchmark hil quiesce setup packages.txt requirements.txt".split():
            shutil.copy(ROOT / "tools" / name, root / "tools" / name)
        (root / "build").mkdir()
        (root / ".venv/bin").mkdir(parents=True)
        (root / ".venv/bin/python").symlink_to(ROOT / ".venv/bin/python")
        (root / ".venv/lib").symlink_to(ROOT / ".venv/lib")
        shutil.copy(ROOT / ".venv/pyvenv.cfg", root / ".venv")
        self.bash("python_stamp >.venv/.complete")

    def bash(self, code: str) -> str:
        """What `code` prints, with the scripts' functions."""
        sources = "PROGRAM=here; source tools/lib/common.sh; source tools/lib/launch.sh"
        return subprocess.run(
            ["bash", "-c", f"{sources}; {code}"],
            cwd=self.root, check=True, capture_output=True, text=True, timeout=60,
        ).stdout  # fmt: skip

    def start(self, script: str, *words: str | Path) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [self.root / "tools" / script, *words],
            cwd=self.root,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )


def end(process: subprocess.Popen[str]) -> None:
    """With the scripts that it called."""
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()


@pytest.fixture
def clone(tmp_path: Path) -> Clone:
    return Clone(tmp_path / "a clone")


@pytest.fixture
def busy(clone: Clone) -> Iterator[Clone]:
    """Another process holds every lock."""
    with ExitStack() as held:
        for name in LOCKS:
            file = held.enter_context((clone.root / f"build/.{name}.lock").open("w"))
            fcntl.flock(file, fcntl.LOCK_EX)
        yield clone


@pytest.mark.parametrize(
    ("words", "needs"),
    [
        ("", ""),
        ("--version", ""),
        ("hil", "bench images"),
        ("hil --quick --target host", "bench"),
        ("hil --target=linux --quick", "bench linux"),
        ("replay x.csv", "bench"),
        ("replay x.csv --target mps2", "bench images"),
        ("record", "bench"),
        ("board check x.toml", "bench"),
        ("plant check x.toml", "bench"),
        ("params", "bench"),
        ("chain", "bench"),
        ("rules compile x.fcl", ""),
        ("rules convert x.fcl", ""),
        ("compare x", "bench"),
        ("campaign x", "bench"),
        ("law list", ""),
        ("table show x.table", ""),
        ("table diff a.table b.table", ""),
        ("table stamp x.table --board b.toml", "bench"),
        ("table check x.table", "bench"),
        ("law make skyhook", "bench"),
        ("law rules x.fis", "bench"),
        ("law fit x.csv", "bench"),
        ("compare --rig x --clairvoyant", "bench plant"),
        ("tune law skyhook", "bench"),
        ("rules show x.fcl", "bench"),
        ("sweep", "bench plant"),
        ("identify x.csv", "dampers"),
        ("identify plan", ""),
        ("tune x.toml", "bench plant dampers"),
        ("can stop --yes", ""),
        ("can get", ""),
        ("live --bus socketcan:can0", "page"),
        ("live --sim", "bench page"),
        ("live --sim --target mps2", "bench page images"),
        ("live --sim plant.toml --target=linux", "bench page linux"),
        ("live --bus socketcan:can0 --commission press", "bench plant dampers page"),
        ("live --sim --commission first", "bench plant dampers page"),
    ],
)
def test_needs(clone: Clone, words: str, needs: str) -> None:
    assert clone.bash(f"needs_of {words}").strip() == needs


@pytest.mark.parametrize(
    ("words", "needs"),
    [
        ([], "bench images"),
        (["--quick", "--target", "linux"], "bench linux"),
        (["--target=host"], "bench"),
    ],
)
def test_hil_builds_what_its_target_needs(clone: Clone, words: list[str], needs: str) -> None:
    with (clone.root / "tools/lib/needs.sh").open("a") as script:
        script.write('needs_build() { echo "$*"; exit 3; }\n')
    (clone.root / "tools/setup").write_text("#!/bin/sh\n")
    process = clone.start("hil", *words)
    assert finished(process)[0] == f"{needs}\n"
    assert process.returncode == 3


def test_every_command_is_in_the_table() -> None:
    table = (ROOT / "tools/lib/needs.sh").read_text()
    assert set(re.findall(r'"(\w+) (?:\w+)?"', table)) == {name for name, _, _ in COMMANDS}


def finished(process: subprocess.Popen[str]) -> tuple[str, str]:
    try:
        return process.communicate(timeout=60)
    finally:
        process.kill()


@pytest.mark.parametrize(
    ("script", "words", "said"),
    [
        ("quiesce", ["--version"], "quiesce 0."),
        ("quiesce", ["--help"], "usage: quiesce"),
        ("hil", ["--help"], "usage: quiesce hil"),
        ("quiesce", ["tune", "--help"], "usage: quiesce tune"),
        ("quiesce", ["can", "list"], "slcan"),
        ("quiesce", ["identify", "plan", "--help"], "usage: quiesce identify plan"),
        ("quiesce", ["rules", "convert", RULES, "--to", "fll"], "RuleBlock"),
        ("setup", ["python"], ""),
    ],
)
def test_starts_while_others_build(busy: Clone, script: str, words: list, said: str) -> None:
    process = busy.start(script, *words)
    out, err = finished(process)
    assert process.returncode == 0, err
    assert said in out
    assert err == ""


def test_who_needs_a_build_waits_for_it(busy: Clone) -> None:
    process = busy.start("quiesce", "params")
    assert "waiting for another command" in process.stderr.readline()
    assert process.poll() is None
    end(process)


def frame_of(line: int, id_hex: str, until_s: float) -> bool:
    """Whether the frame appears in time."""
    seen = b""
    while (left_s := until_s - time.monotonic()) > 0.0:
        if select.select([line], [], [], left_s)[0]:
            seen += os.read(line, 4096)
        if f"\rt{id_hex}".encode() in seen:
            return True
    return False


@pytest.mark.parametrize("newer", [False, True], ids=["", "newer requirements"])
def test_stop_waits_for_nothing(busy: Clone, newer: bool) -> None:
    if newer:
        with (busy.root / "tools/requirements.txt").open("a") as file:
            file.write("another==1.0\n")
    master, slave = pty.openpty()
    tty.setraw(slave)
    stop = busy.start(
        "quiesce", "can", "stop", "--yes", "--timeout-s", "0.1", "--bus",
        f"slcan:{os.ttyname(slave)}",
    )  # fmt: skip
    frame_id = load().by_name["EmergencyStop"].frame_id
    assert frame_of(master, f"{frame_id:03X}", time.monotonic() + 60.0)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert "NOT CONFIRMED" in finished(stop)[1]
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    # Processor time, whatever else the machine does; the launcher's is in it.
    assert used.ru_utime + used.ru_stime - before.ru_utime - before.ru_stime < 1.0
    os.close(master)
    os.close(slave)


def test_stop_sets_up_what_never_was(busy: Clone) -> None:
    (busy.root / ".venv/.complete").unlink()
    process = busy.start("quiesce", "can", "stop", "--yes", "--bus", "slcan:/dev/null")
    assert "waiting for another command" in process.stderr.readline()
    end(process)
