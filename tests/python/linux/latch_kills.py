"""Kills the controller program at its system calls while it enters a latched fault, fills its disk
and takes its right to write: no latch that it has told of may be lost. Prints one line of JSON.

    python tests/python/linux/latch_kills.py [--every N]
"""

import argparse
import contextlib
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from quiesced_peer import Quiesced, on_a_pty  # noqa: E402
from quiesced_steps import FAULT  # noqa: E402

TICKS = 60  # the stop comes with the fifth demand frame
ROOM = "256k"  # of the small disk


def build_killer(folder: Path) -> Path:
    program = folder / "killer"
    source = Path(__file__).with_name("killer.c")
    subprocess.run(["cc", "-O1", "-o", program, source], check=True)
    return program


def is_latched(quiesced: Quiesced) -> bool:
    """As the next start will find it."""
    check = quiesced.run("--check")
    assert check.returncode == 0, check.stdout + check.stderr
    return "not acknowledged yet" in check.stdout


def has_told(quiesced: Quiesced, after: int) -> bool:
    quiesced.peer.catch_up()
    frames = quiesced.peer.frames[after:]
    return any(f.name == "CurrentDemand" and f.signals["state"] == FAULT for f in frames)


def run_killed(quiesced: Quiesced, killer: Path, call: int) -> int:
    """Number of system calls up to the end."""
    count = quiesced.folder / "count"
    command = [killer, str(call), count, quiesced.program, "--config", quiesced.config]
    with open(quiesced.folder / "stderr", "ab") as log:
        subprocess.run([*command, "--ticks", str(TICKS)], stderr=log, stdin=subprocess.DEVNULL)
    return int(count.read_text())


def kill_everywhere(quiesced: Quiesced, killer: Path, every: int) -> dict[str, int]:
    """A first start each time, which makes its folder and reserves its room."""
    quiesced.peer.estop = True
    figures = {"latch_calls": run_killed(quiesced, killer, 0), "latch_kills": 0}
    assert is_latched(quiesced)
    figures |= {"latch_told": 0, "latch_lost": 0}
    for call in range(1, figures["latch_calls"] + 1, every):
        shutil.rmtree(quiesced.state, ignore_errors=True)
        after = quiesced.peer.catch_up()
        run_killed(quiesced, killer, call)
        is_kept = is_latched(quiesced)  # waits for the caretaker
        told = has_told(quiesced, after)
        figures["latch_kills"] += 1
        figures["latch_told"] += told
        figures["latch_lost"] += told and not is_kept
    quiesced.peer.estop = False
    return figures


@contextlib.contextmanager
def small_disk(folder: Path) -> Iterator[bool]:
    """False where only root may mount one."""
    folder.mkdir(parents=True, exist_ok=True)
    mount = ["mount", "-t", "tmpfs", "-o", f"size={ROOM}", "none", folder]
    is_mounted = subprocess.run(mount, capture_output=True).returncode == 0
    try:
        yield is_mounted
    finally:
        if is_mounted:
            subprocess.run(["umount", "-l", folder], check=True)


def fill(folder: Path) -> None:
    with contextlib.suppress(OSError), open(folder / "filler", "wb", buffering=0) as file:
        while True:
            file.write(b"x" * 1024)


def is_refused(quiesced: Quiesced) -> bool:
    result = quiesced.run("--ticks", "1")
    return (result.returncode, result.stderr.count("\n")) == (2, 1)


def fill_the_disk(quiesced: Quiesced) -> dict[str, int]:
    """A start without room is refused; with the room reserved nothing is lost."""
    with small_disk(quiesced.state) as is_mounted:
        if not is_mounted:
            return {}
        fill(quiesced.state)
        refused = is_refused(quiesced)
        (quiesced.state / "filler").unlink()
        quiesced.start()
        fill(quiesced.state)
        after = quiesced.peer.count()
        quiesced.peer.estop = True
        quiesced.peer.wait_state(FAULT, after)
        quiesced.peer.estop = False
        assert quiesced.stop() == 0
        return {"latch_full_lost": int(not is_latched(quiesced)), "latch_full_refused": refused}


def forbid_to_write(quiesced: Quiesced) -> dict[str, int]:
    """A latch on a disk that has become read-only stays, and no start goes on without one."""
    with small_disk(quiesced.state) as is_mounted:
        if not is_mounted:
            return {}
        quiesced.start()
        after = quiesced.peer.count()
        quiesced.peer.estop = True
        quiesced.peer.wait_state(FAULT, after)
        quiesced.peer.estop = False
        assert quiesced.stop() == 0
        subprocess.run(["mount", "-o", "remount,ro", quiesced.state], check=True)
        return {
            "latch_read_only_lost": int(not is_latched(quiesced)),
            "latch_read_only_refused": is_refused(quiesced),
        }


def measure(folder: Path, every: int) -> dict[str, int]:
    killer = build_killer(folder)
    with on_a_pty(folder) as quiesced:
        figures = kill_everywhere(quiesced, killer, every)
        shutil.rmtree(quiesced.state, ignore_errors=True)
        figures |= fill_the_disk(quiesced)
        figures |= forbid_to_write(quiesced)
    return figures


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--every", type=int, default=1, help="of the system calls (1: all)")
    every = parser.parse_args().every
    with tempfile.TemporaryDirectory() as folder:
        print(json.dumps(measure(Path(folder), every)))


if __name__ == "__main__":
    main()
