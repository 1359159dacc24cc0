"""Images of boards in QEMU: they boot, come back from resets, and keep step with the bench."""

import time
from typing import Any

from quiesce.base.paths import root
from quiesce.can.database import load
from quiesce.can.python_can import can
from quiesce.engine.bench import Bench

from quiesce_benchmarks.board.emulated import BOARDS, Machine, image_of, running
from quiesce_benchmarks.part import Effort, Measured

TITLE = "boots: images of boards in QEMU, on their consoles"
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
    with running(image_of(name), *BOARDS[name]) as machine, Listener(machine) as listener:
        return listener.until("Identification")


def resets_survived(name: str, count: int) -> int:
    """Identification comes once a second, first 18 ms after a start: each is of another start."""
    with running(image_of(name)) as machine, Listener(machine) as listener:
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
    with running(image_of(f"{name}_lockstep")) as machine:
        line = f"slcan:{machine.console}"
        every = ("--seeds", "1", "--telemetry-every", str(COMPARED_EVERY))
        compared = bench.json("compare", *lockstep(line, *every))
        values["board_lockstep_mismatches"] = float(compared["mismatches"])
        values["board_lockstep_words"] = float(compared["compared_words"])
        run = bench.json("run", *lockstep(line, "--telemetry-every", str(SPEED_EVERY)))
        values["board_lockstep_speed"] = float(run["realtime_factor"])
    return Measured(values)
