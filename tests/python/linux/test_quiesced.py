"""The controller program, end to end: on a pty that speaks SLCAN, as an adapter does."""

import ctypes
import os
import resource
import signal
import socket
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from quiesced_peer import PATIENCE_S, Peer, Quiesced, on_a_pty, open_pty, protected, slcan

IDLE, RUN, SAFE, FAULT = 1, 2, 3, 4
ESTOP = 10
DONE, STORE_FAILED = 0, 5


@pytest.fixture
def quiesced(tmp_path: Path) -> Iterator[Quiesced]:
    with on_a_pty(tmp_path) as under_test:
        yield under_test


def start_running(quiesced: Quiesced, *arguments: str) -> None:
    quiesced.peer.operator = {"enable": 1}
    quiesced.start(*arguments)
    quiesced.peer.wait_state(RUN)


def index_of(name: str) -> int:
    header = Path(__file__).resolve().parents[3] / "docs/reference/parameters.md"
    row = next(r for r in header.read_text().splitlines() if f"`{name}`" in r)
    return int(row.split("|")[1])


def test_reaches_run_and_leaves_with_a_farewell(quiesced: Quiesced) -> None:
    start_running(quiesced)
    quiesced.peer.wait("Status", lambda s: s["state"] == RUN and s["is_enabled"] == 1)
    quiesced.peer.wait("Identification")
    after = quiesced.peer.count()
    assert quiesced.stop() == 0
    last = quiesced.peer.wait("CurrentDemand", lambda s: s["driver_is_enabled"] == 0, after)
    assert last.signals["current_cmd_mA"] == 0  # safe_current_mA
    log = quiesced.log_text()
    assert "safe current, output off" in log
    assert "lateness: " in log
    assert "work: " in log


def test_status_file_on_request(quiesced: Quiesced) -> None:
    start_running(quiesced)
    quiesced.signal(signal.SIGUSR1)
    quiesced.peer.wait("Identification", after=quiesced.peer.count())
    assert quiesced.stop() == 0
    status = quiesced.status()
    assert status["fault"] in ("NONE", "TICK_LOST")
    assert status["can"]["state"] == "up"
    assert status["can"]["rejected_crc"] == 0
    assert status["loop"]["ticks"] == status["loop"]["lateness"]["count"]


def test_operator_withdraws(quiesced: Quiesced) -> None:
    start_running(quiesced)
    after = quiesced.peer.count()
    quiesced.peer.operator = {"enable": 0}
    quiesced.peer.wait_state(IDLE, after)
    after = quiesced.peer.count()
    quiesced.peer.operator = {"enable": 1}
    quiesced.peer.wait_state(RUN, after)
    after = quiesced.peer.count()
    quiesced.peer.operator = None  # no frames any more: not enabled
    quiesced.peer.wait_state(IDLE, after)
    assert quiesced.stop() == 0


def test_emergency_stop_latches_until_it_is_acknowledged(quiesced: Quiesced) -> None:
    start_running(quiesced)
    peer = quiesced.peer
    after = peer.count()
    peer.estop = True
    off = peer.wait_state(FAULT, after)
    assert off.signals["driver_is_enabled"] == 0
    assert off.signals["current_cmd_mA"] == 0
    assert peer.wait("Status", lambda s: s["state"] == FAULT, after).signals["fault"] == ESTOP
    peer.estop = False
    peer.wait_state(FAULT, peer.count())
    after = peer.count()
    peer.acknowledges = True
    peer.wait_state(RUN, after)
    assert quiesced.stop() == 0
    assert "fault ESTOP" in quiesced.log_text()
    assert "ESTOP" in [event["fault"] for event in quiesced.status()["last_faults"]]


def in_a_row(count: int, state: int) -> Callable[[dict[str, int]], bool]:
    """Accepts the last of so many demand frames in a row with a state."""
    seen = 0

    def accept(signals: dict[str, int]) -> bool:
        nonlocal seen
        seen = seen + 1 if signals["state"] == state else 0
        return seen == count

    return accept


