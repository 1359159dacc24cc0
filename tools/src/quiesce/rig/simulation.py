"""A rig in the computer: the bench's `live` in a process of its own, at the rate of the clock on
the wall. docs/reference/rig-protocol.md is what goes over its pipes.

It cannot outlive who started it: it ends when the pipe to it does, however that came about.
"""

import json
import math
import queue
import socket
import subprocess
import threading
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.can.buses import Bus
from quiesce.engine.bench import bench_file, ending

GROUP = "239.74.163.2"
START_S = 20.0
ANSWER_S = 10.0
END_S = 5.0
PREFIX = "quiesce_bench: "


def own_bus() -> Bus:
    """A bus on this computer alone, on a port that nobody has."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", 0))
        port = probe.getsockname()[1]
    options = (("port", port), ("hop_limit", 0), ("fd", False))
    return Bus("udp_multicast", GROUP, None, options)


def bus_words(bus: Bus) -> str:
    """What other commands are given to join it."""
    return f"--bus {bus.name} --bus-option port={dict(bus.options)['port']}"


class Simulation:
    """Started by entering it, ended by leaving. Calls may come from several threads."""

    def __init__(self, options: Sequence[str], bus: Bus) -> None:
        """options: of `quiesce_bench live`, without its bus."""
        self.bus = bus
        self.introduction: dict[str, Any] = {}
        self.state: dict[str, Any] = {}  # the newest
        self.summary: dict[str, Any] = {}  # once it has ended in order
        self._options = list(options)
        self._descriptors: tuple[int, ...] = ()  # that the bench is given
        self._answers: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()
        self._asking = threading.Lock()
        self._owed = 0  # answers; those of orders that were given up come late
        self._is_ready = threading.Event()
        self._has_state = threading.Condition()
        self._said: deque[str] = deque(maxlen=20)  # on stderr
        self._process: subprocess.Popen[str] | None = None

    def __enter__(self) -> "Simulation":
        channel = f"{self.bus.channel}:{dict(self.bus.options)['port']}"
        command = [str(bench_file()), "live", *self._options, "--bus", channel]
        pipes = {name: subprocess.PIPE for name in ("stdin", "stdout", "stderr")}
        # A session of its own: Ctrl-C is for who started it, and he ends it.
        self._process = subprocess.Popen(
            command,
            encoding="utf-8",
            errors="replace",
            bufsize=1,
            start_new_session=True,
            pass_fds=self._descriptors,
            **pipes,
        )
        self._started(self._process.pid)
        self._readers = [
            threading.Thread(target=one, daemon=True) for one in (self._hear, self._hear_errors)
        ]
        for reader in self._readers:
            reader.start()
        if not self._is_ready.wait(START_S) or not self.introduction:
            self._end()
            raise UsageError(self.failure or "the rig does not start: it says nothing")
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    @property
    def failure(self) -> str:
        """Why it is gone, on one line; empty while it is at work."""
        process = self._process
        if process is None or process.poll() is None or self.summary:
            return ""
        self._readers[-1].join(END_S)  # what it said last
        said = one_line(" ".join(self._said)).removeprefix(PREFIX)
        return said or f"the rig ended with {ending(process.returncode)}"

    def order(self, **what: Any) -> None:
        """All of it or nothing, from the next tick on. UsageError where it is not allowed,
        BenchFailure where the rig is gone."""
        with self._asking:
            self._write(line_of(what))
            self._owed += 1
            answer = self._last_answer()
        if answer is None:
            raise BenchFailure(self.failure or "the rig does not answer")
        if "refused" in answer:
            raise UsageError(answer["refused"])

    def _started(self, process_id: int) -> None:
        """The bench runs; it has said nothing yet."""

    def _last_answer(self) -> dict[str, Any] | None:
        """To what was ordered last; None where it does not come."""
        answer = None
        while self._owed:
            try:
                answer = self._answers.get(timeout=ANSWER_S)
            except queue.Empty:
                return None
            if answer is None:
                return None
            self._owed -= 1
        return answer

    def next_state(self, timeout_s: float = ANSWER_S) -> dict[str, Any]:
        """One that comes from now on: what was ordered before is in it. BenchFailure where none
        does."""
        with self._has_state:
            before = self.state
            if not self._has_state.wait_for(lambda: self.state is not before, timeout_s):
                raise BenchFailure(self.failure or "the rig says nothing")
            return self.state

    def _write(self, line: str) -> None:
        assert self._process is not None and self._process.stdin is not None
        try:
            self._process.stdin.write(line + "\n")
            self._process.stdin.flush()
        except (OSError, ValueError):
            raise BenchFailure(self.failure or "the rig is gone")

    def _hear(self) -> None:
        assert self._process is not None and self._process.stdout is not None
        for line in self._process.stdout:
            try:
                self._take(json.loads(line))
            except ValueError:
                self._said.append(f"it says {line!r:.200}, which is no JSON")
                self._process.kill()
        self._process.wait()
        self._is_ready.set()
        self._answers.put(None)

    def _take(self, said: dict[str, Any]) -> None:
        if "state" in said:
            with self._has_state:
                self.state = said["state"]
                self._has_state.notify_all()
        elif "ready" in said:
            self.introduction = said["ready"]
            self._is_ready.set()
        elif "end" in said:
            self.summary = said["end"]
        else:
            self._answers.put(said)

    def _hear_errors(self) -> None:
        assert self._process is not None and self._process.stderr is not None
        self._said.extend(self._process.stderr)

    def _end(self) -> None:
        process = self._process
        assert process is not None and process.stdin is not None
        try:
            process.stdin.close()
        except OSError:
            pass  # it is gone already
        try:
            process.wait(END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        for reader in self._readers:
            reader.join()


def line_of(order: Mapping[str, Any]) -> str:
    """The inside of an inline table of TOML. UsageError for what cannot stand in one."""
    return ", ".join(f"{key_of(key)} = {value_of(value)}" for key, value in order.items())


def key_of(key: str) -> str:
    if not (key.isascii() and key.isidentifier()):
        raise UsageError(f"{key!r} is no key of an order to the rig")
    return key


def value_of(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + line_of(value) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(value_of, value)) + "]"
    is_number = isinstance(value, int | float) and math.isfinite(value)
    if is_number or isinstance(value, str):
        return json.dumps(value)  # TOML's basic strings and numbers are written alike
    raise UsageError(f"{value!r} is no value of an order to the rig")
