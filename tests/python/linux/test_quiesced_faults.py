"""The controller program remembers its faults, and `--make-safe` turns off what it left on."""

import itertools
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import can
import pytest
from latch_kills import measure
from quiesce.can.database import load
from quiesce.can.fault_record import Collector, FaultRecord, record_of
from quiesced_peer import Peer, Quiesced, on_a_pty, open_pty
from quiesced_steps import (
    DONE,
    ESTOP,
    FAULT,
    IDLE,
    RUN,
    SAFE,
    disarm,
    in_a_row,
    killed,
    start_running,
    wait_farewell,
)

FAULT_RECORD_PAGES = 318
KEPT = "the fault record is kept"


@pytest.fixture
def quiesced(tmp_path: Path) -> Iterator[Quiesced]:
    with on_a_pty(tmp_path) as under_test:
        yield under_test


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
        after = peer.catch_up()
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


def after_some(count: int) -> Callable[[dict[str, int]], bool]:
    """Accepts the last of so many."""
    left = itertools.count(-count)
    return lambda _: next(left) >= 0


def read_record(quiesced: Quiesced) -> FaultRecord:
    """All pages, asked for as often as that takes: a line that is full sheds them."""
    peer = quiesced.peer
    peer.wait("Status", after=peer.catch_up())  # it runs, and takes requests
    collector = Collector(load())
    collector.total = FAULT_RECORD_PAGES
    while (gap := collector.missing()) is not None:
        after = peer.count()
        first, count = gap
        if peer.request("FAULT_RECORD", value=first | count << 16).signals["result"] != DONE:
            continue
        peer.wait("Status", after_some(count + 20), after)
        for frame in peer.frames[after:]:
            collector.take(can.Message(arbitration_id=frame.identifier, data=frame.data))
    return record_of(collector.data())


def stop_in_idle(quiesced: Quiesced) -> None:
    """An emergency stop that stays pressed."""
    quiesced.peer.operator = {"enable": 0}
    quiesced.start()
    quiesced.peer.wait_state(IDLE)
    quiesced.peer.estop = True
    quiesced.peer.wait_state(FAULT)


def estop_record(quiesced: Quiesced) -> FaultRecord:
    """Of the stop; a busy machine's lost ticks may be recorded before it."""
    while (record := read_record(quiesced)).fault != ESTOP:
        pass
    return record


def test_record_of_a_fault_outlives_a_kill(quiesced: Quiesced) -> None:
    """It is the first fault's over restarts, until it is acknowledged; then the next one's."""
    stop_in_idle(quiesced)
    first = estop_record(quiesced)
    quiesced.peer.estop = False
    assert (first.is_latched, first.fault_bin, len(first.bins)) == (True, 50, 58)
    assert first.tick_rate_Hz == 500
    kept = quiesced.log_text().count(KEPT) or 1
    quiesced.wait_log(KEPT, kept)
    for how in (signal.SIGKILL, signal.SIGTERM):
        quiesced.signal(how)
        quiesced.wait()
        quiesced.start()
        assert read_record(quiesced) == first
    quiesced.peer.acknowledges = True
    quiesced.wait_log(KEPT, kept + 1)  # as acknowledged
    quiesced.signal(signal.SIGKILL)
    quiesced.wait()
    quiesced.peer.acknowledges = False
    quiesced.start()
    quiesced.peer.estop = True
    while (second := estop_record(quiesced)) == first:
        pass
    assert second.number > first.number
    assert quiesced.peer.request("CLEAR_RECORD").signals["result"] == DONE
    quiesced.wait_log("the kept fault record is forgotten")
    assert quiesced.stop() == 0


def test_an_end_in_order_keeps_a_record_that_is_not_complete(quiesced: Quiesced) -> None:
    stop_in_idle(quiesced)
    assert quiesced.stop() == 0
    quiesced.peer.estop = False
    quiesced.start()
    assert read_record(quiesced).is_latched
    assert quiesced.stop() == 0


@pytest.mark.parametrize("damage", [b"", b"damaged", b"\xff" * 8192])
def test_damaged_record_is_told_and_does_not_stop_a_start(
    quiesced: Quiesced, damage: bytes
) -> None:
    quiesced.state.mkdir(exist_ok=True)
    (quiesced.state / "record.bin").write_bytes(damage)
    quiesced.start()
    quiesced.wait_log("the fault record is not used: ")
    assert quiesced.peer.wait("Status").signals["fault"] != ESTOP
    assert quiesced.stop() == 0
    assert (quiesced.state / "record.bin").stat().st_size == 8192


def test_status_says_which_fault_is_kept(quiesced: Quiesced) -> None:
    quiesced.write_config("current_check = 'on'\n")
    quiesced.start()  # it may be in FAULT before it is enabled
    quiesced.wait_log("fault CURRENT_LOST is kept")
    assert quiesced.stop() == 0
    after = quiesced.peer.catch_up()
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
    assert quiesced.stop() == 0
    assert quiesced.run("--clear-fault").stdout == "no fault is kept\n"