def latch_estop(quiesced: Quiesced, kept: int = 1) -> None:
    """An emergency stop that is over, recorded and not acknowledged."""
    start_running(quiesced)
    quiesced.peer.estop = True
    quiesced.peer.wait_state(FAULT)
    quiesced.peer.estop = False
    quiesced.wait_log("fault ESTOP is kept", kept)


def stays_off(quiesced: Quiesced, after: int) -> None:
    """The driver was off in each tick of a second, and still is."""
    seen = quiesced.peer.count()
    quiesced.peer.wait("CurrentDemand", in_a_row(500, FAULT), seen)
    demands = [f.signals for f in quiesced.peer.frames[after:] if f.name == "CurrentDemand"]
    assert {s["driver_is_enabled"] for s in demands} == {0}
    assert {s["state"] for s in demands} == {FAULT}


def test_latched_fault_outlives_a_kill(quiesced: Quiesced) -> None:
    latch_estop(quiesced)
    quiesced.signal(signal.SIGKILL)
    quiesced.wait()
    assert quiesced.run("--make-safe").returncode == 0
    peer = quiesced.peer
    for how in (signal.SIGTERM, signal.SIGKILL):
        after = peer.count()
        quiesced.start()
        stays_off(quiesced, after)
        assert peer.wait("Status", after=after).signals["fault"] == ESTOP
        quiesced.signal(signal.SIGUSR1)
        quiesced.signal(how)
        quiesced.wait()
    after = peer.count()
    quiesced.start()
    peer.acknowledges = True
    peer.wait_state(RUN, after)
    quiesced.wait_log("fault ESTOP of an earlier run is acknowledged")
    quiesced.wait_log("the kept fault is forgotten")
    assert quiesced.stop() == 0
    assert quiesced.status()["kept_fault"] == "NONE"
    peer.acknowledges = False
    after = peer.count()
    quiesced.start()
    peer.wait_state(RUN, after)
    assert quiesced.stop() == 0
    assert quiesced.log_text().count("is not acknowledged yet: safe current, driver off") == 3


def test_status_says_which_fault_is_kept(quiesced: Quiesced) -> None:
    quiesced.write_config("current_check = 'on'\n")
    quiesced.start()  # it may be in FAULT before it is enabled
    quiesced.wait_log("fault CURRENT_LOST is kept")
    assert quiesced.stop() == 0
    after = quiesced.peer.count()
    quiesced.start()
    stays_off(quiesced, after)
    assert quiesced.stop() == 0
    status = quiesced.status()
    assert (status["fault"], status["kept_fault"]) == ("ESTOP", "CURRENT_LOST")
    assert "fault CURRENT_LOST of 2" in quiesced.log_text()
    assert "note: fault CURRENT_LOST of 2" in quiesced.run("--check").stdout


def test_fault_is_cleared_without_a_bus(quiesced: Quiesced) -> None:
    latch_estop(quiesced)
    refused = quiesced.run("--clear-fault")
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert "acknowledge over CAN, or stop it first" in refused.stderr
    assert quiesced.stop() == 0
    cleared = quiesced.run("--clear-fault")
    assert (cleared.returncode, cleared.stderr) == (0, "")
    assert cleared.stdout.startswith("forgotten: fault ESTOP of 2")
    assert quiesced.run("--clear-fault").stdout == "no fault is kept\n"
    after = quiesced.peer.count()
    quiesced.start()
    quiesced.peer.wait_state(RUN, after)
    assert quiesced.stop() == 0


@pytest.mark.parametrize("record", [b"", b"damaged", b"\xff" * 48])
def test_damaged_fault_record_counts_as_a_fault(quiesced: Quiesced, record: bytes) -> None:
    quiesced.state.mkdir()
    (quiesced.state / "fault.bin").write_bytes(record)
    quiesced.peer.operator = {"enable": 1}
    after = quiesced.peer.count()
    quiesced.start()
    stays_off(quiesced, after)
    assert "a fault is not acknowledged yet, its record cannot be read: " in quiesced.log_text()
    after = quiesced.peer.count()
    quiesced.peer.acknowledges = True
    quiesced.peer.wait_state(RUN, after)
    quiesced.wait_log("the kept fault is forgotten")
    assert not (quiesced.state / "fault.bin").exists()
    assert quiesced.stop() == 0


