"""The free-running controller image on its UART, driven with python-can as a user would."""

from collections.abc import Iterator
from pathlib import Path

import can
import pytest
from can_protection import encode
from conftest import require
from node_rig import (
    CONTROLLER,
    DATABASE,
    MOST_RESTARTS,
    PARAMETERS,
    Rig,
    arm,
    cause_fault,
    is_first,
    param_index,
    running,
)


@pytest.fixture
def rig(build: Path) -> Iterator[Rig]:
    with running(require(build / "mps2/targets/mps2/quiesce_mps2_node.elf")) as it:
        yield it


@pytest.fixture
def faulting(build: Path) -> Iterator[Rig]:
    """The same, which a frame of id FAULT_ID makes execute an undefined instruction."""
    with running(require(build / "mps2/tests/unit/mps2/node_fault.elf")) as it:
        yield it


def test_image_controls_over_the_bus_and_stops(rig: Rig) -> None:
    # Everything that is sent by itself.
    cyclic = {
        m.name
        for m in DATABASE.messages
        if m.frame_id in CONTROLLER
        and m.dbc.attributes["GenMsgSendType"].value == 0
        and m.cycle_time
    }
    assert len(cyclic) == 11
    rig.until("all cyclic messages", lambda _: cyclic <= rig.seen.keys())
    assert rig.seen["Identification"]["interface_version"] == 3

    # The table of the law that ships: its first frame.
    for _ in range(10):
        if "TableFlow" not in rig.seen:  # not yet, or lost
            assert rig.ask("TABLE_SEND")["result"] == "DONE"
            rig.until("a report", lambda name: name == "CanHealth")
    assert "TableFlow" in rig.seen

    # Parameters: another law, seen in the demand.
    for name, value in PARAMETERS.items():
        assert rig.ask("STAGE", param_index(name), value)["result"] == "DONE", name
    before = rig.seen["Identification"]["param_hash"]
    assert rig.ask("APPLY")["result"] == "DONE"
    assert rig.ask("READ", param_index("constant_current_mA"))["param_value"] == 1234
    rig.until("another hash", lambda _: rig.seen["Identification"]["param_hash"] != before)
    assert rig.ask("SAVE")["result"] == "DONE"

    # The operator lets it run.
    rig.run()
    rig.until("1234 mA", lambda _: rig.seen["CurrentDemand"]["current_cmd_mA"] == 1234)
    assert rig.seen["CurrentDemand"]["state"] == "RUN"

    # Raw samples are the ones that were sent.
    assert rig.ask("RAW_STREAM", value=1)["result"] == "DONE"
    rig.until("a raw sample", lambda name: name == "RawSample" and rig.seen[name]["accel_is_fresh"])
    assert -32768 <= rig.seen["RawSample"]["accel_counts"] <= 32767

    # Emergency stop: latched, the output stage off, its freeze frame complete.
    rig.is_stopping = True
    rig.until("ESTOP", lambda _: rig.seen["Status"]["fault"] == "ESTOP")
    rig.until("a demand", lambda name: name == "CurrentDemand")
    assert rig.seen["CurrentDemand"]["driver_is_enabled"] == 0
    assert rig.seen["CurrentDemand"]["state"] == "FAULT"
    rig.until("all pages", lambda _: rig.has_freeze_frame("ESTOP"))
    assert rig.pages[0]["freeze_state"] == "RUN"
    assert rig.pages[4]["freeze_current_cmd_mA"] == 1234

    # Released, then acknowledged.
    rig.is_stopping = False
    rig.until("release", lambda _: not rig.seen["Status"]["is_estop"])
    assert rig.seen["Status"]["state"] == "FAULT"
    rig.is_acknowledging = True
    rig.until("acknowledged", lambda _: rig.seen["Status"]["state"] == "IDLE")
    assert rig.seen["Status"]["is_enabled"] == 1  # held: that restarts nothing
    rig.run()
    rig.until("1234 mA again", lambda _: rig.seen["CurrentDemand"]["current_cmd_mA"] == 1234)
    # The record of a second before the stop, its last two pages.
    assert rig.ask("FAULT_RECORD", value=316)["result"] == "DONE"
    rig.until("the record", lambda name: name == "FaultRecord")
    assert {DATABASE.get_message_by_frame_id(i).name for i in CONTROLLER} == rig.seen.keys()


