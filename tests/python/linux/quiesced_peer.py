"""Everything around a running `quiesced`: the program on a pty that speaks SLCAN, and on the other
end of it a sensor node, an operator and a listener that decodes with the shipped messages."""

import contextlib
import fcntl
import json
import math
import os
import select
import signal
import subprocess
import threading
import time
import tty
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, BinaryIO

import cantools
from conftest import require
from quiesce.can.e2e import frame_crc

ROOT = Path(__file__).resolve().parents[3]
DBC = cantools.database.load_file(ROOT / "firmware/comm/quiesce.dbc")
BUILD = Path(os.environ.get("QUIESCE_BUILD", ROOT / "build")).resolve()
DEMAND_ID = DBC.get_message_by_name("CurrentDemand").frame_id
COMMAND_S = DBC.get_message_by_name("OperatorCommand").cycle_time / 1000.0
INIT, IDLE, FAULT = 0, 1, 4
PRESSES_IN_VAIN = 10  # in IDLE, until the operator lets go once more
LET_GO_FRAMES = 4  # the third is the first that counts
SAMPLE_ID = DBC.get_message_by_name("AccelSample").frame_id
PATIENCE_S = 60.0  # for events on a machine with other work; nothing is asserted about it

# A machine with other work loses ticks, which the controller answers with SAFE: it is to come back
# at once.
CONFIG = """\
[loop]
priority = 0
lock_memory = false
[can]
interface = "slcan:{line}"
[accel]
source = "can"
[current]
output = "can"
[operator]
enable = "can"
[state]
folder = "{state}"
status_s = 1
[log]
to = "stderr"
level = "debug"
{more}[parameters]
tick_rate_Hz = 500
sensor_max_age_ticks = 1000
sensor_stuck_ticks = 0
sensor_recover_ticks = 1
{parameters}"""


MARK = b"mark"  # a line that is no frame

MESSAGE = {message.frame_id: message for message in DBC.messages}


def sealed(identifier: int, data: bytes) -> bytes:
    """The data, whose last byte becomes the CRC."""
    return data[:-1] + bytes([frame_crc(identifier, data)])


def protected(name: str, **signals: int) -> tuple[int, bytes]:
    """A message with its CRC. alive is among the signals."""
    message = DBC.get_message_by_name(name)
    data = message.encode({**signals, "crc": 0}, scaling=False)
    return message.frame_id, sealed(message.frame_id, data)


def slcan(identifier: int, data: bytes) -> bytes:
    return f"t{identifier:03X}{len(data)}{data.hex().upper()}\r".encode()


@dataclass(frozen=True)
class Frame:
    """Decoded when somebody looks at it: thousands come a second."""

    identifier: int
    data: bytes

    @property
    def name(self) -> str:
        return MESSAGE[self.identifier].name

    @cached_property
    def signals(self) -> dict[str, int]:
        return MESSAGE[self.identifier].decode(self.data, scaling=False, decode_choices=False)


