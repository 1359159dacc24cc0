"""First boot: the guest's slcan0 leads to the host. Lock-step against the host's controller, frames
in bulk, and the controller at work with the host as sensor node and operator."""

import re

from quiesce.can.database import load
from quiesce_vm.boots import ECHOES, BusRun
from quiesce_vm.measure import frames_lost


def test_lockstep_equals_the_host_bit_for_bit(bus: BusRun) -> None:
    assert bus.lockstep["targets"] == ["host", "linux"]
    assert bus.lockstep["ticks"] == 2000
    assert bus.lockstep["mismatches"] == 0, bus.lockstep["first_mismatch"]
    assert bus.lockstep["distinct_commands"] >= 100
    assert bus.lockstep["faults_seen"] == [2]  # the sensor was lost, and came back
    assert bus.results["lockstep"] == {"name": "lockstep", "code": 0, "said": ""}


def test_no_frame_is_lost_either_way(bus: BusRun) -> None:
    assert bus.echo_wrong == 0
    before, after = (bus.results[f"{when}_echo"]["link"][0] for when in ("before", "after"))
    assert after["ifname"] == "slcan0"
    for way in ("rx", "tx"):
        counts, earlier = after["stats64"][way], before["stats64"][way]
        assert counts["packets"] - earlier["packets"] == ECHOES
        assert counts["dropped"] == counts["errors"] == 0
    assert frames_lost(bus) == 0


def test_every_message_of_the_controller_is_decoded(bus: BusRun) -> None:
    sent = [message for message in load().messages if message.sender == "Controller"]
    # It has one damper, and a law without a table: TableFlow comes in the fourth boot.
    names = {message.name for message in sent if message.number == 0} - {"TableFlow"}
    assert len(names) == 15
    assert bus.missing == []
    assert names == set(bus.counts)
    assert bus.refused == []
    assert bus.malformed == 0


def test_service_requests_are_answered(bus: BusRun) -> None:
    results = {name: str(reply["result"]) for name, reply in bus.replies.items()}
    assert results == {
        "read": "DONE",
        "no_such_parameter": "NO_SUCH_PARAMETER",
        "out_of_range": "OUT_OF_RANGE",
        "raw_stream": "DONE",
    }
    assert bus.replies["read"]["param_value"] == 500  # tick_rate_Hz


def test_emergency_stop_from_outside_reaches_bus_and_lines(bus: BusRun) -> None:
    assert str(bus.estop.status["fault"]) == "ESTOP"
    assert str(bus.estop.status["state"]) == "FAULT"
    assert bus.estop.status["is_estop"] == 1
    assert bus.estop.demand["driver_is_enabled"] == 0
    assert bus.estop.demand["current_cmd_mA"] == 300
    assert bus.estop.freeze_fault == "ESTOP"


def test_controller_leaves_in_order(bus: BusRun) -> None:
    assert bus.results["bus"]["code"] == 0
    assert "libgpiod 1.6" in bus.results["bus"]["said"]


def test_host_speed_costs_neither_tick_nor_frame(bus: BusRun) -> None:
    """The guest's time stands still while its line is full: nothing is late or shed in it."""
    assert re.search(r"\b[1-9]\d* ticks, 0 lost\b", bus.results["bus"]["said"])
    for counts in bus.results["after_control"]["link"][0]["stats64"].values():
        assert counts["dropped"] == counts["errors"] == 0