def test_full_disk_for_the_fault(quiesced: Quiesced) -> None:
    start_running(quiesced)
    (quiesced.state / "fault.bin.new").mkdir()
    quiesced.peer.estop = True
    quiesced.wait_log("latched fault: not written: ")
    (quiesced.state / "fault.bin.new").rmdir()
    quiesced.wait_log("latched fault: written again")
    quiesced.wait_log("fault ESTOP is kept")
    assert quiesced.stop() == 0
    assert quiesced.log_text().count("latched fault: not written: ") == 1


def test_lost_sensor_goes_to_the_safe_current_and_recovers(quiesced: Quiesced) -> None:
    quiesced.write_config("law = 'constant'\nsafe_current_mA = 40\n")
    start_running(quiesced)
    peer = quiesced.peer
    after = peer.count()
    peer.feeds_sensor = False
    # A lost tick ends in SAFE, too; without samples there is no way out of it.
    safe = peer.wait("CurrentDemand", in_a_row(1200, SAFE), after)
    assert safe.signals["current_cmd_mA"] == 40
    after = peer.count()
    peer.feeds_sensor = True
    peer.wait_state(RUN, after)
    assert quiesced.stop() == 0
    faults = {event["fault"] for event in quiesced.status()["last_faults"]}
    assert faults & {"SENSOR_LOST", "TICK_LOST"}


def test_hostile_bytes_change_nothing(quiesced: Quiesced) -> None:
    start_running(quiesced)
    peer = quiesced.peer
    peer.send_raw(b"\xff\x00t0104\r" + b"x" * 300 + b"\rt0324\rT\r" + b"t0204DEADBEEF\r")
    peer.wait("CanHealth", lambda s: s["rejected_crc"] == 1, 0)
    assert quiesced.stop() == 0
    assert quiesced.status()["can"]["malformed"] > 0


def set_parameter(peer: Peer, name: str, value: int) -> None:
    assert peer.request("STAGE", index_of(name), value).signals["result"] == DONE
    assert peer.request("APPLY").signals["result"] == DONE


def read_parameter(peer: Peer, name: str) -> int:
    reply = peer.request("READ", index_of(name))
    assert reply.signals["result"] == DONE
    return reply.signals["param_value"]


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


def test_what_was_learnt_outlives_a_restart(quiesced: Quiesced) -> None:
    quiesced.write_config("law = 'phase'\n")
    start_running(quiesced)
    assert quiesced.stop() == 0
    assert (quiesced.state / "adaptation.bin").exists()
    quiesced.start()
    assert quiesced.stop() == 0
    assert "what was learnt before is used" in quiesced.log_text()

    (quiesced.state / "adaptation.bin").write_bytes(b"damaged")
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
    quiesced.wait_log("restarted with new parameters")
    assert read_parameter(peer, "safe_current_mA") == 40

    quiesced.write_config("safe_current_mA = -1\nlaw = 'wrong'\n")
    quiesced.signal(signal.SIGHUP)
    quiesced.wait_log("parameters stay: ")
    assert "parameters.safe_current_mA: expected an integer in 0" in quiesced.log_text()
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


def test_second_instance_is_refused(quiesced: Quiesced) -> None:
    start_running(quiesced)
    assert quiesced.process is not None
    result = quiesced.run()
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1
    assert f"process {quiesced.process.pid} holds" in result.stderr
    assert quiesced.run("--make-safe").returncode == 1  # it leaves a live controller alone
    peer = quiesced.peer
    peer.wait_state(RUN, peer.count())
    assert quiesced.stop() == 0