@dataclass
class Peer:
    """The bus's other nodes. Each sensor node sends a sample for every demand frame; the operator
    repeats what he commands in its cycle, and acknowledges again and again where he does. Where he
    enables he lets go first, at each start and after each fault: the edge arms."""

    master: int
    line: str
    feeds_sensor: bool = True
    sensors: int = 1  # of the board
    operator: dict[str, int] | None = None
    acknowledges: bool = False
    estop: bool = False
    frames: list[Frame] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._changed = threading.Condition()
        self._alive: dict[str, int] = {}
        self._demands = 0
        self._commands = 0
        self._command_due_s = 0.0
        self._let_go = LET_GO_FRAMES
        self._in_vain = 0
        self._is_idle = False
        self._marks = 0
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def send(self, name: str, **signals: int) -> None:
        alive = self._alive.get(name, 0)
        self._alive[name] = (alive + 1) % 16
        self.send_raw(slcan(*protected(name, **{"alive": alive, **signals})))

    def send_raw(self, data: bytes) -> None:
        os.write(self.master, data)

    def request(self, operation: str, index: int = 0, value: int = 0) -> Frame:
        """The reply to a service request."""
        after = self.count()
        choices = DBC.get_message_by_name("ServiceRequest").get_signal_by_name("operation").choices
        number = next(n for n, label in choices.items() if str(label) == operation)
        self.send("ServiceRequest", operation=number, param_index=index, param_value=value)
        return self.wait("ServiceReply", lambda s: s["operation"] == number, after)

    def count(self) -> int:
        with self._changed:
            return len(self.frames)

    def catch_up(self) -> int:
        """Number of frames when all has been read that is on the line by now. Where the program has
        ended, its last frames may still be under way."""
        wanted = self._marks + 1
        line = os.open(self.line, os.O_WRONLY | os.O_NOCTTY)
        os.write(line, b"\r" + MARK + b"\r")
        os.close(line)
        with self._changed:
            assert self._changed.wait_for(lambda: self._marks == wanted, PATIENCE_S)
            return len(self.frames)

    def wait(
        self, name: str, accept: Callable[[dict[str, int]], bool] = lambda _: True, after: int = 0
    ) -> Frame:
        """The first frame of that name, from a number on, that is accepted."""
        identifier = DBC.get_message_by_name(name).frame_id
        looked_at = after
        found = None

        def look() -> bool:
            nonlocal looked_at, found
            while found is None and looked_at < len(self.frames):
                frame = self.frames[looked_at]
                looked_at += 1
                if frame.identifier == identifier and accept(frame.signals):
                    found = frame
            return found is not None

        with self._changed:
            arrived = self._changed.wait_for(look, PATIENCE_S)
        assert arrived, f"no such {name} in {looked_at - after} frames"
        return found

    def wait_state(self, state: int, after: int = 0) -> Frame:
        return self.wait("CurrentDemand", lambda s: s["state"] == state, after)

    def _listen(self) -> None:
        # Ends where the test is over, or hangs up.
        with contextlib.suppress(OSError):
            self._serve_frames()

    def _serve_frames(self) -> None:
        rest = b""
        while True:
            data = os.read(self.master, 65536)
            if not data:
                return  # hung up
            *lines, rest = (rest + data).split(b"\r")
            frames = [frame for line in lines if (frame := parse(line)) is not None]
            with self._changed:
                self.frames += frames
                self._marks += lines.count(MARK)
                self._changed.notify_all()
            for frame in filter(lambda frame: frame.identifier == DEMAND_ID, frames):
                self._serve(frame.data[2] >> 1 & 7)

    def _serve(self, state: int) -> None:
        if state in (INIT, FAULT) or self._in_vain > PRESSES_IN_VAIN:
            self._let_go = LET_GO_FRAMES
            self._in_vain = 0
        self._is_idle = state == IDLE
        self._demands += 1
        if not select.select([], [self.master], [], 0)[1]:
            return  # nobody reads, as after the program's death: this bus loses frames
        if self.feeds_sensor:
            for sensor in range(self.sensors):
                self.send_raw(slcan(*accel_sample(self._demands, sensor)))
        if self.operator is not None:
            self._command(self.operator, time.monotonic())
        if self.estop and self._demands % 5 == 0:
            self.send("EmergencyStop", code=23205)

    def _command(self, what: dict[str, int], now_s: float) -> None:
        """Once in its cycle: what comes at another time counts for nothing. A button is pressed for
        two frames."""
        if now_s < self._command_due_s:
            return
        self._command_due_s = max(self._command_due_s, now_s - COMMAND_S) + COMMAND_S
        self._commands += 1
        is_pressed = self.acknowledges and self._commands // 2 % 2
        said = {**what, "fault_reset": int(is_pressed)}
        if self._let_go > 0:
            self._let_go -= 1
            said["enable"] = 0
        self._in_vain = self._in_vain + 1 if self._is_idle and said.get("enable") else 0
        self.send("OperatorCommand", **said)

    def close(self, slave: int) -> None:
        """Ends with its line. Else it would serve the next one whose file has the same number."""
        os.close(slave)
        self._thread.join(PATIENCE_S)
        assert not self._thread.is_alive()
        os.close(self.master)


