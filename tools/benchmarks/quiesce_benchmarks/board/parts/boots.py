"""Images of boards in QEMU: they boot, come back from resets, and keep step with the bench."""

import re
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import build_folder, root
from quiesce.can.database import load
from quiesce.can.python_can import can
from quiesce.engine.bench import Bench, require_emulator, require_file

from quiesce_benchmarks.part import Effort, Measured

TITLE = "boots: images of boards in QEMU, on their consoles"
# The board's console is the machine's serial line of that number.
BOARDS = {"olimex_h405": (), "nucleo_f446re": ("-serial", "null")}
RESETS = 100
FIGURES = (
    ("board_boots", "boards", float(len(BOARDS)), "higher"),
    ("board_resets_survived", "resets", float(RESETS), "higher"),
    ("board_lockstep_mismatches", "words", 0.0, "lower"),
    ("board_lockstep_words", "words", None, "higher"),
    ("board_lockstep_speed", "of real time", 1.0, "higher", False),
)
ANSWER_S = 60.0
SCENARIO = "sim_hil/data/scenarios/trace_equality.toml"
# What the image is built with that is not the bench's choice.
SETTINGS = ("--law", "fuzzy", "--set", "tracker=compare")
COMPARED_EVERY, SPEED_EVERY = 100, 1000  # ticks between two bursts of telemetry


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
def running(name: str, *options: str) -> Iterator[Machine]:
    require_emulator()
    qemu = subprocess.Popen(
        ["qemu-system-arm", "-M", "netduinoplus2", "-display", "none", *options]
        + ["-serial", "pty", "-monitor", "stdio", "-kernel", str(image_of(name))],
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
        raise BenchFailure(f"{name}: QEMU has ended")
    finally:
        qemu.kill()
        qemu.wait()
        qemu.stdin.close()
        qemu.stdout.close()


class Listener:
    """python-can on an image's console."""

    def __init__(self, machine: Machine) -> None:
        self._bus = can.Bus(interface="slcan", channel=machine.console, sleep_after_open=0)
        self._database = load()

    def __enter__(self) -> "Listener":
        return self

    def __exit__(self, *_: object) -> None:
        self._bus.shutdown()

    def until(self, name: str) -> bool:
        """Whether such a message comes in time."""
        wanted = self._database.by_name[name].frame_id
        end_s = time.monotonic() + ANSWER_S
        while time.monotonic() < end_s:
            frame = self._frame()
            if frame is not None and frame.arbitration_id == wanted:
                return True
        return False

    def _frame(self) -> Any:
        """None where there is none, or a line that a reset, or who listens late, has cut off."""
        try:
            return self._bus.recv(timeout=1.0)
        except ValueError:
            return None


def boots(name: str) -> bool:
    with running(name, *BOARDS[name]) as machine, Listener(machine) as listener:
        return listener.until("Identification")


def resets_survived(name: str, count: int) -> int:
    """Identification comes once a second, first 18 ms after a start: each is of another start."""
    with running(name) as machine, Listener(machine) as listener:
        for number in range(count + 1):
            if not listener.until("Identification"):
                return max(0, number - 1)
            machine.reset()
    return count


def lockstep(channel: str, *words: str) -> list[str]:
    """Options of the bench for an image in lock-step."""
    return [
        *words,
        "--scenario",
        str(root() / SCENARIO),
        *SETTINGS,
        "--target",
        "linux",
        "--can",
        channel,
    ]


def measure(effort: Effort) -> Measured:
    del effort  # it is short
    name = next(iter(BOARDS))
    values: dict[str, float | None] = {
        "board_boots": float(sum(boots(one) for one in BOARDS)),
        "board_resets_survived": float(resets_survived(name, RESETS)),
    }
    bench = Bench()
    with running(f"{name}_lockstep") as machine:
        line = f"slcan:{machine.console}"
        every = ("--seeds", "1", "--telemetry-every", str(COMPARED_EVERY))
        compared = bench.json("compare", *lockstep(line, *every))
        values["board_lockstep_mismatches"] = float(compared["mismatches"])
        values["board_lockstep_words"] = float(compared["compared_words"])
        run = bench.json("run", *lockstep(line, "--telemetry-every", str(SPEED_EVERY)))
        values["board_lockstep_speed"] = float(run["realtime_factor"])
    return Measured(values)
