"""One run of QEMU: starts it, listens to its console, ends it. It never outlives this process."""

import ctypes
import os
import signal
import socket
import subprocess
import threading
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

from quiesce.base.errors import BenchFailure, UsageError

from quiesce_vm import cpu_share
from quiesce_vm.limits import HANG_S
from quiesce_vm.qmp import Qmp, Qtest

EMULATOR = "qemu-system-aarch64"
TAIL_LINES = 15
_PR_SET_PDEATHSIG = 1


@dataclass(frozen=True)
class Boot:
    """What to boot."""

    kernel: Path
    initramfs: Path
    script: str  # in the guest's /vm
    serial_line: Path | None = None  # Unix socket that the guest's ttyAMA0 leads to
    arguments: list[str] = field(default_factory=list)


class Machine:
    """A running guest. Use it as a context: leaving ends QEMU."""

    def __init__(self, boot: Boot) -> None:
        self.lines: list[str] = []
        self._grown = threading.Condition()
        self._is_over = False
        self._qmp: Qmp | None = None
        share = cpu_share.wanted()
        ours, theirs = [], []
        for _ in range(2):
            pair = socket.socketpair()
            ours.append(pair[0])
            theirs.append(pair[1])
        self._process = _start(_command(boot, *(end.fileno() for end in theirs)), theirs)
        self._holder: cpu_share.Holder | None = None
        if share is not None:
            self._holder = cpu_share.Holder(self._process.pid, share, cpu_share.total)
        for end in theirs:
            end.close()
        self._qmp_socket, self._qtest_socket = ours
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def process_id(self) -> int:
        return self._process.pid

    @property
    def qmp(self) -> Qmp:
        if self._qmp is None:
            self._qmp = Qmp(self._qmp_socket)
        return self._qmp

    def gpio(self) -> Qtest:
        """The machine's GPIO chip (PL061), from outside."""
        return Qtest(self._qtest_socket, self.qmp.device("pl061"))

    def wait_line(self, start: str, timeout_s: float = HANG_S) -> str:
        """First console line that starts so, past or to come. BenchFailure where there is none."""

        def found() -> str | None:
            return next((line for line in self.lines if line.startswith(start)), None)

        with self._grown:
            self._grown.wait_for(lambda: self._is_over or found() is not None, timeout_s)
            line = found()
            is_over = self._is_over
        if line is None:
            why = "ended" if is_over else f"said nothing of the kind for {timeout_s:.0f} s"
            raise BenchFailure(f"the guest {why}, without a line {start!r}; {self.tail()}")
        return line

    def wait_end(self, timeout_s: float = HANG_S) -> list[str]:
        """All console lines, after the guest has switched itself off."""
        with self._grown:
            if not self._grown.wait_for(lambda: self._is_over, timeout_s):
                raise BenchFailure(
                    f"the guest hangs: not off after {timeout_s:.0f} s; {self.tail()}"
                )
        return list(self.lines)

    def tail(self) -> str:
        """The end of the console on one line, and the signal that ended QEMU, where one did."""
        lines = [line for line in self.lines if line][-TAIL_LINES:]
        console = "end of its console: " + (" | ".join(lines) if lines else "(it printed nothing)")
        code = self._wait() if self._is_over else 0
        return console if code >= 0 else f"QEMU was ended by signal {-code}; {console}"

    def close(self) -> None:
        self._process.kill()
        self._wait()
        self._reader.join()
        for end in (self._qmp_socket, self._qtest_socket):
            end.close()

    def _wait(self) -> int:
        """How QEMU ended. Its number is its own until it is waited for: the holder goes first."""
        if self._holder is not None:
            self._holder.release()
        return self._process.wait()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for raw in self._process.stdout:
            line = raw.decode(errors="replace").rstrip("\r\n")
            with self._grown:
                self.lines.append(line)
                self._grown.notify_all()
        self._process.stdout.close()
        with self._grown:
            self._is_over = True
            self._grown.notify_all()


def _start(command: list[str], sockets: list[socket.socket]) -> subprocess.Popen[bytes]:
    libc = ctypes.CDLL(None)
    parent = os.getpid()

    def die_with_parent() -> None:
        libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)

    try:
        return subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            pass_fds=[end.fileno() for end in sockets],
            preexec_fn=die_with_parent,
            # Of its own: a group that loses its leader while one in it is stopped is hung up.
            process_group=0,
        )
    except FileNotFoundError:
        raise UsageError(f"{EMULATOR} is missing: install Debian's qemu-system-arm")


def _command(boot: Boot, qmp_fd: int, qtest_fd: int) -> list[str]:
    # KVM is never asked for: where it cannot run this guest it does not say so, it hangs.
    command = [EMULATOR, "-M", "virt", "-cpu", "cortex-a53", "-smp", "1", "-m", "256"]
    command += ["-accel", "tcg", "-display", "none", "-monitor", "none", "-no-reboot"]
    # Virtual time that follows the instructions, 2 ns each, and skips idleness: how fast this
    # machine is, and what else it does, does not show in it.
    command += ["-icount", "shift=1,sleep=off", "-seed", "1"]
    command += ["-rtc", "clock=vm,base=2026-01-01T00:00:00"]
    command += ["-nodefaults", "-nic", "none", *_serial(boot)]
    command += ["-chardev", f"socket,id=qmp,fd={qmp_fd}", "-mon", "chardev=qmp,mode=control"]
    command += [
        "-chardev",
        f"socket,id=qtest,fd={qtest_fd}",
        "-qtest",
        "chardev:qtest",
        "-qtest-log",
        "none",
    ]
    command += ["-kernel", str(boot.kernel), "-initrd", str(boot.initramfs)]
    # loglevel: a kernel message never tears a line of ours apart; a panic is still told.
    console = "ttyAMA0" if boot.serial_line is None else "ttyS0"
    kernel = f"console={console} loglevel=1 panic=-1 nokaslr vm={boot.script}"
    return [*command, "-append", kernel, *boot.arguments]


def _serial(boot: Boot) -> list[str]:
    """The console; where the board's own UART is wanted for CAN, on a UART of PCI."""
    if boot.serial_line is None:
        return ["-serial", "stdio"]
    line = f"socket,id=line,path={boot.serial_line},server=on,wait=off"
    options = ["-chardev", line, "-serial", "chardev:line"]
    return [*options, "-chardev", "stdio,id=console", "-device", "pci-serial,chardev=console"]
