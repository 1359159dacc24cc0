"""Images of boards with an STM32F4 on QEMU's netduinoplus2, over their console as on a desk.

That machine has the processor, its memories, USARTs, timers and the core's own registers. It has no
RCC, GPIO, flash controller, CAN and watchdog: what the image does there must not hang. The image
runs at the machine's own pace; lines are read as text and only those that matter are decoded, so
that a machine under load keeps up.
"""

import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import can
import pytest
import serial
from can_protection import encode, load_database
from conftest import ROOT, require
from node_rig import FAULT_ID, MOST_RESTARTS
from quiesce.base.errors import UsageError
from quiesce.engine.bench import Bench
from quiesce.firmware.image import (
    SLOT_BEGINS,
    SLOT_BYTES,
    SLOT_MARK_BYTES,
    read_image,
    sealed,
)
from quiesce.firmware.release import sealed_elf
from quiesce_benchmarks.board import emulated
from quiesce_benchmarks.board.emulated import BOARDS

DATABASE = load_database()
DEADLINE_S = 120.0
ASK_AGAIN_S = 5.0
RESETS = 100


class Console:
    """Lines from and to an image, and the emulator's monitor."""

    def __init__(self, port: serial.Serial, machine: emulated.Machine) -> None:
        self.port = port
        self.machine = machine
        self.alive = 0

    def line(self) -> bytes:
        text = self.port.read_until(b"\r")
        assert text.endswith(b"\r"), "silence"
        return text

    def until(self, name: str, holds=lambda values: True) -> dict:
        message = DATABASE.get_message_by_name(name)
        start = f"t{message.frame_id:03X}{message.length}".encode()
        end = time.monotonic() + DEADLINE_S
        while time.monotonic() < end:
            line = self.line()
            if line.startswith(start) and len(line) == 6 + 2 * message.length:
                values = message.decode(bytes.fromhex(line[5:-1].decode()))
                if holds(values):
                    return values
        pytest.fail(f"never saw {name}")

    def send(self, frame_id: int, data: bytes = b"") -> None:
        self.port.write(f"t{frame_id:03X}{len(data)}{data.hex().upper()}\r".encode())

    def ask(self, operation: str, value: int = 0) -> str:
        """The result."""
        return str(self.reply(operation, 0, value)["result"])

    def reply(self, operation: str, index: int, value: int) -> dict:
        """Asked again until there is one, since the first bytes come before the USART listens."""
        request = DATABASE.get_message_by_name("ServiceRequest")
        values = {"operation": operation, "param_index": index, "param_value": value}
        start = f"t{DATABASE.get_message_by_name('ServiceReply').frame_id:03X}".encode()
        begin, asked = time.monotonic(), -ASK_AGAIN_S
        while time.monotonic() < begin + DEADLINE_S:
            if time.monotonic() > asked + ASK_AGAIN_S:
                asked = time.monotonic()
                self.alive += 1
                self.send(request.frame_id, encode(request, self.alive, **values))
            line = self.line()
            if line.startswith(start):
                reply = DATABASE.decode_message("ServiceReply", bytes.fromhex(line[5:-1].decode()))
                if reply["alive"] == self.alive % 16 and reply["result"] != "BUSY":
                    return reply
        pytest.fail(f"no reply to {operation}")


def compiled(name: str) -> Path:
    return require(ROOT / f"build/stm32f4/targets/stm32f4/quiesce_stm32f4_{name}.elf")


def running(name: str, *options: str) -> AbstractContextManager[Console]:
    return running_image(compiled(name), *options)


@contextmanager
def running_image(image: Path, *options: str) -> Iterator[Console]:
    with (
        emulated.running(image, *options) as machine,
        serial.Serial(machine.console, timeout=DEADLINE_S) as port,
    ):
        yield Console(port, machine)


