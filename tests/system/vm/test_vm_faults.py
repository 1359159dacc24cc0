"""Third boot: faults, each waited for by what it causes; reactions: docs/reference/quiesced.md."""

import re

import pytest
from quiesce.can.database import load
from quiesce_vm.boots import FaultRun
from quiesce_vm.initramfs import BACKEND_TESTS

EVENTS = ("error passive", "bus-off (", "bus-off: restart", "error active")


def demand(result: dict) -> dict:
    """The last demand frame that the guest recorded, decoded."""
    return load().raw(0x010, bytes.fromhex(result["last"]))


@pytest.mark.parametrize("name", BACKEND_TESTS)
def test_backend_tests_pass_on_a_real_kernel(faults: FaultRun, name: str) -> None:
    result = faults.results[name]
    assert result["code"] == 0, result["said"]
    assert re.fullmatch(r"[1-9]\d* Tests 0 Failures 0 Ignored ?", result["said"])


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("missing_interface", ["can.interface", "nocan0"]),
        ("missing_line", ["gpio.estop_input", "NO_SUCH_LINE"]),
        ("missing_device", ["accel.device", "no_such_device"]),
        ("missing_watchdog", ["watchdog", "/dev/no_such_watchdog"]),
        ("taken_line", ["gpio.estop_input", "ESTOP", "gpioset"]),
        ("second_instance", ["quiesced runs already"]),
    ],
)
def test_refuses_to_start_in_one_line(faults: FaultRun, name, words) -> None:
    result = faults.results[name]
    assert result["code"] == 2
    assert "|" not in result["said"]  # one line
    for word in words:
        assert word in result["said"]


def test_second_instance_leaves_the_first_alone(faults: FaultRun) -> None:
    assert faults.results["first_instance"] == {
        "name": "first_instance", "state": "RUN", "enable": 1, "fault": 0,
    }  # fmt: skip


def test_interface_down_and_up_is_logged_and_counted(faults: FaultRun) -> None:
    down, up = faults.results["interface_down"], faults.results["interface_up"]
    assert (down["down"], down["ticks_go_on"]) == (1, 1)
    assert down["said"].count("interface is down") == 1
    assert up["said"].count("interface is up") == 1
    assert up["state"] == "RUN"


def test_error_frames_ask_for_a_restart(faults: FaultRun) -> None:
    """The frames are injected: a bus-off of a real controller chip is untested."""
    result = faults.results["error_frames"]
    assert (result["error_frames"], result["bus_off"]) == (3, 1)
    assert result["restarts"] >= 1
    # vcan has nothing to restart: that the kernel says so shows that it was asked.
    assert "bus-off: restart refused: Operation not supported" in result["said"]
    events = [result["said"].index(f"CAN: {what}") for what in EVENTS]
    assert events == sorted(events)
    assert result["state"] == "RUN"


def test_flood_leaves_control_undisturbed(faults: FaultRun) -> None:
    frames, result = faults.results["flood"], faults.results["flooded"]
    assert frames["frames"] >= 100
    assert (frames["jumps"], frames["off"]) == (0, 0)
    assert frames["longest_us"] < 2000  # virtual time: no tick is missing
    assert (result["state"], result["faults"], result["overruns"]) == ("RUN", 0, 0)
    assert result["rejected_crc"] >= 8000  # three of seven kinds in 20,000
    assert result["rejected_shape"] >= 2800


def test_sigterm_ends_with_the_safe_frame(faults: FaultRun) -> None:
    last = demand(faults.results["sigterm"])
    assert (last["current_cmd_mA"], last["driver_is_enabled"]) == (300, 0)
    assert faults.results["terminated"] == {
        "name": "terminated", "code": 0, "enable": 0, "fault": 0,
    }  # fmt: skip


def test_make_safe_after_a_kill(faults: FaultRun) -> None:
    killed, safe = demand(faults.results["killed"]), demand(faults.results["make_safe"])
    assert (killed["current_cmd_mA"], killed["driver_is_enabled"]) == (300, 0)  # the caretaker's
    assert (safe["current_cmd_mA"], safe["driver_is_enabled"]) == (300, 0)
    assert faults.results["make_safe"]["off"] == faults.results["make_safe"]["frames"] >= 1
    assert faults.results["made_safe"] == {
        "name": "made_safe", "code": 0, "enable": 0, "said": "",
    }  # fmt: skip


def test_starts_again_after_a_kill(faults: FaultRun) -> None:
    assert faults.results["restarted"]["state"] == "RUN"


def test_full_disk_costs_the_log_and_nothing_else(faults: FaultRun) -> None:
    result, frames = faults.results["full_disk"], faults.results["full_disk_control"]
    store_failed = load().number("ServiceReply", "result", "STORE_FAILED")
    assert result["refused"] == f"{store_failed} 0"
    assert result["saved"] == "0 0"
    assert result["said"].count("No space left on device") == 1
    assert "takes lines again" in result["said"]
    assert (frames["jumps"], frames["off"]) == (0, 0)
    assert frames["frames"] >= 1
    assert result["state"] == "RUN"


def test_dead_controller_with_watchdog_resets_the_machine(faults: FaultRun) -> None:
    assert faults.results["watchdog_armed"]["state"] == "RUN"
    assert any("watchdog did not stop" in line for line in faults.lines)
    assert faults.ending == "guest-reset"
