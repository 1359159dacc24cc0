"""Images of boards with an STM32F4 on QEMU's netduinoplus2, driven with python-can as on a desk.

That machine has the processor, its memories, USARTs, timers and the core's own registers. It has no
RCC, GPIO, flash controller and watchdog: what the image does there must not hang.
"""

import json
import socket
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest
from conftest import ROOT, require
from node_rig import DEADLINE_S, MOST_RESTARTS, Rig, arm, cause_fault, is_first
from node_rig import running as run_image

MACHINE = ("-M", "netduinoplus2")
RESETS = 100


def image_of(name: str) -> Path:
    return require(ROOT / f"build/stm32f4/targets/stm32f4/quiesce_stm32f4_{name}.elf")


# The board's USART is the machine's serial line of that number.
BOARDS = {"olimex_h405": MACHINE, "nucleo_f446re": (*MACHINE, "-serial", "null")}


def running(image: Path, options: tuple[str, ...]) -> AbstractContextManager[Rig]:
    """At the machine's own pace: the image sleeps where it waits."""
    return run_image(image, options, pace=())


@contextmanager
def monitor(path: Path) -> Iterator[socket.socket]:
    """QEMU's machine protocol, past its greeting."""
    with socket.socket(socket.AF_UNIX) as line:
        line.settimeout(DEADLINE_S)
        line.connect(str(path))
        line.sendall(b'{"execute": "qmp_capabilities"}\n')
        yield line


def reset(line: socket.socket) -> None:
    line.sendall(json.dumps({"execute": "system_reset"}).encode() + b"\n")


def start_streaming(rig: Rig) -> None:
    """What a start does not do by itself, so that a reset shows."""
    assert rig.ask("RAW_STREAM", value=3600)["result"] == "DONE"
    rig.until("raw samples", lambda _: rig.seen["Status"]["raw_is_streaming"] == 1)


@pytest.mark.parametrize("board", BOARDS)
def test_image_of_a_board_boots_and_controls_over_its_console(board: str) -> None:
    with running(image_of(board), BOARDS[board]) as rig:
        rig.until("an identification", lambda name: name == "Identification")
        assert rig.seen["Identification"]["interface_version"] == 3
        arm(rig)
        rig.until("1234 mA", lambda _: rig.seen["CurrentDemand"]["current_cmd_mA"] == 1234)
        rig.is_stopping = True
        rig.until("ESTOP", lambda _: rig.seen["Status"]["fault"] == "ESTOP")
        rig.until("a demand", lambda name: name == "CurrentDemand")
        assert rig.seen["CurrentDemand"]["driver_is_enabled"] == 0


@pytest.mark.parametrize(
    "resets", [3, pytest.param(RESETS, marks=pytest.mark.slow)], ids=["few", "all"]
)
def test_image_survives_resets_in_a_row(tmp_path: Path, resets: int) -> None:
    path = tmp_path / "qmp"
    options = (*MACHINE, "-qmp", f"unix:{path},server=on,wait=off")
    with running(image_of("olimex_h405"), options) as rig, monitor(path) as line:
        rig.until("a status", lambda name: name == "Status")
        for _ in range(resets):
            start_streaming(rig)
            reset(line)
            rig.until("the restart", lambda _: rig.seen["Status"]["raw_is_streaming"] == 0)
            assert rig.seen["Status"]["fault"] != "ESTOP"  # no fault of the processor


def test_what_cannot_be_saved_is_refused_and_nothing_hangs() -> None:
    with running(image_of("olimex_h405"), MACHINE) as rig:
        rig.until("a status", lambda name: name == "Status")
        assert rig.ask("SAVE")["result"] == "STORE_FAILED"  # flash is read-only there
        rig.until("a demand", lambda name: name == "CurrentDemand")


def test_image_restarts_after_a_fault_with_its_outputs_off_and_stays_latched() -> None:
    with running(image_of("fault"), MACHINE) as rig:
        arm(rig)
        assert rig.seen["CurrentDemand"]["driver_is_enabled"] == 1
        cause_fault(rig)
        rig.until("the restart", lambda name: is_first(name, rig.seen["CurrentDemand"]))
        rig.until_state("FAULT")
        assert rig.seen["Status"]["fault"] == "ESTOP"
        rig.enable = 0
        rig.is_acknowledging = True
        rig.until("acknowledged", lambda _: rig.seen["Status"]["state"] in ("INIT", "IDLE", "SAFE"))
        rig.is_acknowledging = False
        arm(rig)


def test_image_is_silent_after_too_many_faults() -> None:
    with running(image_of("fault"), MACHINE) as rig:
        rig.until("a status", lambda name: name == "Status")
        for _ in range(MOST_RESTARTS):
            start_streaming(rig)
            cause_fault(rig)
            rig.until("the restart", lambda _: rig.seen["Status"]["raw_is_streaming"] == 0)
            rig.until_state("FAULT")
        cause_fault(rig)
        assert any(rig.receive() is None and rig.receive() is None for _ in range(1000))