def test_fault_that_cannot_be_written_is_tried_again(quiesced: Quiesced) -> None:
    """The reserved room was taken away, and there is no other."""
    start_running(quiesced)
    (quiesced.state / "fault.bin").unlink()
    (quiesced.state / "fault.bin.make").mkdir()
    quiesced.peer.estop = True
    quiesced.wait_log("latched fault: not written: ")
    (quiesced.state / "fault.bin.make").rmdir()
    quiesced.wait_log("latched fault: written again")
    quiesced.wait_log("fault ESTOP is kept")
    assert quiesced.stop() == 0
    assert quiesced.log_text().count("latched fault: not written: ") == 1


def test_leftover_of_a_killed_program_counts_as_a_fault(quiesced: Quiesced) -> None:
    quiesced.state.mkdir()
    (quiesced.state / "fault.bin.new").write_bytes(b"half of a rec")
    assert "a fault is not acknowledged yet" in quiesced.run("--check").stdout
    quiesced.peer.operator = {"enable": 1}
    after = quiesced.peer.count()
    quiesced.start()
    stays_off(quiesced, after)
    assert quiesced.stop() == 0
    cleared = quiesced.run("--clear-fault")
    assert cleared.stdout.startswith("forgotten: fault ESTOP of 2")


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSEGV, signal.SIGABRT])
def test_caretaker_says_farewell_and_keeps_the_fault(quiesced: Quiesced, number: int) -> None:
    """Whatever ends the controller, without a service manager."""
    quiesced.write_config("safe_current_mA = 40\n")
    start_running(quiesced)
    quiesced.signal(number)
    assert quiesced.wait() == -number
    after = quiesced.peer.count()
    wait_farewell(quiesced.peer, after, 40)
    quiesced.peer.wait_state(IDLE, after)
    assert quiesced.run("--make-safe").returncode == 0  # it waits for the caretaker
    latch_estop(quiesced)
    after = quiesced.peer.count()
    quiesced.signal(number)
    quiesced.wait()
    assert "not acknowledged yet" in quiesced.run("--check").stdout
    quiesced.peer.catch_up()
    assert quiesced.peer.frames[-1].signals["state"] == FAULT
    assert "its outputs are made safe" in quiesced.log_text()


ENDS = [
    signal.SIGTERM,
    signal.SIGINT,
    signal.SIGQUIT,
    signal.SIGUSR2,
    signal.SIGALRM,
    signal.SIGVTALRM,
    signal.SIGPROF,
    signal.SIGIO,
    signal.SIGPWR,
    signal.SIGXCPU,
    signal.SIGRTMIN,
    signal.SIGRTMAX,
]


@pytest.mark.parametrize("number", ENDS)
def test_signals_that_can_be_caught_end_in_order(quiesced: Quiesced, number: int) -> None:
    quiesced.write_config("safe_current_mA = 40\n")
    start_running(quiesced)
    quiesced.signal(number)
    assert quiesced.wait() == 0
    quiesced.peer.catch_up()
    last = [f.signals for f in quiesced.peer.frames if f.name == "CurrentDemand"][-3:]
    assert [s["driver_is_enabled"] for s in last] == [0, 0, 0]
    assert [s["current_cmd_mA"] for s in last] == [40, 40, 40]
    assert {s["state"] for s in last} <= {IDLE, SAFE}


@pytest.mark.parametrize("number", [signal.SIGTSTP, signal.SIGTTOU, signal.SIGXFSZ, signal.SIGPIPE])
def test_signals_that_would_leave_the_driver_on_are_ignored(
    quiesced: Quiesced, number: int
) -> None:
    start_running(quiesced)
    quiesced.signal(number)
    quiesced.peer.wait("Identification", after=quiesced.peer.count())
    assert quiesced.stop() == 0


def test_caretaker_that_is_killed_is_told(quiesced: Quiesced) -> None:
    start_running(quiesced)
    assert quiesced.process is not None
    children = Path(f"/proc/{quiesced.process.pid}/task/{quiesced.process.pid}/children")
    os.kill(int(children.read_text()), signal.SIGKILL)
    quiesced.wait_log("the caretaker has ended")
    assert quiesced.stop() == 0


def test_no_latch_is_lost(tmp_path: Path) -> None:
    """latch_kills.py takes all system calls; here some of them."""
    figures = measure(tmp_path, every=40)
    assert figures["latch_kills"] >= 10
    assert figures["latch_told"] >= 3
    assert {name: n for name, n in figures.items() if name.endswith("lost") and n} == {}
    assert all(figures[name] for name in figures if name.endswith("refused"))


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


@pytest.mark.parametrize("damage", ["[can\n", "a" + ".a" * 50000 + " = 1\n", None])
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
    disarm(quiesced)
    quiesced.write_config("safe_current_mA = 40\n")
    quiesced.signal(signal.SIGHUP)
    quiesced.wait_log("restarted with new parameters")
    quiesced.peer.operator = {"enable": 1}
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