def accel_sample(number: int, sensor: int = 0) -> tuple[int, bytes]:
    """Some 0.2 g at 10 Hz with noise; number: of the sample, 500 a second."""
    noise = number * 7919 % 101 + sensor
    counts = round(40000 * math.sin(2 * math.pi * 10.0 * number / 500.0)) + noise
    data = (counts & 0xFFFFFF).to_bytes(3, "little") + bytes([(number % 16) << 4, 0])
    return SAMPLE_ID + sensor, sealed(SAMPLE_ID + sensor, data)


def parse(line: bytes) -> Frame | None:
    """None for a line that was cut off, as it may be where the program ended."""
    try:
        identifier, data = int(line[1:4], 16), bytes.fromhex(line[5:].decode())
    except ValueError:
        return None
    is_whole = line[:1] == b"t" and line[4:5] == str(len(data)).encode()
    return Frame(identifier, data) if is_whole and identifier in MESSAGE else None


@dataclass
class Quiesced:
    """The program under test, in a folder of its own."""

    program: Path
    folder: Path
    peer: Peer
    config: Path
    state: Path
    process: subprocess.Popen | None = None

    def write_config(self, parameters: str = "", more: str = "", **changes: str) -> None:
        text = CONFIG.format(
            line=self.peer.line, state=self.state, parameters=parameters, more=more
        )
        for old, new in changes.items():
            text = text.replace(f"{old} = ", f"{old} = {new} # ")
        self.config.write_text(text)

    def start(self, *arguments: str, **options: Any) -> None:
        """Without arguments: until it takes requests. A frame that an earlier one left on the line
        is not taken for its own: what comes before the line is opened is lost."""
        if not arguments:
            self.peer.catch_up()
        self.log = open(self.folder / "stderr", "ab")  # noqa: SIM115
        self.process = subprocess.Popen(
            [self.program, "--config", self.config, *arguments],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            **{"stderr": self.log, **options},
        )
        if not arguments:
            self.peer.wait("CurrentDemand", after=self.peer.count())

    def run(self, *arguments: str, **options: Any) -> subprocess.CompletedProcess[str]:
        """A second one, to its end."""
        return subprocess.run(
            [self.program, "--config", self.config, *arguments],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=PATIENCE_S,
            **options,
        )

    def signal(self, number: signal.Signals) -> None:
        assert self.process is not None
        self.process.send_signal(number)

    def wait(self) -> int:
        assert self.process is not None
        code = self.process.wait(PATIENCE_S)
        self.process = None
        return code

    def stop(self) -> int:
        self.signal(signal.SIGTERM)
        return self.wait()

    def log_text(self) -> str:
        return (self.folder / "stderr").read_text()

    def wait_log(self, text: str, times: int = 1) -> None:
        """Polls the file; frames keep it from spinning."""
        limit = self.peer.count() + 200_000
        while self.log_text().count(text) < times:
            assert self.peer.count() < limit, self.log_text()
            assert self.process is not None and self.process.poll() is None, self.log_text()
            self.peer.wait("Status", after=self.peer.count())

    def status(self) -> dict[str, Any]:
        return json.loads((self.state / "state.json").read_text())

    def end(self) -> None:
        """Ends with its caretaker, which may still make its outputs safe: on a line whose name the
        next test's line may get."""
        if self.process is not None:
            self.process.kill()
            self.process.wait()
        lock = self.state / "lock"
        if lock.exists():
            with lock.open("rb") as held:
                until_s = time.monotonic() + PATIENCE_S
                while not takes(held):
                    assert time.monotonic() < until_s, "the caretaker does not end"
                    time.sleep(0.01)


def takes(lock: BinaryIO) -> bool:
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def open_pty() -> tuple[int, int, str]:
    master, slave = os.openpty()
    tty.setraw(master)
    tty.setraw(slave)
    return master, slave, os.ttyname(slave)


@contextlib.contextmanager
def on_a_pty(folder: Path, **config: str) -> Iterator[Quiesced]:
    """The program with its configuration written, not started; config: see write_config."""
    program = require(BUILD / "host/targets/linux/quiesced/quiesced")
    master, slave, line = open_pty()
    peer = Peer(master, line)
    under_test = Quiesced(program, folder, peer, folder / "q.toml", folder / "state")
    under_test.write_config(**config)
    try:
        yield under_test
    finally:
        under_test.end()
        peer.close(slave)