def test_make_safe_after_a_kill(quiesced: Quiesced) -> None:
    quiesced.write_config("safe_current_mA = 40\n")
    start_running(quiesced)
    quiesced.signal(signal.SIGKILL)
    assert quiesced.wait() == -signal.SIGKILL
    after = quiesced.peer.count()
    result = quiesced.run("--make-safe")
    assert (result.returncode, result.stderr) == (0, "")
    off = quiesced.peer.wait("CurrentDemand", lambda s: s["driver_is_enabled"] == 0, after)
    assert off.signals["current_cmd_mA"] == 40
    # The lock is free again: it restarts.
    after = quiesced.peer.count()
    quiesced.start()
    quiesced.peer.wait_state(RUN, after)
    assert quiesced.stop() == 0


def test_make_safe_does_what_it_can(quiesced: Quiesced) -> None:
    lines = '[gpio]\nenable_output = { line = "gpiochip999:0" }\nwrong = 1\n'
    quiesced.write_config(more=lines)
    result = quiesced.run("--make-safe")
    assert result.returncode == 1
    assert "gpio.wrong: unknown key" in result.stderr
    assert "gpio.enable_output: " in result.stderr
    quiesced.peer.wait("CurrentDemand", lambda s: s["driver_is_enabled"] == 0)


def killed(quiesced: Quiesced) -> int:
    """Number of frames up to the death of a controller that was running."""
    quiesced.signal(signal.SIGKILL)
    assert quiesced.wait() == -signal.SIGKILL
    return quiesced.peer.count()


def wait_farewell(peer: Peer, after: int, current_mA: int) -> None:
    off = peer.wait("CurrentDemand", lambda s: s["driver_is_enabled"] == 0, after)
    assert off.signals["current_cmd_mA"] == current_mA


@pytest.mark.parametrize("damage", ["[can\n", None])
def test_make_safe_with_a_file_that_cannot_be_read(quiesced: Quiesced, damage: str | None) -> None:
    """What ran is made safe; systemd says where the state is."""
    quiesced.write_config("safe_current_mA = 40\n")
    start_running(quiesced)
    after = killed(quiesced)
    if damage is None:
        quiesced.config.unlink()
    else:
        quiesced.config.write_text(damage)
    result = quiesced.run("--make-safe", env={**os.environ, "STATE_DIRECTORY": str(quiesced.state)})
    assert result.returncode == 0, result.stderr
    assert result.stderr.startswith(f"quiesced: {quiesced.config}")
    assert result.stderr.count("\n") == 1
    wait_farewell(quiesced.peer, after, 40)


def test_make_safe_with_another_bus_in_the_file(quiesced: Quiesced) -> None:
    quiesced.write_config("safe_current_mA = 40\n")
    start_running(quiesced)
    after = killed(quiesced)
    master, slave, line = open_pty()
    other = Peer(master, line)
    quiesced.write_config("safe_current_mA = 50\n")
    quiesced.config.write_text(quiesced.config.read_text().replace(quiesced.peer.line, line))
    assert quiesced.run("--make-safe").returncode == 0
    wait_farewell(quiesced.peer, after, 40)
    wait_farewell(other, 0, 50)

    # What never ran does not replace what did.
    quiesced.config.write_text(quiesced.config.read_text().replace(line, "/no/such"))
    assert quiesced.run("--ticks", "10").returncode == 2
    after = quiesced.peer.count()
    assert quiesced.run("--make-safe").returncode == 1  # the other bus is not there
    wait_farewell(quiesced.peer, after, 40)
    other.close(slave)


def test_make_safe_with_parameters_of_a_reload(quiesced: Quiesced) -> None:
    start_running(quiesced)
    quiesced.write_config("safe_current_mA = 40\n")
    quiesced.signal(signal.SIGHUP)
    quiesced.wait_log("restarted with new parameters")
    quiesced.peer.wait_state(RUN, quiesced.peer.count())
    quiesced.wait_log("parameters for --make-safe are kept")
    quiesced.write_config("safe_current_mA = 60\n")  # nobody has read it
    after = killed(quiesced)
    assert quiesced.run("--make-safe").returncode == 0
    wait_farewell(quiesced.peer, after, 40)