def test_image_ignores_and_counts_what_is_damaged(rig: Rig) -> None:
    message = DATABASE.get_message_by_name("OperatorCommand")
    rig.until("the first report", lambda name: name == "CanHealth")
    assert rig.seen["CanHealth"]["rejected_crc"] == rig.seen["CanHealth"]["rejected_shape"] == 0

    def send(data: bytes, **kind: bool) -> None:
        kind = {"is_extended_id": False, **kind}
        rig.bus.send(can.Message(arbitration_id=message.frame_id, data=data, **kind))

    for i in range(40):
        good = encode(message, i, enable=1)
        send(good[:-1] + bytes([good[-1] ^ (i + 1)]))
    for i in range(10):
        good = encode(message, i, enable=1)
        send(good[:1])
        send(good + good)
        send(good, is_extended_id=True)
        send(b"", is_remote_frame=True)
        rig.bus.serialPortOrig.write(b"t05\r\xff\x00\x80T\rt0502ZZ00\r" + b"t" * 300 + b"\r")

    def is_counted(name: str) -> bool:
        assert not rig.seen.get("Status", {}).get("is_enabled")
        health = rig.seen["CanHealth"]
        return name == "CanHealth" and (health["rejected_crc"], health["rejected_shape"]) == (
            40,
            40,
        )

    rig.until("40 wrong CRCs and 40 wrong shapes", is_counted)
    rig.enable = 1
    rig.until("enabled", lambda _: rig.seen["Status"]["is_enabled"])


def test_image_restarts_after_a_fault_of_the_processor_and_stays_latched(faulting: Rig) -> None:
    rig = faulting
    arm(rig)
    demands: list[dict] = []

    def has_100_of_the_restart(name: str) -> bool:
        demand = rig.seen["CurrentDemand"]
        if demands or is_first(name, demand):
            demands.extend([dict(demand)] if name == "CurrentDemand" else [])
        return len(demands) == 100

    assert rig.seen["CurrentDemand"]["driver_is_enabled"] == 1
    cause_fault(rig)
    rig.until("demands of the restart", has_100_of_the_restart)
    assert {(one["driver_is_enabled"], one["current_cmd_mA"]) for one in demands} == {(0, 0)}
    rig.until_state("FAULT")
    assert rig.seen["Status"]["fault"] == "ESTOP"
    rig.until("what is held", lambda _: rig.seen["Status"]["is_enabled"] == 0)  # counts for nothing

    # One acknowledgement, an edge of enable, and it runs.
    rig.enable = 0
    rig.is_acknowledging = True
    rig.until("acknowledged", lambda _: rig.seen["Status"]["state"] in ("INIT", "IDLE", "SAFE"))
    rig.is_acknowledging = False
    arm(rig)
    assert rig.seen["CurrentDemand"]["driver_is_enabled"] == 1


def test_image_restarts_so_often_and_is_silent_then(faulting: Rig) -> None:
    rig = faulting
    rig.until("a status", lambda name: name == "Status")
    for _ in range(MOST_RESTARTS):
        assert rig.ask("RAW_STREAM", value=3600)["result"] == "DONE"
        rig.until("raw samples", lambda _: rig.seen["Status"]["raw_is_streaming"] == 1)
        cause_fault(rig)
        rig.until("the restart", lambda _: rig.seen["Status"]["raw_is_streaming"] == 0)
        rig.until_state("FAULT")
    cause_fault(rig)
    is_silent = False
    for _ in range(1000):
        is_silent = rig.receive() is None and rig.receive() is None and rig.receive() is None
        if is_silent:
            break
    assert is_silent
