"""Controllers to load tables into: the node as a program of this machine, the image in the emulator
with its memory in a file, the Linux controller. Each is started, killed and started again on one
line."""

import contextlib
import json
import os
import signal
import subprocess
import tomllib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.base.paths import build_folder
from quiesce.engine.bench import ending, require_file

from quiesce_benchmarks.tables.bus import Bus
from quiesce_benchmarks.tables.line import Line

START_TICKS = 20_000  # for the first frames
# Its own ticks are real time: with the right to, it goes before everything else here.
RUN_PRIORITY = 40
NICE = -10  # of the others


class Target:
    """A controller on a line; its records are in `folder`."""

    name: str
    patience_ticks = 30_000  # for an effect on a busy machine

    def __init__(self, folder: Path, bus: Bus | None = None) -> None:
        self.folder = folder
        self.line = Line(bus)
        self.line.patience_ticks = self.patience_ticks
        self._process: subprocess.Popen[bytes] | None = None

    def command(self) -> Sequence[str | Path]:
        raise NotImplementedError

    def start(self) -> None:
        """Until its first demands."""
        self.line.restarted()
        with open(self.folder / "log", "ab") as log:
            self._process = subprocess.Popen(
                list(self.command()),
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                process_group=0,
            )
        self.line.wait(self._has_begun, START_TICKS, f"first demands of {self.name}")

    def _has_begun(self) -> bool:
        assert self._process is not None
        if self._process.poll() is not None:
            last = ((self.folder / "log").read_text(errors="replace").strip() or "nothing").split(
                "\n"
            )
            raise BenchFailure(
                f"{self.name} ended with {ending(self._process.returncode)}: {last[-1]}"
            )
        return len(self.line.demands) >= 3

    def kill(self) -> None:
        """As a power cut does: it and all that it has started, at once."""
        process, self._process = self._process, None
        if process is not None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()

    def restart(self) -> None:
        self.kill()
        self.start()

    def signal(self, number: signal.Signals) -> None:
        assert self._process is not None
        self._process.send_signal(number)


class HostNode(Target):
    name = "host"

    def command(self) -> Sequence[str | Path]:
        program = build_folder() / "host/tools/benchmarks/host/tables/table_node"
        return (require_file(program, "the program"), self.line.target, self.folder)


class Mps2Node(Target):
    """An instruction takes 16 ns of the board's time, which does not run ahead of the clock: 2.5
    times its own at 25 MHz."""

    name = "mps2"
    icount = "shift=4,align=on"
    patience_ticks = 8000

    @property
    def memory(self) -> Path:
        return self.folder / "memory"

    def command(self) -> Sequence[str | Path]:
        image = build_folder() / "mps2/targets/mps2/quiesce_mps2_node.elf"
        backend = f"memory-backend-file,id=kept,share=on,size=16M,mem-path={self.memory}"
        return (
            "qemu-system-arm", "-object", backend, "-M", "mps2-an386,memory-backend=kept",
            "-display", "none", "-monitor", "none", "-icount", self.icount,
            "-serial", self.line.target, "-kernel", require_file(image, "the image"),
        )  # fmt: skip


class SlowMps2Node(Mps2Node):
    """4 ns: a tick takes four times as long, and a late sample is so much less late."""

    icount = "shift=2,align=on"


CONFIG = """[loop]
priority = {priority}
lock_memory = {locks}
[can]
interface = "slcan:{line}"
{wired}[operator]
enable = "can"
[state]
folder = "{folder}"
status_s = 1
[log]
to = "stderr"
"""


WIRED = """[accel]
source = "can"
[current]
output = "can"
"""


def has_priority() -> bool:
    return os.geteuid() == 0


class Quiesced(Target):
    name = "linux"

    def command(self) -> Sequence[str | Path]:
        program = build_folder() / "host/targets/linux/quiesced/quiesced"
        config = self.folder / "quiesced.toml"
        config.write_text(
            CONFIG.format(
                line=self.line.target,
                wired=self.wired(),
                folder=self.folder / "state",
                priority=RUN_PRIORITY if has_priority() else 0,
                locks=str(has_priority()).lower(),
            )
        )
        return (require_file(program, "the program"), "--config", config)

    def wired(self) -> str:
        """Of the configuration: where samples come from and currents go."""
        return WIRED

    def status(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads((self.folder / "state/state.json").read_text())
        return found


# Of a sensor whose samples come from a process of a machine with other work.
PATIENCE = "max_age_us = 1000000\nstuck_us = 0"


class QuiescedOnBoard(Quiesced):
    """With a board file's one accelerometer and one damper, and a law."""

    def __init__(self, board: Path, law: str, folder: Path, bus: Bus | None = None) -> None:
        super().__init__(folder, bus)
        self._board, self._law = board.read_text(encoding="utf-8"), law

    def wired(self) -> str:
        board = tomllib.loads(self._board)
        parts = [
            f'[[{kind}]]\nname = "{one["name"]}"\n{way} = "can"\n'
            for kind, way in (("sensor", "source"), ("damper", "output"))
            for one in board[kind]
        ]
        patient = self._board.replace("[[sensor]]", f"[[sensor]]\n{PATIENCE}", 1)
        (self.folder / "board.toml").write_text(patient, encoding="utf-8")
        head = '[board]\nfile = "board.toml"\n'
        return f'{head}{"".join(parts)}[parameters]\nlaw = "{self._law}"\n'


TARGETS: tuple[type[Target], ...] = (HostNode, Mps2Node, Quiesced)


@contextlib.contextmanager
def going_first() -> Iterator[None]:
    """Samples that the machine's other work holds up come in bursts, which a controller refuses:
    with the right to, what is started here goes before that work."""
    before = os.getpriority(os.PRIO_PROCESS, 0)
    with contextlib.suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, 0, min(before, NICE))
    try:
        yield
    finally:
        with contextlib.suppress(PermissionError):
            os.setpriority(os.PRIO_PROCESS, 0, before)


@contextlib.contextmanager
def running(
    kind: Callable[[Path, Bus | None], Target], folder: Path, bus: Bus | None = None
) -> Iterator[Target]:
    """Started with nothing kept, killed at the end. UsageError where it cannot be had."""
    folder.mkdir(parents=True)
    target = kind(folder, bus)
    with going_first(), target.line:
        try:
            target.start()
            yield target
        except FileNotFoundError as error:
            raise UsageError(f"{error.filename}: not installed")
        finally:
            target.kill()