@pytest.mark.parametrize("damage", [b"", b"damaged"])
def test_make_safe_with_damaged_kept_files(quiesced: Quiesced, damage: bytes) -> None:
    quiesced.write_config("safe_current_mA = 40\n")
    start_running(quiesced)
    after = killed(quiesced)
    (quiesced.state / "running.bin").write_bytes(damage)
    assert quiesced.run("--make-safe").returncode == 0
    wait_farewell(quiesced.peer, after, 40)
    (quiesced.state / "running.toml").write_bytes(damage)
    after = quiesced.peer.count()
    result = quiesced.run("--make-safe")
    assert result.returncode == 1
    assert f"{quiesced.state}/running.toml:" in result.stderr
    wait_farewell(quiesced.peer, after, 40)


def test_full_disk_for_the_kept_configuration(quiesced: Quiesced) -> None:
    """It runs; what an earlier run has kept is not taken for this one's."""
    start_running(quiesced)
    assert quiesced.stop() == 0
    (quiesced.state / "running.toml.new").mkdir()
    quiesced.write_config("safe_current_mA = 40\n")
    start_running(quiesced)
    quiesced.wait_log("--make-safe will have to use")
    after = killed(quiesced)
    assert not (quiesced.state / "running.toml").exists()
    assert quiesced.run("--make-safe").returncode == 0
    wait_farewell(quiesced.peer, after, 40)


def test_full_disk_for_the_log(quiesced: Quiesced) -> None:
    quiesced.write_config(to='"/dev/full"')
    start_running(quiesced)
    peer = quiesced.peer
    peer.wait("Identification", after=peer.count())
    assert quiesced.stop() == 0
    log = quiesced.log_text()
    assert log.count("log file /dev/full: No space left on device") == 1
    assert len(log.splitlines()) == 1


def test_full_disk_for_the_state(quiesced: Quiesced) -> None:
    start_running(quiesced)
    peer = quiesced.peer
    # What a full disk does to each write, without a disk of our own.
    (quiesced.state / "state.json.new").mkdir()
    quiesced.signal(signal.SIGUSR1)
    quiesced.wait_log("status file: not written: ")
    after = peer.count()
    peer.wait("Status", lambda s: s["state"] == RUN, after)
    (quiesced.state / "state.json.new").rmdir()
    quiesced.signal(signal.SIGUSR1)
    quiesced.wait_log("status file: written again")
    assert quiesced.stop() == 0


def test_save_that_fails_is_answered(quiesced: Quiesced) -> None:
    quiesced.start()
    peer = quiesced.peer
    peer.wait("Status")
    (quiesced.state / "parameters.bin").mkdir()
    assert peer.request("SAVE").signals["result"] == STORE_FAILED
    assert quiesced.stop() == 0
    assert "parameters not saved: " in quiesced.log_text()


def test_closed_standard_files(quiesced: Quiesced) -> None:
    quiesced.peer.operator = {"enable": 1}
    quiesced.process = subprocess.Popen(
        ["/bin/sh", "-c", 'exec "$0" --config "$1" <&- >&- 2>&-', quiesced.program, quiesced.config]
    )
    quiesced.peer.wait_state(RUN)
    assert quiesced.stop() == 0
    assert quiesced.status()["can"]["malformed"] == 0


def test_stderr_that_nobody_reads(quiesced: Quiesced) -> None:
    reader, writer = os.pipe()
    start = {"stderr": writer}
    quiesced.peer.operator = {"enable": 1}
    os.set_blocking(writer, False)
    filled = 0
    try:
        while True:
            filled += os.write(writer, b"x" * 4096)
    except BlockingIOError:
        os.set_blocking(writer, True)
    quiesced.start(**start)
    os.close(writer)
    quiesced.peer.wait_state(RUN)
    assert quiesced.stop() == 0
    os.close(reader)
    assert filled > 0


