"""Finds and calls the compiled bench, `quiesce_bench`, and the images that it drives in QEMU."""

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from quiesce.base.errors import EXIT_BAD_INPUT, BenchFailure, UsageError, one_line
from quiesce.base.paths import build_folder, how_to_build, shown

QEMU = "qemu-system-arm"
IMAGES = {"mps2": "quiesce_mps2_shm.elf", "mps2-uart": "quiesce_mps2_uart.elf"}
# With a board, which may have more than one sensor and damper.
BOARD_IMAGES = {"mps2": "quiesce_mps2_shm_8x4.elf", "mps2-uart": "quiesce_mps2_uart_8x4.elf"}
ECHO_IMAGE = "uart_echo.elf"
LIVE_IMAGE = "quiesce_mps2_live.elf"


def require_file(path: Path, what: str) -> Path:
    if not path.is_file():
        raise UsageError(f"{what} {shown(path)} is not built; {how_to_build()}")
    return path


def image(target: str, has_board: bool = False) -> Path:
    """The image that runs on an emulated target."""
    name = (BOARD_IMAGES if has_board else IMAGES)[target]
    return require_file(build_folder() / "mps2/targets/mps2" / name, "the image")


def echo_image() -> Path:
    return require_file(build_folder() / "mps2/targets/mps2" / ECHO_IMAGE, "the image")


def live_image() -> Path:
    """The image behind a rig in the computer. UsageError where it cannot run here."""
    require_emulator()
    return require_file(build_folder() / "mps2/targets/mps2" / LIVE_IMAGE, "the image")


def require_emulator() -> None:
    if shutil.which(QEMU) is None:
        raise UsageError(
            f"{QEMU} is not installed (Debian: apt-get install {QEMU}); "
            "install it, or use --target host"
        )


def target_options(target: str, more: Sequence[str] = (), has_board: bool = False) -> list[str]:
    """Options of the bench for a target. UsageError where it cannot run here.

    more: further ones, the target's own. has_board: what runs there has one.
    """
    own = ["--target", target, *more]
    if target not in IMAGES:
        return own
    require_emulator()
    return [*own, "--image", str(image(target, has_board))]


def bench_file() -> Path:
    return require_file(build_folder() / "host/sim_hil/quiesce_bench", "the bench")


def become_bench() -> NoReturn:
    """`quiesce_bench` of an installed package: the executable with the same arguments."""
    try:
        program = str(bench_file())
    except UsageError as error:
        sys.exit(f"quiesce_bench: {error}")
    os.execv(program, [program, *sys.argv[1:]])


class Bench:
    """The executable. Calls may come from several threads; stop() ends those under way."""

    def __init__(self) -> None:
        self.executable = bench_file()
        self._lock = threading.Lock()
        self._running: set[subprocess.Popen[str]] = set()

    def call(self, command: str, *options: str) -> str:
        """Runs one command and returns what it printed.

        UsageError with the bench's own line where it refuses its input, BenchFailure where it
        dies.
        """
        process = subprocess.Popen(
            [str(self.executable), command, *options],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        with self._lock:
            self._running.add(process)
        try:
            out, err = process.communicate()
        finally:
            with self._lock:
                self._running.discard(process)
        if process.returncode == EXIT_BAD_INPUT:
            raise UsageError(one_line(err).removeprefix("quiesce_bench: "))
        if process.returncode != 0:
            raise BenchFailure(
                f"quiesce_bench {command} ended with {ending(process.returncode)}: "
                f"{one_line(err) or 'it said nothing'}"
            )
        return out

    def json(self, command: str, *options: str) -> Any:
        return json.loads(self.call(command, *options))

    def stop(self) -> None:
        """Ends every call under way."""
        with self._lock:
            for process in self._running:
                process.terminate()


def ending(returncode: int) -> str:
    if returncode < 0:
        return f"signal {signal.Signals(-returncode).name}"
    return f"exit code {returncode}"


def setting_options(settings: Sequence[str]) -> list[str]:
    return [word for setting in settings for word in ("--set", setting)]
