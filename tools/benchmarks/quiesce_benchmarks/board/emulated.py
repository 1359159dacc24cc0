"""Images of boards with an STM32F4 in QEMU's netduinoplus2, their console a pty."""

import re
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import build_folder
from quiesce.engine.bench import require_emulator, require_file

# The board's console is the machine's serial line of that number.
BOARDS = {"olimex_h405": (), "nucleo_f446re": ("-serial", "null")}


@dataclass(frozen=True)
class Machine:
    console: str  # a pty
    monitor: "subprocess.Popen[str]"

    def reset(self) -> None:
        assert self.monitor.stdin is not None
        self.monitor.stdin.write("system_reset\n")
        self.monitor.stdin.flush()


def image_of(name: str) -> Path:
    file = f"stm32f4/targets/stm32f4/quiesce_stm32f4_{name}.elf"
    return require_file(build_folder() / file, "the image")


@contextmanager
def running(image: Path, *options: str) -> Iterator[Machine]:
    """options: QEMU's, before the console."""
    require_emulator()
    qemu = subprocess.Popen(
        ["qemu-system-arm", "-M", "netduinoplus2", "-display", "none", *options]
        + ["-serial", "pty", "-monitor", "stdio", "-kernel", str(image)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert qemu.stdout is not None and qemu.stdin is not None
    try:
        for line in qemu.stdout:
            if found := re.search(r"redirected to (\S+)", line):
                yield Machine(found[1], qemu)
                return
        raise BenchFailure(f"{image.name}: QEMU has ended")
    finally:
        qemu.kill()
        qemu.wait()
        qemu.stdin.close()
        qemu.stdout.close()
