"""The controller program's parameters and configuration: kept, reloaded, checked, refused."""

import ctypes
import resource
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from quiesced_peer import PATIENCE_S, ROOT, Quiesced, on_a_pty
from quiesced_steps import (
    DONE,
    ESTOP,
    FAULT,
    RUN,
    STORE_FAILED,
    disarm,
    read_parameter,
    set_parameter,
    start_running,
)


@pytest.fixture
def quiesced(tmp_path: Path) -> Iterator[Quiesced]:
    with on_a_pty(tmp_path) as under_test:
        yield under_test


def test_saved_parameters_outlive_a_restart(quiesced: Quiesced) -> None:
    peer = quiesced.peer
    quiesced.start()
    set_parameter(peer, "constant_current_mA", 1234)
    assert peer.request("SAVE").signals["result"] == DONE
    assert quiesced.stop() == 0
    quiesced.start()
    assert read_parameter(peer, "constant_current_mA") == 1234
    assert quiesced.stop() == 0
    assert "saved parameters are used" in quiesced.log_text()

    # Who edits the configuration means it.
    quiesced.write_config("constant_current_mA = 777\n")
    quiesced.start()
    assert read_parameter(peer, "constant_current_mA") == 777
    assert quiesced.stop() == 0
    assert "[parameters] has changed" in quiesced.log_text()


def test_damaged_saved_parameters_are_not_used(quiesced: Quiesced) -> None:
    peer = quiesced.peer
    quiesced.start()
    set_parameter(peer, "constant_current_mA", 1234)
    assert peer.request("SAVE").signals["result"] == DONE
    assert quiesced.stop() == 0
    file = quiesced.state / "parameters.bin"
    data = bytearray(file.read_bytes())
    data[-5] ^= 1
    file.write_bytes(data)
    quiesced.start()
    assert read_parameter(peer, "constant_current_mA") == 5000
    assert quiesced.stop() == 0
    assert "saved parameters are not used: " in quiesced.log_text()


def test_save_that_fails_is_answered(quiesced: Quiesced) -> None:
    quiesced.start()
    peer = quiesced.peer
    peer.wait("Status")
    (quiesced.state / "parameters.bin").mkdir()
    assert peer.request("SAVE").signals["result"] == STORE_FAILED
    assert quiesced.stop() == 0
    assert "not saved: parameters: " in quiesced.log_text()


def test_what_was_learnt_outlives_a_restart(quiesced: Quiesced) -> None:
    quiesced.write_config("law = 'phase'\n")
    start_running(quiesced)
    assert quiesced.stop() == 0
    assert (quiesced.state / "learnt.bin").exists()
    quiesced.start()
    assert quiesced.stop() == 0
    assert "what was learnt before is used" in quiesced.log_text()

    (quiesced.state / "learnt.bin").write_bytes(b"damaged")
    quiesced.start()
    assert quiesced.stop() == 0
    assert "what was learnt is not used: " in quiesced.log_text()


def test_applied_parameters_change_the_tick_rate(quiesced: Quiesced) -> None:
    quiesced.start()
    peer = quiesced.peer
    set_parameter(peer, "tick_rate_Hz", 1000)
    assert read_parameter(peer, "tick_rate_Hz") == 1000
    assert quiesced.stop() == 0
    assert "restarted with new parameters" in quiesced.log_text()


def test_reload_takes_good_parameters_only(quiesced: Quiesced) -> None:
    start_running(quiesced)
    peer = quiesced.peer
    quiesced.write_config("safe_current_mA = 40\n")
    quiesced.signal(signal.SIGHUP)
    quiesced.wait_log("safe_current_mA may not change while the controller is armed; disarm first")
    disarm(quiesced)
    quiesced.signal(signal.SIGHUP)
    quiesced.wait_log("restarted with new parameters")
    assert read_parameter(peer, "safe_current_mA") == 40
    peer.operator = {"enable": 1}
    peer.wait_state(RUN, peer.count())

    quiesced.write_config("safe_current_mA = 40\nunlock_current_mA = 4000\n")
    quiesced.signal(signal.SIGHUP)  # live: nothing restarts
    quiesced.wait_log("other live parameters")
    assert read_parameter(peer, "unlock_current_mA") == 4000

    quiesced.write_config("safe_current_mA = -1\nlaw = 'wrong'\n")
    quiesced.signal(signal.SIGHUP)
    quiesced.wait_log("parameters.safe_current_mA: expected an integer in 0")
    assert "(and 1 more: --check)" in quiesced.log_text()
    assert read_parameter(peer, "safe_current_mA") == 40
    peer.wait_state(RUN, peer.count())
    after = peer.count()
    assert quiesced.stop() == 0
    off = peer.wait("CurrentDemand", lambda s: s["driver_is_enabled"] == 0, after)
    assert off.signals["current_cmd_mA"] == 40


def test_reload_does_not_forget_a_latched_fault(quiesced: Quiesced) -> None:
    start_running(quiesced)
    peer = quiesced.peer
    peer.estop = True
    peer.wait_state(FAULT)
    peer.estop = False
    quiesced.write_config("safe_current_mA = 40\n")
    quiesced.signal(signal.SIGHUP)
    quiesced.wait_log("parameters stay: a fault is latched")
    after = peer.count()
    peer.wait("Status", lambda s: s["fault"] == ESTOP, after)
    assert quiesced.stop() == 0


