"""`quiesce live` beside a real controller: the firmware's node on a pty, or on UDP multicast."""

import os
import random
import signal
import subprocess
import sys
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.request import Request, urlopen

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.base.paths import build_folder, root, shown
from websockets.sync.client import ClientConnection, connect

GROUP = "239.74.163.2"
PATIENCE_S = 60.0  # for events on a machine with other work; nothing is judged by it


def python(*words: str | Path, folder: Path | None = None) -> subprocess.Popen[str]:
    """This Python with the package, its output in pipes."""
    return subprocess.Popen(
        [sys.executable, "-u", *map(str, words)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(root() / "tools/src")},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def line_of(process: subprocess.Popen[str], start: str) -> str:
    """The first line that begins so. BenchFailure, with what was said, where it ends before."""
    assert process.stdout is not None and process.stderr is not None
    for line in process.stdout:
        if line.startswith(start):
            return line
    raise BenchFailure(process.stderr.read().strip() or "it ended without a word")


def close(process: subprocess.Popen[str]) -> int:
    """Waits for its end."""
    code = process.wait(PATIENCE_S)
    for stream in (process.stdout, process.stderr):
        if stream is not None:
            stream.close()
    return code


def node_program() -> Path:
    """UsageError where it is not built."""
    program = build_folder() / "host/tools/benchmarks/host/live_node"
    if not program.exists():
        raise UsageError(f"{shown(program)} is not built; run ./tools/benchmark live")
    return program


@contextmanager
def on_network(folder: Path, *options: str) -> Iterator[tuple["Node", "Network", "Page"]]:
    """A controller at work on UDP multicast, and its page."""
    node = Node(node_program(), folder)
    node.start()
    network = Network(node.line)
    page = Page(folder, *network.options, *options)
    try:
        yield node, network, page
    finally:
        page.end()
        network.end()
        node.stop()


class Node:
    """The controller: armed by itself, at 1 kHz; its line has one path over its restarts."""

    def __init__(self, program: Path, folder: Path) -> None:
        self.line = folder / "tty"
        self.bus = f"slcan:{self.line}"
        self._program = program
        self._slave = -1
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(master, False)
        self.line.unlink(missing_ok=True)
        self.line.symlink_to(os.ttyname(self._slave))
        self._process = subprocess.Popen([self._program, str(master)], pass_fds=[master])
        os.close(master)

    def stop(self) -> None:
        """As if its cable were pulled. The name goes, too: the line's number may be another's at
        once."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            os.close(self._slave)
            self.line.unlink()
            self._process = None


class Network:
    """A line on UDP multicast; `options` are what names that bus."""

    def __init__(self, line: Path) -> None:
        self.port = random.SystemRandom().randint(20000, 60000)
        self.options = ("--bus", f"udp_multicast:{GROUP}", "--bus-option", f"port={self.port}")
        self._line = line
        self.start()

    def start(self) -> None:
        """Again, after the line was another one."""
        program = Path(__file__).with_name("bus_bridge.py")
        self._process = python(program, self._line, GROUP, str(self.port))
        line_of(self._process, "ready")

    def listen(self) -> Any:
        """Another one on that bus."""
        from quiesce.can.python_can import can

        return can.Bus(interface="udp_multicast", channel=GROUP, port=self.port, fd=False)

    def end(self) -> None:
        self._process.kill()
        close(self._process)


class Page:
    """A running `quiesce live`."""

    def __init__(self, folder: Path, *options: str) -> None:
        words = ("-m", "quiesce", "live", "--port", "0", *options)
        self.process = python(*words, folder=folder)
        line = line_of(self.process, "http://")
        self.address, _, self.token = line.split()[0].partition("#token=")
        self.port = int(self.address.rstrip("/").rpartition(":")[2])

    @contextmanager
    def viewer(self, **options: Any) -> Iterator[ClientConnection]:
        """One with the token, where one is needed."""
        headers = {"Authorization": f"Bearer {self.token}"} if self.token else {}
        with self.socket(additional_headers=headers, **options) as socket:
            yield socket

    def socket(self, **options: Any) -> ClientConnection:
        patient = {"open_timeout": PATIENCE_S, **options}
        return connect(f"ws://127.0.0.1:{self.port}/socket", **patient)

    def post(self, path: str, body: bytes = b"", **headers: str) -> int:
        request = Request(f"http://127.0.0.1:{self.port}{path}", body, headers, method="POST")
        with urlopen(request, timeout=PATIENCE_S) as answer:
            return answer.status

    def end(self) -> int:
        """As Ctrl-C does; its exit code."""
        self.process.send_signal(signal.SIGINT)
        return close(self.process)