@pytest.mark.parametrize("board", BOARDS)
def test_image_of_a_board_boots_and_answers_on_its_console(board: str) -> None:
    with running(board, *BOARDS[board]) as console:
        assert console.ask("READ") == "DONE"
        assert console.ask("SAVE") == "STORE_FAILED"  # flash is read-only there, and nothing hangs
        demand = console.until("CurrentDemand")
        assert demand["driver_is_enabled"] == 0
        assert console.until("Identification")["interface_version"] == 3


def sealed_image(tmp_path: Path) -> tuple[Path, bytes]:
    """A file in tmp_path for a sealed image, and what goes into it."""
    elf = compiled("olimex_h405")
    return tmp_path / "sealed.elf", sealed_elf(elf.read_bytes(), sealed(read_image(elf).payload))


def test_a_sealed_image_runs(tmp_path: Path) -> None:
    file, content = sealed_image(tmp_path)
    file.write_bytes(content)
    assert read_image(file).is_whole
    with running_image(file) as console:
        assert console.ask("READ") == "DONE"


def test_an_image_that_is_not_what_was_sealed_stays_silent(tmp_path: Path) -> None:
    file, content = sealed_image(tmp_path)
    name = b"olimex_h405\0"
    assert content.count(name) == 1
    file.write_bytes(content.replace(name, b"olimex_h406\0"))
    with running_image(file) as console:
        assert_silent(console)


def test_python_can_reads_the_console() -> None:
    with running("olimex_h405") as console:
        console.until("Status")
        name = console.port.name
        console.port.close()
        with can.Bus(interface="slcan", channel=name, bitrate=500_000, sleep_after_open=0) as bus:
            ids = {bus.recv(timeout=DEADLINE_S).arbitration_id for _ in range(200)}
        assert DATABASE.get_message_by_name("CurrentDemand").frame_id in ids


def start_streaming(console: Console) -> None:
    """What a start does not do by itself, so that a reset shows."""
    assert console.ask("RAW_STREAM", 3600) == "DONE"
    console.until("Status", lambda status: status["raw_is_streaming"] == 1)


@pytest.mark.parametrize(
    "resets", [2, pytest.param(RESETS, marks=pytest.mark.slow)], ids=["few", "all"]
)
def test_image_survives_resets_in_a_row(resets: int) -> None:
    with running("olimex_h405") as console:
        for _ in range(resets):
            start_streaming(console)
            console.machine.reset()
            status = console.until("Status", lambda status: status["raw_is_streaming"] == 0)
            assert status["fault"] != "ESTOP"  # no fault of the processor


SCENARIO = """
schema = "quiesce-scenario"
version = 1
name = "short"
plant = "{plant}"
duration_s = 1.0
noise_mg = 0.5

[[segment]]
kind = "sine"
freq_Hz = 10
"""


def test_lockstep_image_answers_like_the_host(tmp_path: Path) -> None:
    scenario = tmp_path / "short.toml"
    scenario.write_text(SCENARIO.format(plant=ROOT / "sim_hil/data/plants/squeeze_2012.toml"))
    with running("olimex_h405_lockstep") as console:
        channel = f"slcan:{console.port.name}"
        console.port.close()
        bench = Bench()
        words = ["--scenario", str(scenario), "--law", "fuzzy", "--seeds", "1"]
        words += ["--target", "linux", "--can", channel, "--telemetry-every", "50"]
        with pytest.raises(UsageError, match="refuses tracker = 0: "):
            bench.json("compare", *words)
        found = bench.json("compare", *words, "--set", "tracker=compare")  # the one that it has
    assert found["mismatches"] == 0 and found["ticks"] == 1000
    assert found["distinct_commands"] > 1


def assert_silent(console: Console) -> None:
    console.port.timeout = 5.0
    end = time.monotonic() + DEADLINE_S
    while console.port.read(4096) != b"":
        assert time.monotonic() < end, "it goes on"