def test_lost_and_found_serial_line(quiesced: Quiesced, tmp_path: Path) -> None:
    """The adapter is unplugged and plugged in again."""
    link = tmp_path / "adapter"
    link.symlink_to(quiesced.peer.line)
    quiesced.write_config()
    quiesced.config.write_text(quiesced.config.read_text().replace(quiesced.peer.line, str(link)))
    start_running(quiesced)
    master, slave, line = open_pty()
    second = Peer(master, line, operator={"enable": 1})
    link.unlink()
    link.symlink_to(line)
    hang_up(quiesced)
    second.wait_state(RUN)
    assert quiesced.stop() == 0
    log = quiesced.log_text()
    assert "CAN: " in log
    second.close(slave)


WITNESS = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>
static int line = -1;
static void note(const char *what) {
    char text[32];
    const char *thread = gettid() == getpid() ? "loop" : "other";
    const int length = snprintf(text, sizeof text, "%s %s\n", what, thread);
    const int out = openat(AT_FDCWD, getenv("WITNESS_FILE"), O_WRONLY | O_CREAT | O_APPEND, 0600);
    if (write(out, text, (size_t)length) != length) abort();
    ((int (*)(int))dlsym(RTLD_NEXT, "close"))(out);
}
int open64(const char *path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const int fd = openat(AT_FDCWD, path, flags, va_arg(rest, int));
    va_end(rest);
    if (fd >= 0 && strcmp(path, getenv("WITNESS_LINE")) == 0) { line = fd; note("open"); }
    return fd;
}
int open(const char *path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const int mode = va_arg(rest, int);
    va_end(rest);
    return open64(path, flags, mode);
}
int close(int fd) {
    if (fd >= 0 && fd == line) { line = -1; note("close"); }
    return ((int (*)(int))dlsym(RTLD_NEXT, "close"))(fd);
}
int tcsetattr(int fd, int when, const struct termios *set) {
    note("set");
    int (*real)(int, int, const struct termios *) = dlsym(RTLD_NEXT, "tcsetattr");
    return real(fd, when, set);
}
"""


def preload(folder: Path, name: str, code: str) -> str:
    """Builds a library whose functions come before those of the C library."""
    library = folder / f"{name}.so"
    (folder / f"{name}.c").write_text(code)
    build = ["cc", "-shared", "-fPIC", "-O1", "-o", library, folder / f"{name}.c", "-ldl"]
    subprocess.run(build, check=True)
    return str(library)


def test_the_loop_never_opens_or_closes_the_bus(quiesced: Quiesced, tmp_path: Path) -> None:
    """An adapter that is plugged in again is the other thread's, whatever its driver takes."""
    link, calls = tmp_path / "adapter", tmp_path / "calls"
    link.symlink_to(quiesced.peer.line)
    quiesced.config.write_text(quiesced.config.read_text().replace(quiesced.peer.line, str(link)))
    environment = {
        **os.environ,
        "LD_PRELOAD": preload(tmp_path, "witness", WITNESS),
        "WITNESS_LINE": str(link),
        "WITNESS_FILE": str(calls),
    }
    quiesced.peer.operator = {"enable": 1}
    quiesced.start(env=environment)
    quiesced.peer.wait_state(RUN)
    assert calls.read_text().split("\n") == ["open loop", "set loop", ""]  # before its first tick
    master, slave, line = open_pty()
    second = Peer(master, line, operator={"enable": 1})
    link.unlink()
    link.symlink_to(line)
    hang_up(quiesced)
    second.wait_state(RUN)
    assert calls.read_text().split("\n")[2:] == ["close other", "open other", "set other", ""]
    assert quiesced.stop() == 0
    assert quiesced.status()["can"]["down"] == 1
    assert quiesced.status()["can"]["tx_dropped"] > 0
    os.close(slave)
    os.close(master)