@pytest.mark.parametrize("arguments", [["--wrong"], ["--ticks", "0"], ["--ticks"], ["--config"]])
def test_wrong_arguments(quiesced: Quiesced, arguments: list[str]) -> None:
    result = subprocess.run(
        [quiesced.program, *arguments], capture_output=True, text=True, timeout=PATIENCE_S
    )
    assert result.returncode == 2
    assert result.stderr.startswith("quiesced: ")
    assert result.stderr.count("\n") == 1


def test_check_explains_everything(quiesced: Quiesced) -> None:
    quiesced.write_config("law = 'magic'\nsafe_current_mA = -1\n", more="[watchdog]\n")
    result = quiesced.run("--check")
    assert result.returncode == 2
    lines = result.stdout.splitlines()
    assert len(lines) == 3
    assert all(line.startswith(f"{quiesced.config}:") for line in lines)

    more = '[gpio]\nestop_input = { line = "NO_SUCH_LINE" }\n[watchdog]\ndevice = "/dev/no_such"\n'
    quiesced.write_config(more=more)
    result = quiesced.run("--check")
    assert result.returncode == 0, result.stdout
    assert 'note: gpio.estop_input: "NO_SUCH_LINE": ' in result.stdout
    assert "note: watchdog.device: /dev/no_such: No such file" in result.stdout
    assert not quiesced.state.exists()  # it touches nothing


@pytest.mark.parametrize(
    ("more", "key"),
    [
        ('[watchdog]\ndevice = "/dev/no_such_watchdog"\n', "watchdog.device"),
        ('[gpio]\nestop_input = { line = "NO_SUCH_LINE" }\n', "gpio.estop_input"),
        ('[gpio]\nenable_output = { line = "gpiochip999:0" }\n', "gpio.enable_output"),
    ],
)
def test_missing_devices_are_named(quiesced: Quiesced, more: str, key: str) -> None:
    quiesced.write_config(more=more)
    result = quiesced.run("--ticks", "10")
    assert result.returncode == 2
    assert result.stderr.startswith(f"quiesced: {key}: ")
    assert result.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ('source = "can"', 'source = "iio"\ndevice = "no_such"', "accel.device"),
        ('source = "can"', 'source = "adxl355"\ndevice = "/dev/no_such"', "accel.device"),
        (
            'output = "can"',
            'output = "pwm"\nchip = "pwmchip99"\nperiod_ns = 50000\nfull_scale_mA = 5000',
            "current.chip",
        ),
        (
            'output = "can"',
            'output = "dac"\ndevice = "no"\nzero_code = 0\nfull_scale_code = 9'
            "\nfull_scale_mA = 5000",
            "current.device",
        ),
        ('interface = "slcan:', 'interface = "slcan:/no/such', "can.interface"),
    ],
)
def test_missing_peripherals_are_named(quiesced: Quiesced, old: str, new: str, key: str) -> None:
    quiesced.config.write_text(quiesced.config.read_text().replace(old, new))
    result = quiesced.run("--ticks", "10")
    assert result.returncode == 2
    assert result.stderr.startswith(f"quiesced: {key}: ")
    assert result.stderr.count("\n") == 1
    assert quiesced.run("--make-safe").returncode == (0 if key == "accel.device" else 1)


def test_real_time_rights_are_named(quiesced: Quiesced) -> None:
    quiesced.write_config(priority="80")
    result = quiesced.run("--ticks", "10", preexec_fn=drop_realtime)
    assert result.returncode == 2, result.stderr
    assert result.stderr.count("\n") == 1
    assert "CAP_SYS_NICE" in result.stderr


def drop_realtime() -> None:
    """Without the limit and, for root, without the capability after exec."""
    cap_sys_nice, pr_capbset_drop = 23, 24
    resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0))
    ctypes.CDLL(None).prctl(pr_capbset_drop, cap_sys_nice, 0, 0, 0)


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ('estop_input = { line = "A", active_low = true, bias = "pull-up" }', "not pressed"),
        ('estop_input = { line = "A", bias = "pull-down" }', "not pressed"),
        ('estop_input = { line = "A", bias = "pull-up" }', None),
        ('enable_input = { line = "A", bias = "pull-up" }', "enabled"),
        ('enable_input = { line = "A", active_low = true, bias = "pull-up" }', None),
    ],
)
def test_check_tells_what_a_broken_wire_reads_as(
    quiesced: Quiesced, line: str, word: str | None
) -> None:
    quiesced.write_config(more=f"[gpio]\n{line}\n")
    notes = quiesced.run("--check").stdout
    assert ("a broken wire reads as" in notes) == (word is not None)
    assert word is None or f"reads as {word}" in notes


def test_the_example_stops_where_a_wire_breaks(quiesced: Quiesced) -> None:
    example = (ROOT / "targets/linux/packaging/quiesced.toml").read_text()
    lines = [row[2:] for row in example.splitlines() if row.startswith(("# estop_", "# enable_i"))]
    assert len(lines) == 2
    quiesced.write_config(more="[gpio]\n" + "\n".join(lines) + "\n")
    assert "a broken wire" not in quiesced.run("--check").stdout