def test_image_restarts_latched_after_faults_and_is_silent_after_too_many() -> None:
    with running("fault") as console:
        for _ in range(MOST_RESTARTS):
            start_streaming(console)
            console.send(FAULT_ID)
            console.until("Status", lambda status: status["raw_is_streaming"] == 0)
            status = console.until("Status", lambda status: status["state"] == "FAULT")
            assert status["fault"] == "ESTOP"
            assert console.until("CurrentDemand")["driver_is_enabled"] == 0
        console.send(FAULT_ID)
        assert_silent(console)
        console.machine.reset()  # as the watchdog does: the silence is not to end with it
        assert_silent(console)


# ---- boot code, and two places for an image -----------------------------------------------------

INCOMING, READY, TRIED, SUPERSEDED, CONFIRMED, REJECTED = range(6)  # marks of hal/slots/slots.c
MARK_BYTES = 16
RUNS = (INCOMING, READY, TRIED, CONFIRMED)


def place(slot: int, marks: tuple[int, ...] = ()) -> bytearray:
    """What is in flash from a place's begin on: the image, sealed, and marks."""
    image = sealed(read_image(compiled(f"olimex_h405_slot{slot}")).payload)
    content = bytearray(image.ljust(SLOT_BYTES, b"\xff"))
    for mark in marks:
        at = SLOT_BYTES - SLOT_MARK_BYTES + MARK_BYTES * mark
        content[at : at + 4] = bytes(4)
    return content


def damaged(content: bytearray) -> bytearray:
    content[40_000] ^= 1
    return content


@contextmanager
def booting(folder: Path, *places: bytearray) -> Iterator[Console]:
    """The boot code, with these contents of the two places."""
    options = []
    for slot, content in enumerate(places):
        file = folder / f"place{slot}.bin"
        file.write_bytes(content)
        loaded = f"loader,file={file},addr=0x{SLOT_BEGINS[slot]:08X},force-raw=on"
        options += ["-device", loaded]
    with running("olimex_h405_boot", *options) as console:
        yield console


EMPTY = bytearray(b"\xff" * SLOT_BYTES)
BOOTS = {
    "by a debugger": (lambda: (place(0), EMPTY), 0),
    "the second alone": (lambda: (EMPTY, place(1)), 1),
    "both by a debugger": (lambda: (place(0), place(1)), 0),
    "an update": (lambda: (place(0, (SUPERSEDED,)), place(1, RUNS)), 1),
    "an update that broke": (
        lambda: (place(0, (SUPERSEDED,)), damaged(place(1, RUNS))),
        0,
    ),
    "one that failed": (lambda: (place(0), place(1, (INCOMING, READY, TRIED))), 0),
    "one that is not whole": (lambda: (place(0), place(1, (INCOMING,))), 0),
    # The machine's flash takes no mark, and without it there is no trial.
    "one to be tried": (lambda: (place(0), place(1, (INCOMING, READY))), 0),
}  # fmt: skip


@pytest.mark.parametrize("what", BOOTS)
def test_boot_code_starts_the_image_that_is_wanted(tmp_path: Path, what: str) -> None:
    places, slot = BOOTS[what]
    with booting(tmp_path, *places()) as console:
        assert console.reply("IMAGE_INFO", 1, 0)["param_value"] == slot
        assert console.reply("IMAGE_INFO", 3, 0)["param_value"] == 0  # no trial


def test_boot_code_stays_silent_where_no_image_may_run(tmp_path: Path) -> None:
    with booting(tmp_path, damaged(place(0)), place(1, (INCOMING, READY, TRIED))) as console:
        assert_silent(console)


def test_an_image_behind_boot_code_restarts_and_hangs_on_no_flash(tmp_path: Path) -> None:
    with booting(tmp_path, place(0), EMPTY) as console:
        assert console.ask("IMAGE_PREPARE") == "STORE_FAILED"  # the machine has no flash controller
        start_streaming(console)
        assert console.ask("IMAGE_START") == "DONE"
        console.until("Status", lambda status: status["raw_is_streaming"] == 0)
        assert console.reply("IMAGE_INFO", 1, 0)["param_value"] == 0


def test_an_image_without_boot_code_has_no_other_place() -> None:
    with running("olimex_h405") as console:
        assert console.ask("IMAGE_INFO") == "NO_SUCH_OPERATION"