def hang_up(quiesced: Quiesced) -> None:
    """Closes the pty's master side for good."""
    null = os.open("/dev/null", os.O_RDWR)
    os.dup2(null, quiesced.peer.master)
    os.close(null)


def test_ends_after_ticks(quiesced: Quiesced) -> None:
    quiesced.start("--ticks", "700")
    assert quiesced.wait() == 0
    assert quiesced.status()["loop"]["ticks"] == 700
    assert quiesced.status()["tick"] == 700 + quiesced.status()["loop"]["overruns"]


COUNTER = r"""
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t);
static long count;
static void note(void) { count += gettid() == getpid(); }
void *malloc(size_t n) { note(); return __libc_malloc(n); }
void *calloc(size_t n, size_t size) { note(); return __libc_calloc(n, size); }
void *realloc(void *p, size_t n) { note(); return __libc_realloc(p, n); }
__attribute__((destructor)) static void tell(void) {
    FILE *out = fopen(getenv("COUNTER_FILE"), "w");
    fprintf(out, "%ld", count);
    fclose(out);
}
"""


def test_the_loop_allocates_nothing(quiesced: Quiesced, tmp_path: Path) -> None:
    """However long it runs, its thread has asked for memory equally often."""
    counts = tmp_path / "count"
    library = preload(tmp_path, "counter", COUNTER)
    environment = {**os.environ, "LD_PRELOAD": library, "COUNTER_FILE": str(counts)}
    asked = []
    quiesced.peer.operator = {"enable": 1}
    for ticks in ("200", "2000"):
        quiesced.start("--ticks", ticks, env=environment)
        assert quiesced.wait() == 0
        asked.append(int(counts.read_text()))
    assert asked[0] == asked[1] > 0


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


@pytest.mark.parametrize("arguments", [["--wrong"], ["--ticks", "0"], ["--ticks"], ["--config"]])
def test_wrong_arguments(quiesced: Quiesced, arguments: list[str]) -> None:
    result = subprocess.run(
        [quiesced.program, *arguments], capture_output=True, text=True, timeout=PATIENCE_S
    )
    assert result.returncode == 2
    assert result.stderr.startswith("quiesced: ")
    assert result.stderr.count("\n") == 1


def receive_until(manager: socket.socket, text: str) -> str:
    """Reads datagrams of sd_notify up to the one that holds the text."""
    while True:
        message = manager.recv(4096).decode()
        if text in message:
            return message


def test_service_manager_is_kept_informed(quiesced: Quiesced, tmp_path: Path) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.settimeout(PATIENCE_S)
        manager.bind(str(tmp_path / "notify"))
        environment = {"NOTIFY_SOCKET": str(tmp_path / "notify"), "WATCHDOG_USEC": "200000"}
        quiesced.start(env={**os.environ, **environment})
        receive_until(manager, "READY=1")
        receive_until(manager, "WATCHDOG=1")
        receive_until(manager, "STATUS=")
        quiesced.signal(signal.SIGHUP)
        assert "MONOTONIC_USEC=" in receive_until(manager, "RELOADING=1")
        receive_until(manager, "READY=1")
        quiesced.signal(signal.SIGTERM)
        receive_until(manager, "STOPPING=1")
        assert quiesced.wait() == 0


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


def test_flood_leaves_control_undisturbed(quiesced: Quiesced) -> None:
    """More than a bus can carry, most of it with a wrong CRC."""
    start_running(quiesced)
    peer = quiesced.peer
    wrong = slcan(*protected("OperatorCommand", enable=0, fault_reset=0, alive=3))[:-2] + b"X\r"
    stale = slcan(*protected("OperatorCommand", enable=0, fault_reset=0, alive=3))
    for _ in range(200):
        peer.send_raw((wrong + stale) * 10)
    peer.wait_state(RUN, peer.count())
    assert read_parameter(peer, "tick_rate_Hz") == 500
    assert quiesced.stop() == 0
    status = quiesced.status()["can"]
    assert status["malformed"] == 2000
    assert status["rejected_alive"] > 0
