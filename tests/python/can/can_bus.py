"""A bus with a real controller on it: the firmware's node in a process of its own, SLCAN on a
pseudo-terminal that the tools open by a path that survives the controller's restart."""

import os
import signal
import subprocess
import sys
import tty
from collections.abc import Callable
from pathlib import Path

from conftest import ROOT


def build_peer(folder: Path) -> Path:
    """Compiles can_peer.c with the whole firmware, and what a board has for updates."""
    firmware, own = ROOT / "firmware", Path(__file__).parent
    of_boards = ["slots/slots.c", "image/image_place.c", "image/sha256.c"]
    files = [
        *sorted(firmware.rglob("*.c")), *(ROOT / "hal" / name for name in of_boards),
        ROOT / "targets/stm32f4/images.c", own / "image_peer.c", own / "can_peer.c",
    ]  # fmt: skip
    boards = ("include", "image", "slots", "stm32f4")
    folders = [
        *sorted({file.parent for file in firmware.rglob("*.h")}),
        *(ROOT / "hal" / name for name in boards), ROOT / "targets/stm32f4", own,
    ]  # fmt: skip
    exe = folder / "can_peer"
    options = ["-std=gnu11", "-O1", *(f"-I{one}" for one in folders), "-o", str(exe)]
    subprocess.run(["gcc", *options, *map(str, files), "-lm"], check=True)
    return exe


class Controller:
    """Starts and ends the controller; `bus` is what --bus takes."""

    def __init__(self, exe: Path, folder: Path) -> None:
        self.path = folder / "tty"
        self.bus = f"slcan:{self.path}"
        self._exe = exe
        self._slave = -1
        self._process: subprocess.Popen[bytes] | None = None

    def start(self, *options: str) -> None:
        master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(master, False)
        self.path.unlink(missing_ok=True)
        self.path.symlink_to(os.ttyname(self._slave))
        command = [str(self._exe), str(master), *options]
        self._process = subprocess.Popen(command, pass_fds=[master])
        os.close(master)

    def turn_enable(self) -> None:
        """The operator at the board gives the enable, or lets go."""
        assert self._process is not None
        self._process.send_signal(signal.SIGUSR1)

    def stop(self) -> None:
        """As if its cable were pulled."""
        if self._process is not None:
            self._process.send_signal(signal.SIGKILL)
            self._process.wait()
            os.close(self._slave)
            self._process = None


def start_quiesce(folder: Path, *arguments: str | Path) -> subprocess.Popen[str]:
    """`quiesce ARGUMENTS` under way, its output in pipes."""
    return subprocess.Popen(
        [sys.executable, "-u", "-m", "quiesce", *map(str, arguments)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT / "tools/src")},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def wait_line(stream: object, is_it: Callable[[str], bool]) -> str:
    """The first line that satisfies; fails where the stream ends before."""
    for line in stream:  # type: ignore[attr-defined]
        if is_it(line):
            return line
    raise AssertionError("the stream ended before the line came")
